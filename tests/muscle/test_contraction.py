"""Contraction dynamics: velocities, forces and equilibria against OpenSim, derivatives, and the implicit step."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from drakearm.model import load_arm
from drakearm.muscle.contraction import equilibrium_fiber_length, fiber_step, fiber_velocity, tendon_force
from drakearm.muscle.models import MODELS
from drakearm.muscle.thelen2003 import LINEAR_SLOPE, TOE_RATIO

ARM = load_arm("arm14")
muscles = st.integers(0, len(ARM.muscles) - 1)
activations = st.floats(0.01, 1.0)


def length_at(i, stretch):
    """The musculotendon length with the tendon at its slack length and the fiber at stretch * its optimal length."""
    m = ARM.muscle_table[i]
    along = np.sqrt(max((stretch * m["optimal_fiber_length"]) ** 2 - m["fiber_width"] ** 2, 0.0))
    return m["tendon_slack_length"] + along


def test_known_state_of_rest():
    """At full activation and optimal length the fiber carries F_max / cos(pennation) along the tendon."""
    for m in ARM.muscle_table:
        cosine = np.cos(np.arcsin(m["fiber_width"] / m["optimal_fiber_length"]))
        strain = m["tendon_strain"] * (TOE_RATIO + (cosine - 0.33) / LINEAR_SLOPE)  # a tendon force of F_max cos
        mtu_length = m["tendon_slack_length"] * (1 + strain) + m["optimal_fiber_length"] * cosine
        assert fiber_velocity(1.0, m["optimal_fiber_length"], mtu_length, m)[0] == pytest.approx(0.0, abs=1e-9)
        assert equilibrium_fiber_length(1.0, mtu_length, m) == pytest.approx(m["optimal_fiber_length"], abs=1e-9)


@settings(deadline=None)
@given(muscles, activations, st.floats(0.6, 1.5), st.floats(0.98, 1.03))
def test_slopes_are_derivatives(i, a, stretch, tension):
    m = ARM.muscle_table[i]
    assume(abs(stretch - 1.0) > 1e-4 and abs(tension - 1.0) > 1e-4)  # passive force and tendon force have kinks there
    point = np.array([a, stretch * m["optimal_fiber_length"], length_at(i, stretch) * tension])
    _, *slopes = fiber_velocity(*point, m)
    _, *force_slopes = tendon_force(*point[1:], m)
    assert_slopes(lambda x: fiber_velocity(*x, m)[0], point, slopes)
    assert_slopes(lambda x: tendon_force(*x, m)[0], point[1:], force_slopes)


def assert_slopes(function, point, slopes):
    """Each slope lies between the two one-sided differences, which are nearly equal except at a kink."""
    for j, slope in enumerate(slopes):
        step = 1e-7 * np.eye(len(point))[j]
        ahead = (function(point + step) - function(point)) / 1e-7
        behind = (function(point) - function(point - step)) / 1e-7
        tolerance = 1e-3 * max(abs(ahead), abs(behind), 1.0)
        assert min(ahead, behind) - tolerance <= slope <= max(ahead, behind) + tolerance


@settings(deadline=None)
@given(muscles, activations, st.floats(0.5, 1.5))
def test_fiber_rests_at_its_equilibrium(i, a, stretch):
    m = ARM.muscle_table[i]
    mtu_length = length_at(i, stretch) * 1.005
    fiber_length = equilibrium_fiber_length(a, mtu_length, m)
    velocity, _, slope, _ = fiber_velocity(a, fiber_length, mtu_length, m)
    assert abs(velocity) <= abs(slope) * 1e-9 + 1e-12  # within 1 nm of rest


FAR = [replace(ARM.muscles[3], model=model, **change) for model in MODELS for change in ({}, {"pennation_angle": 0.2})]
FAR = replace(ARM, muscles=tuple(replace(m, name=f"m{i}") for i, m in enumerate(FAR))).muscle_table


@settings(deadline=None)
@given(st.sampled_from(range(len(FAR))), st.floats(0.0, 1.0), st.floats(0.0, 1e3), st.floats(-1e6, 1e6))
@example(0, 0.01, 0.0, 0.3)  # a fiber without length has no direction
@example(0, 0.01, 30.0, 0.3)  # the active force is smaller than the smallest number
def test_velocity_and_force_are_finite_in_every_state(i, a, fiber_length, mtu_length):
    """Also where no fiber can be: far outside the range of a joint."""
    m = FAR[i]
    for values in (fiber_velocity(a, fiber_length, mtu_length, m), tendon_force(fiber_length, mtu_length, m)):
        assert np.isfinite(values).all()
    later, velocity = fiber_step(a, fiber_length, fiber_length, mtu_length, 1e-3, m)
    assert np.isfinite([later, velocity]).all()


def test_a_path_shorter_than_the_tendon_has_no_equilibrium():
    for m in ARM.muscle_table:
        assert np.isnan(equilibrium_fiber_length(0.5, 0.9 * m["tendon_slack_length"], m))


@settings(deadline=None)
@given(muscles, activations, st.floats(0.3, 1.7), st.floats(0.3, 1.7), st.floats(0.9, 1.1))
def test_step_is_bounded_and_satisfies_its_equation(i, a, stretch, fiber, previous):
    m = ARM.muscle_table[i]
    l0 = max(fiber * m["optimal_fiber_length"], 1.01 * m["minimum_fiber_length"])
    l_1 = l0 * previous
    mtu_length = length_at(i, stretch)
    later, velocity = fiber_step(a, l0, l_1, mtu_length, 1e-3, m)
    assert np.isfinite(later) and later >= m["minimum_fiber_length"]
    exact, _, slope, _ = fiber_velocity(a, later, mtu_length, m)
    shortest = max(m["minimum_fiber_length"], 0.01 * m["optimal_fiber_length"])
    if later > shortest * (1 + 1e-6):
        assert velocity == pytest.approx(exact, abs=1e-6 * m["optimal_fiber_length"] * max(abs(slope), 1500.0))


@pytest.mark.parametrize("muscle", ["BIClong", "TRIlong", "ANC"])
def test_step_is_of_second_order(muscle):
    i = ARM.muscle_names.index(muscle)
    m = ARM.muscle_table[i]
    start, end = 0.02, 0.06

    def path(t):
        return length_at(i, 1.0 + 0.1 * np.sin(20.0 * t))

    l0 = equilibrium_fiber_length(0.3, path(0.0), m)
    solution = solve_ivp(
        lambda t, x: [fiber_velocity(0.3, x[0], path(t), m)[0]],
        (0.0, end),
        [l0],
        method="Radau",
        rtol=1e-11,
        atol=1e-13,
        dense_output=True,
    )

    def error(steps):
        h = (end - start) / steps
        previous, fiber = solution.sol(start - h)[0], solution.sol(start)[0]
        for k in range(1, steps + 1):
            previous, (fiber, _) = fiber, fiber_step(0.3, fiber, previous, path(start + k * h), h, m)
        return abs(fiber - solution.sol(end)[0])

    assert error(40) < 1e-5
    assert error(80) / error(160) == pytest.approx(4.0, rel=0.4)


def test_equilibria_and_forces_against_opensim(oracle):
    statics = oracle("statics.npz")
    worst_length = worst_force = 0.0
    for k in range(len(statics["q"])):
        for i, m in enumerate(ARM.muscle_table):
            a, fiber, mtu = (statics[n][k, i] for n in ("activation", "fibre_length", "mtu_length"))
            if statics["equilibrium_failed"][k, i]:
                continue
            worst_length = max(worst_length, abs(equilibrium_fiber_length(a, mtu, m) - fiber))
            force = statics["tendon_force"][k, i]
            worst_force = max(worst_force, abs(tendon_force(fiber, mtu, m)[0] - force) / m["max_isometric_force"])
    print(f"largest errors: equilibrium {worst_length:.1e} m, tendon force {worst_force:.1e} F_max")
    assert worst_length < 1e-7
    assert worst_force < 1e-9


def test_fiber_velocity_against_opensim(oracle):
    """A pennated muscle in 4000 states: the relative errors of velocity and tendon force are small."""
    table = oracle("muscle_curves.npz")
    force, optimal, slack, _ = table["pennated_rig_params"]
    m = ARM.muscle_table[ARM.muscle_names.index("TRIlong")]
    assert (force, optimal, slack) == (m["max_isometric_force"], m["optimal_fiber_length"], m["tendon_slack_length"])
    columns = list(table["pennated_cols"])
    worst_velocity = worst_force = 0.0
    for row in table["pennated_rows"]:
        a, fiber, mtu, vnorm, tension = (
            row[columns.index(n)] for n in ("activation", "fibre_length_state", "mtu_length", "vnorm", "tendon_force")
        )
        velocity, *_ = fiber_velocity(a, fiber, mtu, m)
        worst_velocity = max(worst_velocity, abs(velocity / (10.0 * optimal) - vnorm) / max(1.0, abs(vnorm)))
        worst_force = max(worst_force, abs(tendon_force(fiber, mtu, m)[0] - tension) / max(1.0, tension))
    print(f"largest relative errors: velocity {worst_velocity:.1e}, tendon force {worst_force:.1e}")
    assert worst_velocity < 1e-9
    assert worst_force < 1e-9
