"""The axes of a joint are found from its motion, and motions that are no rotations are found out."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from drakearm.importing.hinges import find_hinges, moved

numbers = st.floats(-1.0, 1.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)


def rotation(axis, point, angle):
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec(axis * angle).as_matrix()
    pose[:3, 3] = point - pose[:3, :3] @ point
    return pose


@settings(max_examples=50, deadline=None)
@given(st.lists(st.tuples(vectors, vectors), min_size=1, max_size=3), vectors, st.randoms(use_true_random=False))
def test_rotations_in_any_order_are_found(lines, place, random):
    lines = [(axis / np.linalg.norm(axis), point) for axis, point in lines if np.linalg.norm(axis) > 0.1]
    if not lines:
        return
    order = list(range(len(lines)))
    random.shuffle(order)
    start = np.eye(4)
    start[:3, 3] = place

    def pose(q):
        result = np.eye(4)
        for i in order:
            result = result @ rotation(*lines[i], q[i])
        return result @ start

    base, lower, upper = np.full(len(lines), 0.1), np.full(len(lines), -0.7), np.full(len(lines), 1.3)
    hinges = find_hinges(pose, base, lower, upper)
    assert hinges is not None
    for q in np.random.default_rng(0).uniform(lower, upper, (5, len(lines))):
        np.testing.assert_allclose(moved(hinges, q - base) @ pose(base), pose(q), atol=1e-9)


def test_the_point_on_the_axis_is_the_one_closest_to_the_child():
    axis = np.array([0.0, 0.6, 0.8])
    (hinge,) = find_hinges(lambda q: rotation(axis, np.array([0.1, 0.2, 0.3]), q[0]), *np.array([[0.0], [-1.0], [1.0]]))
    np.testing.assert_allclose(hinge.axis, axis, atol=1e-12)
    assert hinge.point @ axis == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    "angle, shift",
    [(lambda q: q, lambda q: 0.001 * q), (lambda q: 2.0 * q, lambda q: 0.0), (lambda q: q + 0.1 * q**2, lambda q: 0.0)],
    ids=["screw", "gear", "curve"],
)
def test_other_motions_are_found_out(angle, shift):
    axis = np.array([0.0, 0.0, 1.0])

    def pose(q):
        result = rotation(axis, np.array([0.1, 0.0, 0.0]), angle(q[0]))
        result[:3, 3] += axis * shift(q[0])
        return result

    assert find_hinges(pose, *np.array([[0.0], [-1.0], [1.0]])) is None
