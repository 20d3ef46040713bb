"""Reaches start in any state, also a moving one, and end at rest at their target."""

import numpy as np
import pytest

from drakearm.errors import PlanningError
from drakearm.model.skeleton import hand_motion
from drakearm.planning import ReachPlanner, posture_at


@pytest.fixture(scope="module")
def planner(arm):
    return ReachPlanner(arm, hold=0.1)


@pytest.mark.parametrize(("v", "a"), [((0.0, 0.0), None), ((1.5, -2.0), (5.0, -10.0))])
def test_it_continues_any_state_and_comes_to_rest(planner, v, a):
    q, target = np.deg2rad([-20.0, 80.0]), np.deg2rad([10.0, 60.0])
    reference = planner(q, np.array(v), target, 0.5, None if a is None else np.array(a))
    np.testing.assert_allclose(reference.q[0], q, atol=1e-9)
    np.testing.assert_allclose(reference.v[0], v, atol=1e-9)
    np.testing.assert_allclose(reference.a[0], (0.0, 0.0) if a is None else a, atol=1e-6)
    np.testing.assert_allclose(reference.q[-1], target, atol=1e-6)
    np.testing.assert_allclose(reference.v[-1], 0.0, atol=1e-6)
    assert reference.duration == pytest.approx(0.6) and reference.problem() is None


def test_what_is_too_fast_is_refused(planner):
    with pytest.raises(PlanningError, match=r"There is no plan to the target in 0.05 s"):
        planner(np.deg2rad([-40.0, 20.0]), np.zeros(2), np.deg2rad([60.0, 120.0]), 0.05)


def test_the_posture_brings_the_hand_to_its_place(planner, arm):
    for x, y in ((0.3, 0.5), (0.1, 0.3), (0.45, 0.8)):
        q = posture_at(planner.model, x, y, near=np.deg2rad([0.0, 60.0]))
        p_WH = hand_motion(planner.model.plant, arm, q[None], 0.0 * q[None])[0][0]
        np.testing.assert_allclose(p_WH[:2], (x, y), atol=1e-3)
        assert (q >= planner.model.lower).all() and (q <= planner.model.upper).all()


def test_a_place_out_of_reach_is_refused(planner):
    with pytest.raises(PlanningError, match=r"cannot reach x = 1 m, y = 1 m: it stays \d+.\d cm away"):
        posture_at(planner.model, 1.0, 1.0, near=np.zeros(2))
