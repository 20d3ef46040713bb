"""Families of dataclasses, from which a file chooses by `type`: what is read, what is refused, and the messages."""

import dataclasses

import pytest
from pydantic.dataclasses import dataclass

from drakearm.files.fields import Positive
from drakearm.files.kinds import Kind


class Shape(Kind):
    """A family."""


@dataclass(frozen=True)
class Circle(Shape):
    type = "circle"
    radius: Positive


@dataclasses.dataclass(frozen=True)
class Box(Shape):
    type = "box"
    width: float
    height: float = 1.0


class Sound(Kind):
    """Another family, which may use the same types."""


@dataclass(frozen=True)
class Circular(Sound):
    type = "circle"


def test_a_mapping_becomes_the_kind_that_it_names():
    assert Shape.read({"type": "circle", "radius": 2}) == Circle(radius=2.0)
    assert Shape.read({"type": "box", "width": "3"}) == Box(width=3.0)  # the standard library's dataclasses too
    assert Sound.read({"type": "circle"}) == Circular()


def test_a_kind_without_a_name_is_for_code_only():
    class Nameless(Shape):
        type = ""

    assert Shape.read(nameless := Nameless()) is nameless
    with pytest.raises(ValueError, match=r"expected one of box, circle$"):
        Shape.read({"type": ""})


def test_a_member_of_the_family_stays_what_it_is():
    circle = Circle(radius=1.0)
    assert Shape.read(circle) is circle


@pytest.mark.parametrize("type_", ["ball", "", None, 3, 1.5, True, [], [[]], {}, {"a": {}}])
def test_an_unknown_type_is_refused_with_a_list_of_the_known_ones(type_):
    with pytest.raises(ValueError, match=r"^type: found .*, expected one of box, circle$") as raised:
        Shape.read({"type": type_, "radius": 1.0})
    assert repr(type_) in str(raised.value)


def test_a_mapping_without_a_type_is_refused():
    with pytest.raises(ValueError, match=r"^type: found None, expected one of box, circle$"):
        Shape.read({"radius": 1.0})


@pytest.mark.parametrize("value", ["circle", 3, None, ["circle"], Circular()])
def test_a_value_that_is_not_a_mapping_is_refused(value):
    with pytest.raises(ValueError, match=r"^found .*, expected a mapping with a type, one of box, circle$"):
        Shape.read(value)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"type": "circle"}, r"^circle.radius: "),
        ({"type": "circle", "radius": -1.0}, r"^circle.radius: .*greater than 0"),
        ({"type": "circle", "radius": 1.0, "radios": 1.0}, r"^circle.radios: expected one of the fields radius$"),
        ({"type": "box", "width": 1.0, "hight": 2.0}, r"^box.hight: expected one of the fields width, height$"),
        ({"type": "box", "width": 1.0, 7: 2.0}, r"^box.7: expected one of"),
        ({"type": "box", "width": "wide", "height": "high"}, r"^box.width: found 'wide', .* \(and 1 more problem\)$"),
    ],
)
def test_a_wrong_field_is_named_with_its_type(fields, message):
    with pytest.raises(ValueError, match=message):
        Shape.read(fields)


def test_two_kinds_of_a_family_cannot_have_the_same_type():
    with pytest.raises(TypeError, match=r"Disk has the type 'circle' of .*Circle: expected a type of its own"):

        class Disk(Shape):
            type = "circle"

    assert Shape.read({"type": "circle", "radius": 1.0}) == Circle(radius=1.0)


def test_a_kind_that_derives_from_another_needs_a_type_of_its_own():
    with pytest.raises(TypeError, match=r"Ring: expected a `type`"):

        class Ring(Circle):
            pass


def test_a_kind_may_be_defined_again():
    """This happens if a notebook cell runs twice: the last definition counts."""

    def define(default: float) -> type:
        @dataclass(frozen=True)
        class Ellipse(Shape):
            type = "ellipse"
            eccentricity: float = default

        return Ellipse

    first, last = define(0.1), define(0.2)
    assert first is not last
    assert Shape.read({"type": "ellipse"}) == last(eccentricity=0.2)
