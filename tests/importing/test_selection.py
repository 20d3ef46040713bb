"""The part of a model that becomes the limb: a tree with one to four rotations, named and ordered."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import ImportingError
from drakearm.importing.selection import select
from drakearm.importing.source import GROUND, Body, Coordinate, Joint, SourceModel


def coordinate(name, **changes):
    return replace(Coordinate(name, "rotation", -1.0, 1.0, 0.25, False), **changes)


def chain(*coordinates):
    """A chain of bodies b1, b2, ..., each turned against the one before it by one coordinate."""
    names = [GROUND, *(f"b{i + 1}" for i in range(len(coordinates)))]
    joints = tuple(Joint(f"j{i + 1}", names[i], names[i + 1], (each.name,)) for i, each in enumerate(coordinates))
    bodies = {name: Body(name, 1.0, np.zeros(3), np.eye(3)) for name in names[1:]}
    by_name = {each.name: each for each in coordinates}
    return SourceModel("chain", "test", np.zeros(3), bodies, joints, by_name, (), "")


def refusal(model, only=(), **locks):
    with pytest.raises(ImportingError) as caught:
        select(model, only, locks)
    return str(caught.value)


def test_all_bodies_are_kept_parents_first():
    model = chain(*(coordinate(name) for name in "abc"))
    selection = select(replace(model, joints=model.joints[::-1]), (), {})
    assert selection.bodies == (GROUND, "b1", "b2", "b3")
    assert list(selection.limits) == ["a", "b", "c"]
    assert selection.limits["a"] == (-1.0, 1.0) and not selection.notes


def test_a_body_whose_parent_is_not_kept_is_fixed():
    selection = select(chain(*(coordinate(name) for name in "abc")), ["b2", "b3"], {})
    assert selection.roots == ("b2",) and list(selection.limits) == ["c"]
    assert selection.notes == ("b2 is fixed in the world, because its parent is not kept",)


def test_coordinates_are_locked_by_the_user_and_by_the_file():
    model = chain(coordinate("a"), coordinate("b", locked=True), coordinate("c", kind="translation"))
    selection = select(model, (), {"c": 0.5})
    assert list(selection.limits) == ["a"]
    assert selection.notes == ("b is locked at 14.3239 degrees, as in the file", "c is locked at 0.5 m")


def test_more_than_four_coordinates_are_counted_and_named():
    model = chain(*(coordinate(name) for name in "abcde"))
    sentence = refusal(model)
    assert "chain has 5 coordinates that move (a, b, c, d, e): expected 1 to 4" in sentence
    assert "--lock" in sentence and "--only" in sentence
    assert list(select(model, (), {"c": 0.0}).limits) == ["a", "b", "d", "e"]


@pytest.mark.parametrize(
    "changes, expected",
    [
        ({"kind": "translation"}, "a translation: a, b. Please lock them with --lock COORDINATE=METERS, or leave"),
        ({"kind": "ball joint"}, "a ball joint: a, b. Please leave the joints out with --only"),
        ({"follows": "c"}, "Constraints couple coordinates (a follows c, b follows c): lock those that follow"),
        ({"lower": 2.0}, "The range of a is 2 to 1 rad: it is empty"),
    ],
)
def test_what_a_limb_cannot_have_is_named(changes, expected):
    model = chain(coordinate("a", **changes), coordinate("b", **changes), coordinate("c"))
    assert expected in refusal(model)


def test_a_coordinate_without_range_gets_one():
    selection = select(chain(coordinate("a", lower=-99999.0, upper=np.inf)), (), {})
    assert selection.limits["a"] == (-np.pi, np.pi)
    assert selection.notes == ("a has no range in the file: its joint gets -180 to 180 degrees",)


def test_loops_are_refused():
    model = chain(coordinate("a"), coordinate("b"))
    closed = (*model.joints, Joint("closing", GROUND, "b2", ()))
    assert "b2 is the child of several joints" in refusal(replace(model, joints=closed))
    ring = (Joint("one", "b1", "b2", ()), Joint("two", "b2", "b1", ()))
    assert "form a loop" in refusal(replace(model, joints=ring))
