"""A limb with two branches: its compiled equations of motion, plan, environments and static optimization."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.diagrams import MakeStaticLoop
from drakearm.learning import ArmVectorEnv
from drakearm.model import load_arm
from drakearm.model.dynamics import forward_dynamics
from drakearm.model.dynamics_table import read_dynamics
from drakearm.model.points import point_positions, read_points
from drakearm.model.skeleton import skeleton_plant
from drakearm.planning import Movement, plan
from drakearm.planning.costs import TorqueRate
from drakearm.task import RewardWeights, TrackingTask
from tests.limbs import write_fork
from tests.parity import assert_parity, diagrams


@pytest.fixture(scope="module")
def fork(tmp_path_factory):
    return load_arm(write_fork(tmp_path_factory.mktemp("fork")))


@pytest.fixture(scope="module")
def planned(fork):
    movement = Movement(
        start_deg=(0, 0, 0),
        target_deg=(15, 25, -25),
        duration=0.4,
        speed_limit=(15, 15, 15),
        torque_limit=(10, 10, 10),
        costs=(TorqueRate(weight=0.1),),
        knots=11,
    )
    return plan(fork, movement)


def test_accelerations_and_points_are_those_of_the_plant(fork):
    plant, rng = skeleton_plant(fork), np.random.default_rng(0)
    table, context = read_dynamics(plant), plant.CreateDefaultContext()
    tips = [("left", (0.0, 0.0, -0.1)), ("right", (0.0, 0.0, -0.1))]
    points = read_points(plant, tips)
    for _ in range(20):
        q, v, tau = rng.uniform(-1, 1, 3), rng.uniform(-3, 3, 3), rng.uniform(-1, 1, 3)
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        plant.get_applied_generalized_force_input_port().FixValue(context, tau)
        expected = plant.EvalTimeDerivatives(context).get_generalized_velocity().CopyToVector()
        np.testing.assert_allclose(forward_dynamics(q, v, tau, table), expected, rtol=1e-10, atol=1e-10)
        for position, (body, p) in zip(point_positions(q, points)[0], tips, strict=True):
            p_WP = plant.GetBodyByName(body).EvalPoseInWorld(context).multiply(np.array(p))
            np.testing.assert_allclose(position, p_WP, atol=1e-12)


def test_a_plan_ends_at_the_target(planned):
    np.testing.assert_allclose(planned.reference.q[-1], np.deg2rad([15, 25, -25]), atol=1e-6)


def task_of(fork, planned):
    weights = RewardWeights(position=(10.0,) * 3, velocity=(0.1,) * 3, acceleration=(1e-6,) * 3)
    return TrackingTask(fork, planned.reference, weights)


def test_both_environments_compute_the_same(fork, planned):
    task, n = task_of(fork, planned), len(fork.muscles)
    actions = np.random.default_rng(0).random((30, 2, n))
    assert_parity(["fork"] * 2, ArmVectorEnv(task, 2), diagrams([task] * 2), actions, seed=7)


def test_static_optimization_follows_the_plan(fork, planned):
    task = task_of(fork, planned)
    recording = MakeStaticLoop(replace(task, load_mass=0.0)).Run()
    assert np.abs(recording.q - recording.reference_q).max() < 0.1
