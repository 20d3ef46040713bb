"""The curves of the Thelen (2003) muscle: known values, laws, derivatives, and values computed by OpenSim."""

import numpy as np
import pytest

from drakearm.muscle import thelen2003 as curves

from ..velocity_curve import velocity_of_ratio


@pytest.fixture(scope="module")
def m(arm):
    return arm.muscle_table[0]


def test_known_values(m):
    assert curves.active_force_length(1.0, m) == (1.0, 0.0)
    assert curves.passive_force_length(1.6, m)[0] == pytest.approx(1.0)
    assert curves.passive_force_length(0.9, m) == (0.0, 0.0)
    assert curves.tendon_force_strain(0.033, m)[0] == pytest.approx(1.0)
    assert curves.tendon_force_strain(-0.01, m) == (0.0, 0.0)
    assert velocity_of_ratio(1.0, m)[0] == 0.0
    assert velocity_of_ratio(0.0, m)[0] == pytest.approx(-1.0)  # the largest contraction velocity
    assert curves.TOE_RATIO * 0.033 == pytest.approx(0.02008431275, abs=1e-11)
    assert curves.LINEAR_SLOPE / 0.033 == pytest.approx(51.87490120, abs=1e-7)


@pytest.mark.parametrize(
    ("curve", "low", "high"),
    [
        (curves.active_force_length, 0.3, 1.8),
        (curves.passive_force_length, 0.8, 1.8),
        (curves.tendon_force_strain, -0.01, 0.06),
        (velocity_of_ratio, -0.5, 2.5),
    ],
)
def test_slope_is_the_derivative(m, curve, low, high):
    step = 1e-7
    for x in np.linspace(low, high, 1001):  # none of these points is a kink
        slope = (curve(x + step, m)[0] - curve(x - step, m)[0]) / (2 * step)
        assert curve(x, m)[1] == pytest.approx(slope, rel=1e-4, abs=1e-4) or abs(x - 1.0) < 1e-6


def test_tendon_and_velocity_curves_rise(m):
    strain = [curves.tendon_force_strain(e, m)[0] for e in np.linspace(0.0, 0.1, 500)]
    velocity = [velocity_of_ratio(f, m)[0] for f in np.linspace(-1.0, 3.0, 500)]
    assert (np.diff(strain) > 0).all()
    assert (np.diff(velocity) > 0).all()


def test_force_length_and_tendon_against_opensim(m, oracle):
    table = oracle("muscle_curves.npz")
    active = [curves.active_force_length(x, m)[0] for x in table["lN"]]
    passive = [curves.passive_force_length(x, m)[0] for x in table["lN"]]
    tendon = [curves.tendon_force_strain(x, m)[0] for x in table["tendon_strain"]]
    for name, ours, key in (
        ("active", active, "fl_active"),
        ("passive", passive, "fp_passive"),
        ("tendon", tendon, "ft_tendon"),
    ):
        error = np.abs(np.array(ours) - table[key]).max()
        print(f"{name} curve: largest error {error:.1e}")
        assert error < 1e-9
