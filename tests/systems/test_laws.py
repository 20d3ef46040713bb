"""Laws of the whole muscle arm, for any excitations, postures, speeds and loads."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource
from scipy.integrate import quad

from drakearm.diagrams import AddMuscleArm, MakeSimulator
from drakearm.learning.compiled_arm import CompiledArms
from drakearm.model import MakeTorqueArm, load_arm
from drakearm.model.dynamics_table import read_dynamics, stack_dynamics
from drakearm.model.joint_stops import HARDENING, STOP_STIFFNESS
from drakearm.model.musculature import resting_states, tendon_forces
from drakearm.muscle.models import passive_force_length, tendon_force_strain

ARM = load_arm("arm14")
LOADS = (0.0, 1.0, 5.0, 20.0)
PLANTS = {load: MakeTorqueArm(ARM, load) for load in LOADS}
DYNAMICS = {load: read_dynamics(plant) for load, plant in PLANTS.items()}
LOWER, UPPER = PLANTS[0.0].GetPositionLowerLimits(), PLANTS[0.0].GetPositionUpperLimits()
# Above a shoulder angle of 2.2 rad BIClong is shorter than its tendon, so it has no equilibrium to start from.
shoulders, elbows = st.floats(LOWER[0], 2.2), st.floats(LOWER[1], UPPER[1])
speeds = st.floats(-30.0, 30.0)


def start(count, arm_state, load=0.0):
    """Arms whose joints have the state arm_state, q and v, and whose muscles are at rest."""
    arms = CompiledArms(ARM, stack_dynamics([DYNAMICS[load]] * count), count, LOWER, UPPER)
    states = np.tile(arm_state, (count, 1))
    arms.set_state(np.ones(count, dtype=bool), states, resting_states(ARM, states[:, :2], 0.05))
    return arms


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**31), st.sampled_from(LOADS), shoulders, elbows, speeds, speeds, st.floats(0.1, 10.0))
def test_forces_stay_bounded_and_finite(seed, load, shoulder, elbow, v0, v1, sharpness):
    """0.5 s of random excitations, from any posture and speed: no NaN, and no force above 20 F_max."""
    arms, rng = start(1, [shoulder, elbow, v0, v1], load), np.random.default_rng(seed)
    muscles, paths = ARM.muscle_table, ARM.path_table
    for _ in range(50):
        arms.step(rng.random((1, 14)) ** sharpness, 10, 1e-3)
        x, state = arms.arm_state, arms.muscle_state
        assert np.isfinite(x).all() and np.isfinite(state).all()
        force, _ = tendon_forces(state[0, :28], x[0], muscles, paths)
        assert (force >= 0.0).all()
        # A fiber yields at 1.8 F_max. The force can exceed this because a step can stretch the stiff tendon a lot.
        assert (force <= 20.0 * muscles["max_isometric_force"]).all()
        assert (x[0, :2] > LOWER - 0.6).all() and (x[0, :2] < UPPER + 0.6).all()


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 13), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_activation_is_monotone_in_excitation(i, u, w):
    """Of two arms that start in the same state, the one with the larger excitation always has the larger activation."""
    excitation = np.full((2, 14), min(u, w))
    excitation[1, i] = max(u, w)
    arms = start(2, [0.0, 1.0, 0.0, 0.0])
    for _ in range(10):
        arms.step(excitation, 10, 1e-3)
        low, high = arms.muscle_state[:, i]
        assert high >= low


def make(arm, excitation, time_step, load=0.0, stops=True):
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm, time_step=time_step, load_mass=load, stops=stops)
    source = builder.AddSystem(ConstantVectorSource(excitation))
    builder.Connect(source.get_output_port(), muscle_arm.muscles.GetInputPort("excitation"))
    diagram = builder.Build()
    simulator = MakeSimulator(diagram, time_step) if time_step else Simulator(diagram)
    return simulator, simulator.get_mutable_context(), muscle_arm


def skeleton_energy(muscle_arm, context):
    plant = muscle_arm.plant
    plant_context = plant.GetMyContextFromRoot(context)
    return plant.CalcKineticEnergy(plant_context) + plant.CalcPotentialEnergy(plant_context)


def test_power_balance_along_a_simulation():
    """Fiber plus tendon power is generalized force times speed. Its integral is the change of the skeleton's energy."""
    excitation = np.full(14, 0.05)
    excitation[[3, 5]] = 0.3
    simulator, context, muscle_arm = make(ARM, excitation, 0.0, stops=False)
    simulator.get_mutable_integrator().set_target_accuracy(1e-8)
    muscle_arm.SetState(context, np.array([0.1, 0.8]), np.array([0.5, -1.0]))
    muscles = muscle_arm.muscles
    muscle_context = muscles.GetMyContextFromRoot(context)
    plant_context = muscle_arm.plant.GetMyContextFromRoot(context)
    start, work, last = skeleton_energy(muscle_arm, context), 0.0, None
    for k in range(201):
        simulator.AdvanceTo(0.001 * k)
        delivered = sum(muscles.GetOutputPort(p).Eval(muscle_context).sum() for p in ("fiber_power", "tendon_power"))
        tau = muscles.GetOutputPort("generalized_force").Eval(muscle_context)
        power = tau @ muscle_arm.plant.GetVelocities(plant_context)
        assert delivered == pytest.approx(power, abs=1e-9)
        moments = muscles.GetOutputPort("joint_moment").Eval(muscle_context).reshape(14, 2)
        np.testing.assert_allclose(moments.sum(axis=0), tau, atol=1e-9)
        work += 0.0 if last is None else 0.0005 * (last + power)
        last = power
    assert work == pytest.approx(skeleton_energy(muscle_arm, context) - start, abs=1e-3 * abs(work))


