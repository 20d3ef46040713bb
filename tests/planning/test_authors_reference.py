"""The timing movement with the authors' weights, compared with their own trajectory."""

from pathlib import Path

import numpy as np
import pytest

from drakearm.model import Arm, MakeTorqueArm
from drakearm.model.dynamics import forward_dynamics
from drakearm.model.dynamics_table import read_dynamics
from drakearm.model.skeleton import gravity_torque
from drakearm.planning import HeldJoint, Movement, Posture, Torque, TorqueRate, plan
from tests.authors_pendulum import GRAVITY, LENGTHS, MASS, RODS, authors_pendulum, lighter

REFERENCE = Path(__file__).parents[3] / "shared" / "paper_reference" / "target_of_elbow_fixed_theta0.npy"
BENT = np.array([0.0, np.pi / 2])


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory) -> Arm:
    return authors_pendulum(tmp_path_factory.mktemp("pendulum"))


def plan_as_authors(arm: Arm, torque_limit: tuple[float, float]) -> np.ndarray:
    """The forearm's angle from the vertical, rad, every 10 ms of the first 0.75 s."""
    movement = Movement(
        start_deg=(0, 0),
        target_deg=(0, 90),
        duration=1.6,
        hold=0.0,
        knots=81,
        speed_limit=(30, 30),
        torque_limit=torque_limit,
        costs=[
            HeldJoint(joint="shoulder", angle_deg=0, weight=1000),
            Posture(running=(0, 1)),
            Torque(weight=(0, 1)),
            TorqueRate(weight=0.01),
        ],
    )
    return plan(arm, movement).reference.q[:75].sum(axis=1)


def departure(forearm: np.ndarray) -> float:
    """The largest difference from the authors' forearm, rad."""
    if not REFERENCE.is_file():
        pytest.skip("the authors' trajectory is not here")
    return float(np.abs(forearm - np.load(REFERENCE)).max())


def test_the_pendulum_moves_as_the_authors_wrote(pendulum):
    """Their equations, in absolute angles and with torques from the world, agree with the skeleton file."""
    upper, fore = LENGTHS["upper_arm"], LENGTHS["forearm"]
    inertia_upper, inertia_fore = (RODS[name] * (LENGTHS[name] / 2) ** 2 / 3 for name in LENGTHS)
    dynamics = read_dynamics(MakeTorqueArm(pendulum))
    rng = np.random.default_rng(0)
    for q, v, tau in rng.uniform(-2, 2, (20, 3, 2)):
        theta, speed = np.cumsum(q), np.cumsum(v)
        a = np.cumsum(forward_dynamics(q, v, tau, dynamics))
        couple = 0.5 * MASS * upper * fore
        between = theta[0] - theta[1]
        left = [
            (upper**2 * 1.25 * MASS + inertia_upper) * a[0]
            + couple * (np.cos(between) * a[1] + np.sin(between) * speed[1] ** 2)
            + 1.5 * MASS * GRAVITY * upper * np.sin(theta[0]),
            couple * (np.cos(between) * a[0] - np.sin(between) * speed[0] ** 2)
            + (0.25 * MASS * fore**2 + inertia_fore) * a[1]
            + 0.5 * MASS * GRAVITY * fore * np.sin(theta[1]),
        ]
        np.testing.assert_allclose(left, [tau[0] - tau[1], tau[1]], atol=1e-12)


@pytest.mark.slow
def test_their_pendulum_follows_their_trajectory(pendulum):
    """Theirs also avoids two circles, one of them at its end. Without them their own solver departs by 0.075 rad."""
    assert departure(plan_as_authors(pendulum, (0.7, 0.35))) < 0.1


@pytest.mark.slow
def test_the_masses_explain_how_the_arm_departs(arm, pendulum, tmp_path):
    """To hold the forearm up costs torque^2, to stay down angle^2: the real arm stays down, a lighter one moves up."""
    heavy, light = gravity_torque(MakeTorqueArm(arm), BENT)[1], gravity_torque(MakeTorqueArm(pendulum), BENT)[1]
    assert light**2 < 1 < heavy**2  # (q - pi/2)^2 + (torque sin q)^2 has its minimum at pi/2 only below 1
    assert plan_as_authors(arm, (60, 60)).max() < 0.2
    assert departure(plan_as_authors(lighter(arm, light / heavy, tmp_path), (0.7, 0.35))) < 0.1
