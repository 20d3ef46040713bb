"""Laws of every muscle model and both kinds of tendon, and the powers of a muscle."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drakearm.model import load_arm
from drakearm.model.muscle_lanes import step_muscle_lanes
from drakearm.muscle import models
from drakearm.muscle.contraction import equilibrium_fiber_length, fiber_velocity, rigid_tendon_force, tendon_force
from drakearm.muscle.energy import fiber_and_tendon_power, fiber_forces, metabolic_power

from ..velocity_curve import velocity_of_ratio

ARM = load_arm("arm14")
MODELS = tuple(models.MODELS)


def table(model, tendon="compliant"):
    return replace(ARM, muscles=tuple(replace(m, model=model, tendon=tendon) for m in ARM.muscles)).muscle_table


@pytest.mark.parametrize("model", MODELS)
def test_key_points(model):
    """Forces are 1 at optimal length and at the given strains; a fiber that exerts the isometric force stays still."""
    m = table(model)[0]
    assert models.active_force_length(1.0, m)[0] == pytest.approx(1.0)
    assert models.passive_force_length(1.6, m)[0] == pytest.approx(1.0)
    assert models.tendon_force_strain(0.033, m)[0] == pytest.approx(1.0)
    assert models.tendon_force_strain(0.0, m)[0] == pytest.approx(0.0)
    assert velocity_of_ratio(1.0, m)[0] == pytest.approx(0.0, abs=1e-12)
    assert velocity_of_ratio(0.0, m)[0] == pytest.approx(-1.0)


def test_degroote_reaches_its_published_largest_force():
    assert models.force_of_velocity(1.0, table("degroote2016")[0])[0] == pytest.approx(1.794, abs=1e-3)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("velocity", [-0.99, -0.5, -0.01, 0.01, 0.3, 0.9, 2.0])
def test_force_and_velocity_curves_invert_each_other(model, velocity):
    m = table(model)[0]
    force, slope = models.force_of_velocity(velocity, m)
    back, back_slope = velocity_of_ratio(force, m)
    assert back == pytest.approx(velocity, abs=1e-9)
    assert slope * back_slope == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("active", [-0.2, 0.3, 0.9, 1.3])
@pytest.mark.parametrize("isometric", [0.2, 0.8])
def test_velocity_and_both_its_slopes(model, active, isometric):
    m = table(model)[0]
    _, denominator, by_active, by_isometric = models.velocity_of_force(active, isometric, m)

    def velocity(force, capacity):
        numerator, denominator, _, _ = models.velocity_of_force(force, capacity, m)
        return numerator / denominator

    step = 1e-6
    numeric = (velocity(active + step, isometric) - velocity(active - step, isometric)) / (2.0 * step)
    assert by_active / denominator == pytest.approx(numeric, rel=1e-6)
    numeric = (velocity(active, isometric + step) - velocity(active, isometric - step)) / (2.0 * step)
    assert -by_isometric / denominator == pytest.approx(numeric, rel=1e-6)


@pytest.mark.parametrize(
    "curve",
    [models.active_force_length, models.passive_force_length, models.tendon_force_strain, velocity_of_ratio],
    ids=lambda curve: curve.__name__,
)
def test_degroote_curves_have_no_kinks(curve):
    """Their slopes are derivatives and have no jumps: between neighboring points of a fine grid they change little."""
    m = table("degroote2016")[0]
    ranges = {"tendon_force_strain": (-0.01, 0.06), "velocity_of_ratio": (-0.4, 2.2)}
    low, high = ranges.get(curve.__name__, (0.3, 1.8))
    grid = np.linspace(low, high, 4001)
    value, slope = np.array([curve(x, m) for x in grid]).T
    numeric = np.gradient(value, grid)[1:-1]
    np.testing.assert_allclose(slope[1:-1], numeric, rtol=2e-3, atol=2e-3 * np.abs(slope).max())
    assert np.abs(np.diff(slope)).max() < 0.02 * np.ptp(slope)


@settings(deadline=None)
@given(
    st.sampled_from(MODELS),
    st.sampled_from(["compliant", "rigid"]),
    st.integers(0, 13),
    st.floats(0.01, 1.0),
    st.floats(0.5, 1.5),
)
def test_in_equilibrium_fiber_and_tendon_exert_the_same_force(model, tendon, i, a, stretch):
    m = table(model, tendon)[i]
    length = max(stretch * m["optimal_fiber_length"], 1.05 * m["minimum_fiber_length"])
    mtu_length = m["tendon_slack_length"] * 1.01 + np.sqrt(length**2 - m["fiber_width"] ** 2)
    fiber = equilibrium_fiber_length(a, mtu_length, m)
    if tendon == "compliant":
        velocity, _, slope, _ = fiber_velocity(a, fiber, mtu_length, m)
        assert abs(velocity) <= abs(slope) * 1e-9 + 1e-12
        pull = tendon_force(fiber, mtu_length, m)[0]
    else:
        pull = rigid_tendon_force(a, mtu_length, 0.0, m)[0]
    cosine = np.sqrt(1 - (m["fiber_width"] / fiber) ** 2)
    normalized = fiber / m["optimal_fiber_length"]
    isometric = a * models.active_force_length(normalized, m)[0] + models.passive_force_length(normalized, m)[0]
    assert pull == pytest.approx(isometric * m["max_isometric_force"] * cosine, rel=1e-5, abs=1e-4)


def test_powers_of_fiber_and_tendon_add_up_to_that_of_the_muscle():
    m = ARM.muscle_table[0]
    fiber, tendon = fiber_and_tendon_power(0.12, -0.3, -0.5, 400.0, m)
    assert fiber + tendon == pytest.approx(400.0 * 0.5)
    active, passive = fiber_forces(0.12, 400.0, m)
    assert (active + passive) * 0.3 == pytest.approx(fiber)


def test_metabolic_power_by_hand():
    """At optimal length and full activation, with half slow fibers: heat of activation and maintenance at rest."""
    m = ARM.muscle_table[0]
    optimal, force = m["optimal_fiber_length"], m["max_isometric_force"]
    mass = 1059.7 * force / 0.25e6 * optimal
    assert m["mass"] == pytest.approx(mass)
    rest = metabolic_power(1.0, 1.0, optimal, 0.0, force, 0.0, m)
    assert rest == pytest.approx(mass * (0.5 * 40 + 0.5 * 133 + 0.5 * 74 + 0.5 * 111))
    shortening = metabolic_power(1.0, 1.0, optimal, -0.1, 0.6 * force, 0.0, m)
    assert shortening == pytest.approx(rest + (0.16 + 0.18 * 0.6) * force * 0.1 + 0.6 * force * 0.1)
    assert metabolic_power(0.01, 0.0, optimal, 0.0, 0.0, 0.0, m) >= mass  # never below 1 W/kg


def test_a_model_that_a_dispatch_does_not_name_is_refused(monkeypatch):
    """Otherwise its muscles would silently get the curves of another model."""
    monkeypatch.setitem(models.MODELS, "millard2012", models.MODELS["thelen2003"])
    for function in (models.active_force_length, step_muscle_lanes):
        with pytest.raises(TypeError, match="must choose by muscle model, but lacks MILLARD2012"):
            models.names_every_model(function)
    unknown = ARM.muscle_table[:1].copy()
    unknown["model_code"] = len(MODELS)
    assert math.isnan(models.tendon_force_strain(0.01, unknown[0])[0])