def elastic_energy(arm, fiber_length, mtu_length):
    """Energy (J) stored in tendons and passive fibers: the integrals of their force curves."""
    total = 0.0
    for m, fiber, mtu in zip(arm.muscle_table, fiber_length, mtu_length, strict=True):
        along = np.sqrt(fiber**2 - m["fiber_width"] ** 2)
        strain = (mtu - along) / m["tendon_slack_length"] - 1.0
        scale = m["max_isometric_force"] * m["tendon_slack_length"]
        total += scale * quad(lambda e, m=m: tendon_force_strain(e, m)[0], 0.0, max(strain, 0.0))[0]
        length = max(fiber / m["optimal_fiber_length"], 1.0)
        scale = m["max_isometric_force"] * m["optimal_fiber_length"]
        total += scale * quad(lambda x, m=m: passive_force_length(x, m)[0], 1.0, length)[0]
    return total


def test_energy_never_grows_with_passive_muscles():
    """With almost no activation, the energy of skeleton, tendons, fibers and stops together only falls."""
    arm = replace(ARM, muscles=tuple(replace(m, minimum_activation=1e-3) for m in ARM.muscles))
    simulator, context, muscle_arm = make(arm, np.zeros(14), 2.5e-4)
    muscle_arm.SetState(context, np.array([-0.6, 1.8]), activation=1e-3)
    muscles = muscle_arm.muscles
    muscle_context = muscles.GetMyContextFromRoot(context)
    energy = []
    for k in range(30):
        simulator.AdvanceTo(0.02 * k)
        fiber, mtu = (muscles.GetOutputPort(name).Eval(muscle_context) for name in ("fiber_length", "mtu_length"))
        q = muscle_arm.plant.GetPositions(muscle_arm.plant.GetMyContextFromRoot(context))
        depth = np.maximum(q - UPPER, 0.0) + np.maximum(LOWER - q, 0.0)
        stops = 0.5 * STOP_STIFFNESS * (depth**2 + 0.5 * depth**4 / HARDENING**2).sum()
        energy.append(skeleton_energy(muscle_arm, context) + elastic_energy(arm, fiber, mtu) + stops)
    # What the minimum activation can still deliver. The largest power of a muscle is a tenth of its largest force times
    # its largest velocity.
    power = 0.1 * 1e-3 * (arm.muscle_table["max_isometric_force"] * arm.muscle_table["optimal_fiber_length"] * 10).sum()
    assert (np.diff(energy) <= 0.02 * power + 1e-4).all()
    assert energy[-1] < energy[0] - 0.1


@pytest.mark.parametrize("speed", [0.0, -10.0, -30.0])
def test_stops_hold_20_kg_dropped_at_full_speed(speed):
    """The bent, loaded arm falls onto the elbow stop, which yields, pushes the elbow back and removes energy."""
    simulator, context, muscle_arm = make(ARM, np.zeros(14), 1e-3, load=20.0)
    muscle_arm.SetState(context, np.array([0.0, 1.5]), np.array([0.0, speed]))
    plant_context = muscle_arm.plant.GetMyContextFromRoot(context)
    start, angles = skeleton_energy(muscle_arm, context), []
    for k in range(400):
        simulator.AdvanceTo(0.005 * k)
        angles.append(muscle_arm.plant.GetPositions(plant_context)[1])
    print(f"{speed} rad/s: elbow yields to {np.rad2deg(min(angles)):.1f} deg")
    assert min(angles) > np.deg2rad(-30.0)
    assert min(angles[-100:]) > np.deg2rad(-5.0)
    assert skeleton_energy(muscle_arm, context) < start
