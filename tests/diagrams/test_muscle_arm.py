"""An arm as a part of a Diagram: alone, in a plant of the user's own, with loads, tools, contact and other torques."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.geometry import Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

from drakearm.diagrams import AddMuscleArm, AddMuscles, MakeSimulator
from drakearm.errors import ArmError, StateError
from drakearm.model import find_equilibrium

Q = np.deg2rad([-10.0, 70.0])


def with_inputs(builder, *arms):
    for arm in arms:
        builder.ExportInput(arm.muscles.GetInputPort("excitation"), f"{arm.name}excitation")
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    for arm in arms:
        diagram.GetInputPort(f"{arm.name}excitation").FixValue(context, np.zeros(len(arm.arm.muscles)))
    return diagram, context


def own_plant(arm, time_step, tool=0.0):
    """A plant with a ball in front of the arm and, in the hand, a tool (kg)."""
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step)
    things = plant.AddModelInstance("things")
    ball = plant.AddRigidBody("ball", things, SpatialInertia.SolidSphereWithMass(0.3, 0.04))
    (model,) = Parser(plant).AddModels(str(arm.skeleton))
    plant.mutable_gravity_field().set_gravity_vector(np.array(arm.gravity))
    friction, hand = CoulombFriction(0.5, 0.5), plant.GetFrameByName(arm.tip_frame)
    plant.RegisterCollisionGeometry(ball, RigidTransform(), Sphere(0.04), "ball", friction)
    plant.RegisterCollisionGeometry(hand.body(), hand.GetFixedPoseInBodyFrame(), Sphere(0.03), "hand", friction)
    if tool:
        body = plant.AddRigidBody("tool", things, SpatialInertia.SolidSphereWithMass(tool, 0.02))
        plant.WeldFrames(plant.GetFrameByName(arm.load_frame), body.body_frame())
    plant.Finalize()
    return builder, plant, model


def test_an_equilibrium_is_one_with_any_load_and_strength(arm):
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm, load_mass=0.5, variable_load=True, time_step=0.0)
    diagram, context = with_inputs(builder, muscle_arm)
    for load_mass, strength in ((0.5, 1.0), (1.5, 0.9), (0.0, np.linspace(0.6, 1.4, 14))):
        muscle_arm.SetBody(context, load_mass, strength)
        held = muscle_arm.SetEquilibrium(context, Q)
        np.testing.assert_allclose(held.torque, find_equilibrium(arm, Q, load_mass).torque, rtol=1e-9)
        diagram.GetInputPort("excitation").FixValue(context, held.excitation)
        rates = muscle_arm.plant.GetMyContextFromRoot(context)
        v_dot = muscle_arm.plant.get_generalized_acceleration_output_port().Eval(rates)
        np.testing.assert_allclose(v_dot, 0.0, atol=1e-6)


@pytest.mark.parametrize(
    ("load_mass", "message"),
    [(1.0, "The load of arm14 cannot change: expected an arm that was made with variable_load=True"),
     (-1.0, "The load is -1.0 kg: expected a mass that is not negative"),
     (np.nan, "The load is nan kg")],
)  # fmt: skip
def test_a_load_that_cannot_be_is_refused(arm, load_mass, message):
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm)
    _, context = with_inputs(builder, muscle_arm)
    with pytest.raises(StateError, match=message):
        muscle_arm.SetBody(context, load_mass, 1.0)


def test_only_an_arm_can_be_added():
    with pytest.raises(ArmError, match="Found 'arm14', expected an Arm, as load_arm gives it"):
        AddMuscleArm(DiagramBuilder(), "arm14")


def test_muscles_move_an_own_plant_as_they_move_the_arm_alone(arm):
    """Also if other bodies come first in the plant, and if it is discrete."""
    excitation = np.linspace(0.0, 0.3, 14)
    postures = []
    for kind in ("alone", "continuous", "discrete"):
        if kind == "alone":
            builder = DiagramBuilder()
            muscle_arm = AddMuscleArm(builder, arm)
        else:
            builder, plant, _ = own_plant(arm, 0.0 if kind == "continuous" else 1e-3)
            muscle_arm = AddMuscles(builder, arm, plant)
        diagram, context = with_inputs(builder, muscle_arm)
        simulator = MakeSimulator(diagram) if kind != "discrete" else Simulator(diagram)
        simulator.reset_context(context)
        diagram.GetInputPort("excitation").FixValue(context, excitation)
        if kind != "alone":
            ball = plant.GetBodyByName("ball")
            plant.SetFreeBodyPose(plant.GetMyMutableContextFromRoot(context), ball, RigidTransform([5.0, 0.0, 0.0]))
        muscle_arm.SetState(context, Q)
        simulator.AdvanceTo(0.3)
        plant = muscle_arm.plant
        angles = [plant.GetJointByName(name).get_angle(plant.GetMyContextFromRoot(context)) for name in arm.coordinates]
        postures.append(angles)
    np.testing.assert_allclose(postures[1], postures[0], atol=1e-6)
    np.testing.assert_allclose(postures[2], postures[0], atol=5e-3)
    assert np.abs(np.array(postures[0]) - Q).max() > 0.1


def test_muscles_hold_a_tool_in_an_own_plant(arm):
    builder, plant, model = own_plant(arm, 1e-3, tool=0.8)
    muscle_arm = AddMuscles(builder, arm, plant, model_instance=model)
    diagram, context = with_inputs(builder, muscle_arm)
    ball = plant.GetBodyByName("ball")
    plant.SetFreeBodyPose(plant.GetMyMutableContextFromRoot(context), ball, RigidTransform([5.0, 0.0, 0.0]))
    held = muscle_arm.SetEquilibrium(context, Q)
    diagram.GetInputPort("excitation").FixValue(context, held.excitation)
    np.testing.assert_allclose(held.torque, find_equilibrium(arm, Q, 0.8).torque, rtol=1e-3)  # the load is smaller
    simulator = Simulator(diagram)
    simulator.reset_context(context)
    simulator.AdvanceTo(0.3)
    angles = [plant.GetJointByName(name).get_angle(plant.GetMyContextFromRoot(context)) for name in arm.coordinates]
    np.testing.assert_allclose(angles, Q, atol=2e-3)


def test_a_ball_that_falls_on_the_hand_pushes_it_down(arm):
    lowest = {}
    for away in (0.0, 5.0):
        builder, plant, _ = own_plant(arm, 1e-3)
        muscle_arm = AddMuscles(builder, arm, plant)
        diagram, context = with_inputs(builder, muscle_arm)
        held = muscle_arm.SetEquilibrium(context, Q)
        diagram.GetInputPort("excitation").FixValue(context, held.excitation)
        plant_context = plant.GetMyMutableContextFromRoot(context)
        hand = plant.GetFrameByName(arm.tip_frame).CalcPoseInWorld(plant_context).translation()
        up = -np.array(arm.gravity) / np.linalg.norm(arm.gravity)
        place = hand + 0.2 * up + [away, 0.0, 0.0]
        plant.SetFreeBodyPose(plant_context, plant.GetBodyByName("ball"), RigidTransform(place))
        simulator = Simulator(diagram)
        simulator.reset_context(context)
        simulator.AdvanceTo(0.3)
        after = plant.GetFrameByName(arm.tip_frame).CalcPoseInWorld(plant_context).translation()
        lowest[away] = float((after - hand) @ up)
    assert lowest[5.0] == pytest.approx(0.0, abs=1e-3)
    assert lowest[0.0] < -0.01


def test_a_plant_without_the_arm_is_refused(arm):
    builder = DiagramBuilder()
    plant = builder.AddSystem(MultibodyPlant(0.0))
    plant.Finalize()
    with pytest.raises(ArmError, match="The plant has no joint shoulder of arm14: expected the skeleton of the arm"):
        AddMuscles(builder, arm, plant)


@pytest.mark.parametrize("own", [False, True])
def test_other_torques_are_added_to_those_of_the_muscles(arm, own):
    """Two motors. What they add to the accelerations is what the mass matrix says."""
    v_dot = []
    for torques in ([], [[2.0, 0.5], [-1.0, 0.5]]):
        builder = DiagramBuilder()
        if own:
            builder, plant, _ = own_plant(arm, 0.0)
            muscle_arm = AddMuscles(builder, arm, plant, stops=False)
        else:
            muscle_arm = AddMuscleArm(builder, arm)
        for k, torque in enumerate(torques):
            motor = builder.AddNamedSystem(f"motor_{k}", ConstantVectorSource(torque))
            muscle_arm.AddTorque(builder, motor.get_output_port())
        _, context = with_inputs(builder, muscle_arm)
        muscle_arm.SetState(context, Q)
        plant = muscle_arm.plant
        plant_context = plant.GetMyContextFromRoot(context)
        index = [plant.GetJointByName(name).velocity_start() for name in arm.coordinates]
        v_dot.append(plant.get_generalized_acceleration_output_port().Eval(plant_context)[index])
    mass = plant.CalcMassMatrix(plant_context)[np.ix_(index, index)]
    np.testing.assert_allclose(mass @ (v_dot[1] - v_dot[0]), [1.0, 1.0], rtol=1e-6)


def test_an_integrator_may_try_a_step_that_is_far_too_long(arm):
    """Drake's default integrator does, with these muscles, and rejects it. An implicit one comes to the same place."""
    arm = replace(arm, muscles=tuple(replace(muscle, model="degroote2016") for muscle in arm.muscles))
    angles = []
    for scheme in ("runge_kutta3", "radau3"):
        builder = DiagramBuilder()
        muscle_arm = AddMuscleArm(builder, arm, time_step=0.0)
        diagram, context = with_inputs(builder, muscle_arm)
        diagram.GetInputPort("excitation").FixValue(context, np.full(14, 0.1))
        muscle_arm.SetState(context, np.deg2rad([0.0, 45.0]))
        simulator = Simulator(diagram, context)
        ResetIntegratorFromFlags(simulator, scheme, 1e-2)
        simulator.AdvanceTo(0.1)
        angles.append(muscle_arm.plant.GetPositions(muscle_arm.plant.GetMyContextFromRoot(context)))
    np.testing.assert_allclose(angles[0], angles[1], atol=1e-2)
    assert np.abs(angles[0] - np.deg2rad([0.0, 45.0])).max() > 0.1
