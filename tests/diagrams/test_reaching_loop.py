"""The reaching loop: targets change at the input port, at rest and in the middle of a movement."""

import numpy as np
import pytest

from drakearm.diagrams import MakeReachingLoop, MakeSimulator
from drakearm.planning import ReachPlanner
from drakearm.repertoire import load_repertoire
from drakearm.repertoire.shipped import shipped_policy

HOME, FORWARD, BACK = np.deg2rad([[-20.0, 80.0], [10.0, 60.0], [-20.0, 100.0]])


@pytest.fixture(scope="module")
def reached(arm):
    """A function from a sequence of targets and times to the angles (n_q,), rad, after each of these times (s)."""
    planner, policy = ReachPlanner(arm), shipped_policy("reaching")
    task = load_repertoire("reaching").task(planner.rest(HOME))
    loop = MakeReachingLoop(task, policy.act, lambda q, v, target, a: planner(q, v, target, 0.5, a), HOME)

    def run(steps):
        simulator = MakeSimulator(loop.diagram)
        context = simulator.get_mutable_context()
        port = loop.diagram.GetInputPort("target")
        port.FixValue(context, HOME)
        loop.Reset(context)
        simulator.Initialize()
        angles = []
        for target, seconds in steps:
            port.FixValue(context, target)
            simulator.AdvanceTo(context.get_time() + seconds)
            angles.append(loop.diagram.GetOutputPort("arm_state").Eval(context)[:2])
        return np.array(angles)

    return run


def test_a_sequence_of_targets(reached):
    angles = reached([(HOME, 0.1), (FORWARD, 0.7), (BACK, 0.7)])
    np.testing.assert_allclose(angles, [HOME, FORWARD, BACK], atol=0.03)


def test_a_target_that_changes_in_mid_movement(reached):
    middle, end = reached([(FORWARD, 0.25), (BACK, 0.7)])
    assert np.abs(middle - FORWARD).max() > 0.1 and np.abs(middle - HOME).max() > 0.1
    np.testing.assert_allclose(end, BACK, atol=0.03)
