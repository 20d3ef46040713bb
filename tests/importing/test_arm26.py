"""The shipped limb arm26 against OpenSim 4.6 on the file's own wrapped paths. `pytest -s` prints what it measures."""

from pathlib import Path

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from drakearm.diagrams import AddMuscleArm, MakeSimulator
from drakearm.model import load_arm
from drakearm.model.musculature import equilibrium_fiber_lengths, tendon_forces
from tests.importing.limbs import geometry

OPENSIM = np.load(Path(__file__).parents[1] / "data" / "arm26.npz")
ARM = load_arm("arm26")
STEP = 0.01  # s
BELOW, ACROSS = range(5), range(5, 10)  # movements that stay below a fault of OpenSim's wrapping, or cross it


def simulate(k, time_step):
    """Joint angles (76, 2) and tendon forces (76, 6) of movement k. Continuous muscles (0) have an accuracy of 1e-7."""
    builder = DiagramBuilder()
    parts = AddMuscleArm(builder, ARM, stops=False, time_step=time_step)
    t = STEP * np.arange(76)
    lines = PiecewisePolynomial.FirstOrderHold(t, OPENSIM["excitation"][k].T)
    source = builder.AddSystem(TrajectorySource(lines))
    builder.Connect(source.get_output_port(), parts.muscles.GetInputPort("excitation"))
    diagram = builder.Build()
    simulator = MakeSimulator(diagram, time_step) if time_step else Simulator(diagram)
    context = simulator.get_mutable_context()
    muscles = parts.muscles.GetMyMutableContextFromRoot(context)
    plant = parts.plant.GetMyMutableContextFromRoot(context)
    parts.plant.SetPositions(plant, OPENSIM["movement_q"][k, 0])
    fibers = OPENSIM["fiber_length"][k]
    state = np.concatenate([np.full(len(fibers), 0.05), fibers])
    if time_step:
        muscles.SetDiscreteState(0, np.concatenate([state, fibers, np.zeros(len(fibers))]))
    else:
        muscles.SetContinuousState(state)
        simulator.get_mutable_integrator().set_target_accuracy(1e-7)
    q, force = np.empty((len(t), 2)), np.empty((len(t), len(fibers)))
    for i in range(len(t)):
        simulator.AdvanceTo(t[i])
        q[i] = parts.plant.GetPositions(plant)
        force[i] = parts.muscles.GetOutputPort("tendon_force").Eval(muscles)
    return q, force


def error(k, time_step):
    """The largest errors of movement k: of a joint angle (rad), and of a tendon force over max_isometric_force."""
    q, force = simulate(k, time_step)
    by_force = np.abs(force - OPENSIM["movement_force"][k]) / ARM.muscle_table["max_isometric_force"]
    return np.abs(q - OPENSIM["movement_q"][k]).max(), by_force.max()


def test_moment_arms():
    """Over the whole joint range; MyoConverter's figure for arm26 is 0.46 mm in the mean."""
    assert ARM.muscle_names == tuple(OPENSIM["muscles"])
    difference = np.abs(geometry(ARM, OPENSIM["q"])[1] - OPENSIM["moment_arm"])
    crossed = np.abs(OPENSIM["moment_arm"]).max(axis=0) > 1e-6
    off = 1e3 * difference[:, crossed]
    print(
        f"moment arms: median {np.median(off):.4f} mm, mean {off.mean():.3f} mm, 99 % {np.quantile(off, 0.99):.2f} mm"
    )
    assert np.median(off) < 0.005 and off.mean() < 0.46


def test_tendon_forces_in_equilibrium():
    """Over the whole joint range; MyoConverter's figure for arm26 is 0.058 F_max."""
    q, activation = OPENSIM["q"], OPENSIM["activation"]
    fibers = np.array([equilibrium_fiber_lengths(ARM, x[None], a)[0] for x, a in zip(q, activation, strict=True)])
    forces = np.array(
        [
            tendon_forces(np.concatenate([a, f]), np.concatenate([x, np.zeros(2)]), ARM.muscle_table, ARM.path_table)[0]
            for a, f, x in zip(activation, fibers, q, strict=True)
        ]
    )
    off = np.abs(forces - OPENSIM["tendon_force"]) / ARM.muscle_table["max_isometric_force"]
    print(
        f"tendon forces: median {np.nanmedian(off):.5f} F_max, mean {np.nanmean(off):.4f}, worst {np.nanmax(off):.3f}"
    )
    assert np.isfinite(off).mean() > 0.95
    assert np.nanmedian(off) < 1e-5 and np.nanmean(off) < 0.02


@pytest.mark.parametrize("k", BELOW)
def test_movements(k):
    """0.75 s are within 0.005 rad, with continuous muscles and in steps of 1 ms."""
    errors = [error(k, time_step) for time_step in (0.0, 0.001)]
    print(f"{OPENSIM['movements'][k]}: " + ", ".join(f"{q:.5f} rad, {force:.4f} F_max" for q, force in errors))
    assert max(q for q, _ in errors) < 0.005


@pytest.mark.parametrize("k", ACROSS)
def test_movements_across_a_fault_of_the_wrapping(k):
    """OpenSim's arm gets a blow where TRIlong's length is wrong by 8.5 mm."""
    q, _ = error(k, 0.0)
    print(f"{OPENSIM['movements'][k]}: {q:.5f} rad")
    assert q < 0.05
