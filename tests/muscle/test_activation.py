"""Activation dynamics: OpenSim's rate, bounds, and a step of second order."""

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from drakearm.model import load_arm
from drakearm.muscle.activation import activation_rate, activation_step

M = load_arm("arm14").muscle_table[0]
excitations = st.floats(0.0, 1.0)
activations = st.floats(0.01, 1.0)


def test_known_rates():
    """Rising: (u - a) / (0.01 (0.5 + 1.5 a)); falling: (u - a) (0.5 + 1.5 a) / 0.04."""
    assert activation_rate(0.5, 1.0, M)[0] == pytest.approx(0.5 / (0.01 * 1.25))
    assert activation_rate(0.5, 0.1, M)[0] == pytest.approx(-0.4 * 1.25 / 0.04)
    assert activation_rate(0.3, 0.3, M)[0] == 0.0


def test_rate_against_opensim(oracle):
    table = oracle("muscle_curves.npz")
    for i, a in enumerate(table["act_a"]):
        for j, u in enumerate(table["act_u"]):
            if a >= 0.01 and 0.01 <= u <= 1.0:  # drakearm clamps excitations, so activations stay in this range
                assert activation_rate(a, u, M)[0] == pytest.approx(table["act_adot"][i, j], abs=1e-9)


@settings(deadline=None)
@given(activations, excitations)
def test_slopes_are_derivatives(a, u):
    step = 1e-7
    assume(abs(max(u, 0.01) - a) > 1e-5 and abs(u - 0.01) > 1e-5 and u < 1.0 - 1e-5)  # the kinks
    _, by_activation, by_excitation = activation_rate(a, u, M)
    numeric = (activation_rate(a + step, u, M)[0] - activation_rate(a - step, u, M)[0]) / (2 * step)
    assert by_activation == pytest.approx(numeric, rel=1e-4, abs=1e-4)
    numeric = (activation_rate(a, u + step, M)[0] - activation_rate(a, u - step, M)[0]) / (2 * step)
    assert by_excitation == pytest.approx(numeric, rel=1e-4, abs=1e-4)


@settings(deadline=None)
@given(activations, st.floats(-1.0, 2.0))
def test_activation_stays_in_its_range_and_approaches_the_excitation(a, u):
    later = activation_step(a, u, 1e-3, M)
    goal = min(max(u, 0.01), 1.0)
    assert 0.01 <= later <= 1.0
    assert min(a, goal) - 1e-12 <= later <= max(a, goal) + 1e-12


@settings(deadline=None)
@given(activations, excitations, excitations)
def test_more_excitation_gives_more_activation(a, u, w):
    low, high = sorted((u, w))
    assert activation_step(a, low, 1e-3, M) <= activation_step(a, high, 1e-3, M)


@pytest.mark.parametrize(("start", "u"), [(0.05, 0.8), (0.9, 0.1)])
def test_step_is_of_second_order(start, u):
    exact = solve_ivp(lambda t, a: [activation_rate(a[0], u, M)[0]], (0, 0.02), [start], rtol=1e-11, atol=1e-12).y[
        0, -1
    ]

    def error(steps):
        a = start
        for _ in range(steps):
            a = activation_step(a, u, 0.02 / steps, M)
        return abs(a - exact)

    assert error(20) < 2e-3
    assert error(20) / error(40) == pytest.approx(4.0, rel=0.3)
