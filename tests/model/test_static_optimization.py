"""Static optimization: it exerts the given torques with the least activations, and finds the limits of strength."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from drakearm.model import MakeTorqueArm
from drakearm.model.musculature import equilibrium_fiber_lengths, mtu_velocity, muscle_geometry, tendon_forces
from drakearm.model.skeleton import gravity_torque
from drakearm.model.static_optimization import (
    acceleration_weighting,
    excitations_to_reach,
    static_activations,
    steady_force,
)
from drakearm.muscle.activation import activation_step

TORQUES = np.eye(2)  # the weighting by which the reserve torques are as small as possible
POSTURES = np.deg2rad([[0, 0], [0, 90], [-30, 90], [-20, 80], [20, 20], [-40, 120]])


def optimize(arm, q, v, tau, weighting=TORQUES):
    guess = arm.muscle_table["minimum_activation"].copy()
    q, v, tau = map(np.asarray, (q, v, tau))
    return static_activations(q, v, tau, guess, weighting, arm.muscle_table, arm.path_table)


def exerted(arm, a, q, v):
    """Torque (n_q,), Nm, of muscles whose tendons keep their strain (see `steady_force`)."""
    length, moment_arm = muscle_geometry(q, arm.muscle_table, arm.path_table)
    muscles = enumerate(arm.muscle_table.view(np.recarray))
    force = [steady_force(a[i], length[i], mtu_velocity(i, moment_arm, v), 0.1, m)[0] for i, m in muscles]
    return moment_arm.T @ force


@pytest.fixture(params=[("thelen2003", "compliant"), ("thelen2003", "rigid"), ("degroote2016", "compliant")])
def any_arm(request, arm):
    model, tendon = request.param
    return replace(arm, muscles=tuple(replace(m, model=model, tendon=tendon) for m in arm.muscles))


def with_strength(arm, factor):
    muscles = (replace(m, max_isometric_force=factor * m.max_isometric_force) for m in arm.muscles)
    return replace(arm, muscles=tuple(muscles))


def test_a_weak_limb_needs_the_same_activations_for_its_share_of_the_torque(arm):
    """Otherwise the torques of an animal's limb, some mNm, would count less than its activations."""
    q, v, tau = np.array([-0.3, 1.4]), np.array([1.0, -2.0]), np.array([0.02, -0.01])
    weak, _ = optimize(with_strength(arm, 1e-2), q, v, tau)
    weakest, reserve = optimize(with_strength(arm, 1e-5), q, v, 1e-3 * tau)
    np.testing.assert_allclose(weakest, weak, rtol=1e-6)
    np.testing.assert_allclose(reserve, 0.0, atol=1e-8)


@pytest.mark.parametrize("q", POSTURES)
def test_activations_hold_a_posture_with_muscles_in_equilibrium(arm, q):
    tau = gravity_torque(MakeTorqueArm(arm), q)
    a, reserve = optimize(arm, q, np.zeros(2), tau)
    fibers = np.concatenate([a, equilibrium_fiber_lengths(arm, q[None, :], a)[0]])
    _, actual = tendon_forces(fibers, np.concatenate([q, np.zeros(2)]), arm.muscle_table, arm.path_table)
    np.testing.assert_allclose(reserve, 0.0, atol=1e-3)
    np.testing.assert_allclose(actual, tau, atol=1e-3)


def test_muscles_and_reserve_together_exert_the_torque(any_arm):
    rng = np.random.default_rng(0)
    for _ in range(30):
        q, v, tau = rng.uniform([-0.9, 0.1], [0.5, 2.0]), rng.normal(size=2), 20.0 * rng.normal(size=2)
        a, reserve = optimize(any_arm, q, v, tau)
        np.testing.assert_allclose(exerted(any_arm, a, q, v) + reserve, tau, atol=1e-6)
        assert np.all((a >= any_arm.muscle_table["minimum_activation"]) & (a <= 1.0))


def test_where_one_joint_is_too_weak_the_other_keeps_its_acceleration(arm):
    plant = MakeTorqueArm(arm, 5.0)
    context = plant.CreateDefaultContext()
    q, rest, tau = np.array([0.0, 1.0]), np.zeros(2), np.array([40.0, 25.0])  # more than the shoulder can exert
    plant.SetPositions(context, q)
    mass = plant.CalcMassMatrix(context)
    missed = lambda reserve: np.abs(np.linalg.solve(mass, reserve))  # noqa: E731 (rad/s^2, of each joint)
    _, by_torque = optimize(arm, q, rest, tau)
    _, alike = optimize(arm, q, rest, tau, acceleration_weighting(mass, np.ones(2)))
    _, elbow_first = optimize(arm, q, rest, tau, acceleration_weighting(mass, np.array([1e-4, 1.0])))
    assert missed(elbow_first)[1] < 0.01 * missed(by_torque)[1]
    assert missed(elbow_first)[1] < missed(alike)[1] < missed(by_torque)[1]


