"""Proprioception, TrackingReward and PolicyController: their outputs for known inputs."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import LogVectorOutput, TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from drakearm.errors import TaskError
from drakearm.systems import PolicyController, Proprioception, TrackingReward
from drakearm.task import OBSERVATIONS, AbsoluteErrors, Reward, RewardWeights


def test_paper_observation_is_normalized_lengths_and_velocities(task, outputs):
    senses = Proprioception(replace(task, senses=OBSERVATIONS["paper"]))
    optimal = task.arm.muscle_table["optimal_fiber_length"]
    inputs = {"fiber_length": 1.1 * optimal, "fiber_velocity": -0.5 * optimal}
    (observation,) = outputs(senses, inputs, ["observation"])
    np.testing.assert_allclose(observation, [1.1] * 14 + [-0.05] * 14)


def test_full_observation_adds_activation_joints_and_preview(task, outputs):
    inputs = {
        "fiber_length": np.zeros(14),
        "fiber_velocity": np.zeros(14),
        "activation": np.linspace(0.0, 1.0, 14),
        "arm_state": [0.1, 0.2, 3.0, 4.0],
        "preview_q": np.arange(6.0),
        "preview_v": np.arange(6.0, 12.0),
    }
    (observation,) = outputs(Proprioception(task), inputs, ["observation"])
    np.testing.assert_allclose(observation[28:42], np.linspace(0.0, 1.0, 14))
    np.testing.assert_allclose(observation[42:46], [0.1, 0.2, 0.3, 0.4])
    np.testing.assert_allclose(observation[46:], [0, 1, 2, 3, 4, 5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1])


def test_reward_is_equation_6_of_the_paper(task, outputs):
    weights = RewardWeights(position=(1.0, 2.0), velocity=(0.1, 0.2), acceleration=(0.01, 0.02))
    inputs = {
        "arm_state": [0.1, 0.2, 1.0, 2.0],
        "arm_acceleration": [3.0, 4.0],
        "reference": [0.4, 0.0, 0.0, 1.0],
    }
    reward, error = outputs(TrackingReward(replace(task, reward=weights)), inputs, ["reward", "tracking_error"])
    expected = -(0.09 + 2 * 0.04) - (0.1 * 1.0 + 0.2 * 1.0) - (0.01 * 9.0 + 0.02 * 16.0)
    assert reward[0] == pytest.approx(expected)
    np.testing.assert_allclose(error, [-0.3, 0.2])


def test_absolute_errors_are_weighted_and_negative(task, outputs):
    weights = AbsoluteErrors(position=(1.0, 2.0), velocity=(0.1, 0.2))
    inputs = {"arm_state": [0.1, 0.2, 1.0, 2.0], "reference": [0.4, 0.0, 0.0, 1.0]}
    reward, _ = outputs(TrackingReward(replace(task, reward=weights)), inputs, ["reward", "tracking_error"])
    assert reward[0] == pytest.approx(-(0.3 + 2 * 0.2) - (0.1 * 1.0 + 0.2 * 1.0))
    np.testing.assert_allclose(weights.priority(task.arm), [0.25, 1.0])
    assert Reward.read({"type": "absolute_errors", "position": [1, 2], "velocity": [0.1, 0.2]}) == weights
    with pytest.raises(TaskError, match="velocity has 1 weights: expected 2, for shoulder, elbow"):
        replace(task, reward=AbsoluteErrors(position=(1.0, 2.0), velocity=(0.1,)))


def test_policy_decides_at_control_steps_and_holds_its_excitations_in_between():
    """The policy returns its observation, a ramp. So the output is the ramp at the last control step."""
    builder = DiagramBuilder()
    ramp = builder.AddSystem(TrajectorySource(PiecewisePolynomial.FirstOrderHold([0.0, 1.0], [[0.0, 1.0]])))
    controller = builder.AddSystem(PolicyController(lambda observation: observation, 1, 1, 0.01))
    builder.Connect(ramp.get_output_port(), controller.GetInputPort("observation"))
    log = LogVectorOutput(controller.GetOutputPort("excitation"), builder, 0.005)
    simulator = Simulator(builder.Build())
    simulator.AdvanceTo(0.05)
    data = log.FindLog(simulator.get_context())
    middle = data.data()[0, 1::2]  # at 5 ms, 15 ms, ...
    np.testing.assert_allclose(middle, [0.0, 0.01, 0.02, 0.03, 0.04], atol=1e-12)
