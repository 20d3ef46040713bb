"""Metabolic power against OpenSim's probe of Bhargava et al. (2004), stored by tests/data/make_metabolic.py."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drakearm.model import load_arm
from drakearm.muscle.contraction import fiber_velocity, tendon_force
from drakearm.muscle.energy import fiber_forces, metabolic_power, metabolic_rates

MUSCLES = load_arm("arm14").muscle_table
STORED = Path(__file__).parents[1] / "data" / "metabolic.npz"
PARTS = ("activation_rate", "maintenance_rate", "shortening_rate", "work_rate")
TOLERANCE = 1e-9  # W


@pytest.fixture(scope="module")
def probe():
    """The stored states of muscles and OpenSim's answers: arrays (samples, 14) by name."""
    with np.load(STORED) as file:
        return dict(file)


def in_every_state(function, probe):
    """function(state, m) for every stored state: (samples, 14, ...). state is a dictionary of numbers by name."""
    samples, n = probe["excitation"].shape
    assert n == len(MUSCLES)
    numbers = {name: values for name, values in probe.items() if name != "muscles"}
    return np.array(
        [
            [function({name: values[k, i] for name, values in numbers.items()}, m) for i, m in enumerate(MUSCLES)]
            for k in range(samples)
        ]
    )


def arguments(state):
    """Arguments of `metabolic_power` and `metabolic_rates` except the muscle, with OpenSim's forces and velocity."""
    names = ("activation", "excitation", "fiber_length", "fiber_velocity", "active_force", "passive_force")
    return [state[name] for name in names]


def test_the_stored_states_reach_every_case(probe):
    """Shortening, lengthening and rest; all pieces of the maintenance heat; both limits; excitations of 0 and 1."""
    assert tuple(probe["muscles"]) == load_arm("arm14").muscle_names
    velocity, total = probe["fiber_velocity"], probe["total_rate"]
    heat = sum(probe[part] for part in PARTS[:3])
    length = probe["fiber_length"] / MUSCLES["optimal_fiber_length"]
    for case in (
        velocity > 0.0,
        velocity < 0.0,
        velocity == 0.0,
        length < 0.5,
        (length > 0.5) & (length < 1.0),
        (length > 1.0) & (length < 1.5),
        length > 1.5,
        probe["fiber_length"] < MUSCLES["minimum_fiber_length"],
        heat < MUSCLES["mass"],  # OpenSim's least heat applies
        heat + probe["work_rate"] < 0.0,  # the total is limited to 0
        probe["excitation"] == 0.0,
        probe["excitation"] == 1.0,
        probe["activation"] < MUSCLES["minimum_activation"],
        probe["activation"] > 1.0,
    ):
        assert case.sum() >= 10
    assert (total > -TOLERANCE).all()


def test_every_part_is_that_of_the_probe(probe):
    rates = in_every_state(lambda state, m: metabolic_rates(*arguments(state), m), probe)
    for j, part in enumerate(PARTS):
        error = np.abs(rates[..., j] - probe[part]).max()
        print(f"{part}: largest error {error:.1e} W, largest value {np.abs(probe[part]).max():.0f} W")
        assert error < TOLERANCE


def test_the_total_is_that_of_the_probe(probe):
    total = in_every_state(lambda state, m: metabolic_power(*arguments(state), m), probe)
    error = np.abs(total - probe["total_rate"])
    print(f"total: largest error {error.max():.1e} W, largest value {probe['total_rate'].max():.0f} W")
    assert error.max() < TOLERANCE


def test_the_total_is_that_of_the_probe_with_forces_and_velocities_of_drakearm(probe):
    """This is how HillMuscles computes its output."""

    def power(state, m):
        fiber, mtu_length = state["fiber_length"], state["mtu_length"]
        velocity = fiber_velocity(state["activation"], fiber, mtu_length, m)[0]
        active, passive = fiber_forces(fiber, tendon_force(fiber, mtu_length, m)[0], m)
        return metabolic_power(state["activation"], state["excitation"], fiber, velocity, active, passive, m)

    error = np.abs(in_every_state(power, probe) - probe["total_rate"])
    print(f"total from the state: largest error {error.max():.1e} W")
    assert error.max() < TOLERANCE


@settings(deadline=None)
@given(
    st.integers(0, 13), st.floats(0.01, 1.0), st.floats(0.3, 1.7), st.floats(-10.0, 10.0), st.floats(-0.5, 2.0)
)  # muscle, activation, fiber length and velocity over optimal fiber length, active force over max_isometric_force
def test_laws_of_any_state(i, activation, length, speed, force):
    """The power is never negative, never falls when the excitation rises, and does not change outside [0, 1]."""
    m = MUSCLES[i]
    optimal, active = m["optimal_fiber_length"], force * m["max_isometric_force"]

    def power(excitation):
        return metabolic_power(activation, excitation, length * optimal, speed * optimal, active, 0.0, m)

    rising = [power(u) for u in np.linspace(0.0, 1.0, 6)]
    assert (np.diff(rising) >= -TOLERANCE).all()
    assert rising[0] >= -TOLERANCE
    assert power(-0.5) == rising[0]
    assert power(1.5) == rising[-1]