def test_the_weighting_does_not_matter_where_the_muscles_are_strong_enough(arm):
    q, v, tau = np.array([0.0, 1.0]), np.array([0.5, 2.0]), np.array([2.0, 1.0])
    a, reserve = optimize(arm, q, v, tau)
    other, _ = optimize(arm, q, v, tau, np.array([[0.3, -0.2], [0.1, 1.0]]))
    np.testing.assert_allclose(reserve, 0.0, atol=1e-3)
    np.testing.assert_allclose(other, a, atol=2e-3)


@pytest.mark.parametrize("q", POSTURES[1:4])
def test_no_smaller_activations_exert_the_torque(arm, q):
    v, tau = np.array([0.5, 2.0]), gravity_torque(MakeTorqueArm(arm, 1.0), q)
    a, reserve = optimize(arm, q, v, tau)
    np.testing.assert_allclose(reserve, 0.0, atol=1e-3)
    best = minimize(
        lambda x: x @ x,
        np.full(14, 0.3),
        jac=lambda x: 2.0 * x,
        bounds=[(m.minimum_activation, 1.0) for m in arm.muscles],
        constraints={"type": "eq", "fun": lambda x: exerted(arm, x, q, v) - tau},
        method="SLSQP",
        options={"ftol": 1e-10, "maxiter": 300},
    )
    assert best.success
    assert a @ a <= best.fun + 1e-4


def test_force_slope_is_the_derivative_with_respect_to_activation(any_arm):
    rng, h = np.random.default_rng(1), 1e-5
    for _ in range(20):
        length, moment_arm = muscle_geometry(
            rng.uniform([-0.9, 0.1], [0.5, 2.0]), any_arm.muscle_table, any_arm.path_table
        )
        v, a = rng.normal(size=2), rng.uniform(0.02, 0.98)
        for i, m in enumerate(any_arm.muscle_table.view(np.recarray)):
            speed = mtu_velocity(i, moment_arm, v)
            above, below = (steady_force(a + d, length[i], speed, 0.1, m)[0] for d in (h, -h))
            slope = steady_force(a, length[i], speed, 0.1, m)[1]
            np.testing.assert_allclose((above - below) / (2 * h), slope, rtol=1e-3, atol=1e-3 * m.max_isometric_force)


# The moment arms of OpenSim's wrapped paths differ from those of the splines by up to 1.4 mm. Hence the tolerance.
@pytest.mark.parametrize("shoulder, elbow", [(0, 90), (-30, 90), (-20, 80), (0, 0), (-45, 60), (20, 0), (0, 60)])
def test_largest_held_mass_is_that_of_opensim(arm, oracle, shoulder, elbow):
    strength = oracle("static_strength.npz")
    at = np.flatnonzero(strength["shoulder_deg"] == shoulder)[0], np.flatnonzero(strength["elbow_deg"] == elbow)[0]
    q, expected = np.deg2rad([shoulder, elbow]), strength["compliant_max_mass"][at]
    empty = gravity_torque(MakeTorqueArm(arm), q)
    per_kilogram = gravity_torque(MakeTorqueArm(arm, 1.0), q) - empty
    for mass, held in ((0.95 * expected, True), (1.05 * expected, False)):
        _, reserve = optimize(arm, q, np.zeros(2), empty + mass * per_kilogram)
        assert (np.abs(reserve).max() < 0.01) == held


def test_excitations_bring_the_activations_to_the_desired_ones_in_one_step(arm):
    muscles = arm.muscle_table.view(np.recarray)
    activation, desired = np.full(14, 0.3), np.linspace(0.25, 0.4, 14)
    excitation = excitations_to_reach(desired, activation, 0.01, arm.muscle_table)
    for _ in range(10):
        activation = np.array(
            [activation_step(a, u, 0.001, m) for a, u, m in zip(activation, excitation, muscles, strict=True)]
        )
    np.testing.assert_allclose(activation, desired, atol=0.015)
