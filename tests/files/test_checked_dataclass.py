"""Dataclasses that pydantic checks: readable signatures, and all that a dataclass can do."""

import inspect
import pickle
from dataclasses import FrozenInstanceError, replace

import pytest
from pydantic import ValidationError

from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Finite, Positive, Whole


@checked_dataclass()
class Box:
    sides: tuple[Positive, ...]
    count: Whole = 3


@checked_dataclass(kw_only=True)
class Scale:
    factor: Finite = 2.0

    def __call__(self, value: float) -> float:
        return self.factor * value


def test_a_signature_has_names_plain_types_and_defaults():
    assert str(inspect.signature(Box)) == "(sides: tuple[float, ...], count: int = 3) -> None"
    assert str(inspect.signature(Scale)) == "(*, factor: float = 2.0) -> None"


def test_an_object_that_can_be_called_has_the_signature_of_its_call():
    assert list(inspect.signature(Scale()).parameters) == ["value"]


@pytest.mark.parametrize("fields", [{"sides": [0.0]}, {"sides": [1.0], "count": True}, {"sides": [1.0], "other": 1}])
def test_fields_are_checked(fields):
    with pytest.raises(ValidationError):
        Box(**fields)


def test_it_is_a_frozen_dataclass():
    box = Box([1, 2])
    assert box == Box((1.0, 2.0)) and hash(box) == hash(Box((1.0, 2.0)))
    assert replace(box, count=4) == Box((1.0, 2.0), 4)
    assert pickle.loads(pickle.dumps(box)) == box
    with pytest.raises(FrozenInstanceError):
        box.count = 4


def test_no_public_signature_shows_checks():
    from drakearm import Muscle, PpoSettings
    from drakearm.planning import reach

    for shown in (Muscle, PpoSettings, type(reach((0, 60), (10, 90), 0.6))):
        assert "Annotated" not in str(inspect.signature(shown))
