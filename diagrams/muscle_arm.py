"""The arm with its muscles, as a part of a Diagram."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, Joint, ModelInstanceIndex, RigidBody
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, OutputPort
from pydrake.systems.primitives import Adder, MatrixGain

from drakearm.diagrams.connections import reroute
from drakearm.errors import ArmError, StateError, shown
from drakearm.model import Arm
from drakearm.model.equilibrium import Equilibrium, find_equilibrium
from drakearm.model.joint_stops import stop_strength
from drakearm.model.musculature import RESTING_ACTIVATION, require_state
from drakearm.model.obstacle import Obstacle, add_obstacle
from drakearm.model.skeleton import add_skeleton, inverse_dynamics, load_inertia, neutral_posture
from drakearm.model.skeleton_file import LOAD
from drakearm.systems.hill_muscles import HillMuscles_
from drakearm.systems.joint_stops import JointStops_

if TYPE_CHECKING:
    from drakearm.systems import HillMuscles, JointStops

TIME_STEP = 1e-3  # s


@dataclass(frozen=True)
class MuscleArm:
    """The systems of an arm in a Diagram. Connect the excitations (n,) to `muscles.GetInputPort("excitation")`."""

    arm: Arm
    plant: MultibodyPlant  # which may hold other things, too
    muscles: "HillMuscles"
    stops: "JointStops | None"
    load_mass: float = 0.0  # kg, in the hand, as drawn
    model_instance: ModelInstanceIndex | None = None  # of the arm in the plant, where names are not unique
    name: str = ""  # with which the names of its systems begin

    def SetState(
        self,
        root_context: Context,
        q: np.ndarray,
        v: np.ndarray | None = None,
        activation: float | np.ndarray = RESTING_ACTIVATION,
    ) -> None:
        """Sets the joints to q (n_q,), rad, and v (n_q,), rad/s, default 0, with the muscles in equilibrium at rest.

        activation: one number for all muscles, or (n,). Before a simulation is initialized you may set the positions of
        the plant only, see `HillMuscles`. Later that would stretch the tendons suddenly, so use this method. Raises
        StateError for arrays of another size, numbers that are not finite and activations outside of 0..1, and
        EquilibriumError if a muscle has no equilibrium.
        """
        self._set_joints(root_context, q, v)
        self.muscles.SetEquilibrium(self.muscles.GetMyMutableContextFromRoot(root_context), q, activation)

    def _set_joints(self, root_context: Context, q: np.ndarray, v: np.ndarray | None = None) -> None:
        n_q = len(self.arm.coordinates)
        q = np.asarray(q, dtype=float)
        v = np.zeros(n_q) if v is None else np.asarray(v, dtype=float)
        require_state("joint angles", q, (n_q,))
        require_state("joint speeds", v, (n_q,))
        context = self.plant.GetMyMutableContextFromRoot(root_context)
        state = self.plant.GetPositionsAndVelocities(context)
        state[self._state_index] = np.concatenate([q, v])
        self.plant.SetPositionsAndVelocities(context, state)

    def SetBody(self, root_context: Context, load_mass: float, strength: float | np.ndarray) -> None:
        """Sets the load (kg) and the factors of the maximum isometric forces, one number or (n,).

        Raises StateError for other numbers than positive ones, and for an arm without a load: it needs
        `variable_load`.
        """
        if not (np.isfinite(load_mass) and load_mass >= 0.0):
            raise StateError(f"The load is {load_mass} kg: expected a mass that is not negative.")
        if self._load is None:
            raise StateError(
                f"The load of {self.arm.name} cannot change: expected an arm that was made with variable_load=True."
            )
        context = self.plant.GetMyMutableContextFromRoot(root_context)
        self._load.SetSpatialInertiaInBodyFrame(context, load_inertia(load_mass))
        self.muscles.SetStrength(self.muscles.GetMyMutableContextFromRoot(root_context), strength)

    def SetEquilibrium(self, root_context: Context, q: np.ndarray, *, least: float | np.ndarray = 0.0) -> Equilibrium:
        """Sets the arm to rest at q (n_q,), rad, with muscles that hold it there, and returns this equilibrium.

        Nothing moves while the muscles get the excitations of the equilibrium, so Drake's `Linearize` works there. The
        muscles hold all that the plant has on the arm in this context, with their strength in it. least: of all
        activations, see `find_equilibrium`, whose errors it raises.
        """
        self._set_joints(root_context, q)
        context = self.plant.GetMyContextFromRoot(root_context)
        torque = inverse_dynamics(self.plant, context, np.zeros(self.plant.num_velocities()))[self._v_index]
        strength = self.muscles.GetStrength(self.muscles.GetMyContextFromRoot(root_context))
        equilibrium = find_equilibrium(self.arm, q, torque=torque, strength=strength, least=least)
        muscle_context = self.muscles.GetMyMutableContextFromRoot(root_context)
        self.muscles.SetEquilibrium(muscle_context, q, equilibrium.activation)
        return equilibrium

    def AddTorque(self, builder: DiagramBuilder, torque: OutputPort) -> None:
        """Adds torques (n_q,), Nm, on the joints to those of the muscles: of a motor, an exoskeleton or a spring.

        Call it before the Diagram is built; a second call adds more.
        """
        joints, name = self.plant.get_applied_generalized_force_input_port(), f"{torque.get_system().get_name()}_torque"

        def with_torque(before: OutputPort) -> OutputPort:
            total = builder.AddNamedSystem(f"{name}_added", Adder(2, joints.size()))
            builder.Connect(before, total.get_input_port(0))
            builder.Connect(_on_joints(builder, self, torque, name), total.get_input_port(1))
            return total.get_output_port()

        reroute(builder, joints, with_torque)

    @cached_property
    def _joints(self) -> list[Joint]:
        """The joints of the arm's coordinates, in their order. Raises ArmError if the plant does not have them."""
        where = [] if self.model_instance is None else [self.model_instance]
        for name in self.arm.coordinates:
            if not self.plant.HasJointNamed(name, *where):
                raise ArmError(
                    f"The plant has no joint {name} of {self.arm.name}: expected the skeleton of the arm in it, as "
                    "after Parser(plant).AddModels(str(arm.skeleton))."
                )
        return [self.plant.GetJointByName(name, *where) for name in self.arm.coordinates]

    @cached_property
    def _v_index(self) -> list[int]:
        return [joint.velocity_start() for joint in self._joints]

    @cached_property
    def _state_index(self) -> list[int]:
        """Where the arm's q and v are in the state of the plant."""
        positions = [joint.position_start() for joint in self._joints]
        return positions + [self.plant.num_positions() + index for index in self._v_index]

    @cached_property
    def _load(self) -> RigidBody | None:
        where = self._joints[0].model_instance()
        return self.plant.GetBodyByName(LOAD, where) if self.plant.HasBodyNamed(LOAD, where) else None


def AddMuscleArm(
    builder: DiagramBuilder,
    arm: Arm,
    *,
    load_mass: float = 0.0,
    variable_load: bool = False,
    stops: bool = True,
    time_step: float = TIME_STEP,
    scene_graph: SceneGraph | None = None,
    obstacle: Obstacle | None = None,
    name: str = "",
) -> MuscleArm:
    """Adds plant, muscles and joint stops to a builder and connects them to each other.

    load_mass: kg, welded to the hand. variable_load: whether `MuscleArm.SetBody` can change it. stops, time_step, name:
    see `AddMuscles`. scene_graph: where the shapes of the skeleton and of the obstacle are registered for drawing.
    obstacle: only drawn, the arm passes through it. The plant is always continuous: simulate with `MakeSimulator`, or
    with an integrator of your choice. Its default joint angles are 0, or as near to 0 as their ranges allow. For an arm
    that touches things, and for tools, see `AddMuscles`.
    """
    if not isinstance(arm, Arm):
        raise ArmError(f"Found {shown(arm)}, expected an Arm, as load_arm gives it.")
    plant = builder.AddNamedSystem(_named(name, "plant"), MultibodyPlant(time_step=0.0))
    if scene_graph is not None:
        plant.RegisterAsSourceForSceneGraph(scene_graph)
    add_skeleton(plant, arm, load_mass, variable_load=variable_load)
    if scene_graph is not None and obstacle is not None:
        add_obstacle(plant, obstacle)
    plant.Finalize()
    plant.SetDefaultPositions(neutral_posture(plant))
    if scene_graph is not None:
        builder.Connect(
            plant.get_geometry_pose_output_port(),
            scene_graph.get_source_pose_port(plant.get_source_id()),
        )
        if plant.num_collision_geometries() > 0:
            _let_bodies_pass(builder, plant, scene_graph)
    muscle_arm = AddMuscles(builder, arm, plant, stops=stops, time_step=time_step, name=name)
    return replace(muscle_arm, load_mass=load_mass)


def AddMuscles(
    builder: DiagramBuilder,
    arm: Arm,
    plant: MultibodyPlant,
    *,
    model_instance: ModelInstanceIndex | None = None,
    stops: bool = True,
    time_step: float = TIME_STEP,
    name: str = "",
) -> MuscleArm:
    """Adds muscles and joint stops to a plant of your own that has the arm's skeleton among other things.

    plant: finalized and in the builder, with the bodies of `Parser(plant).AddModels(str(arm.skeleton))`, and with the
    arm's gravity. Objects and tools can be in it, too. It may be discrete; for contact it should. model_instance: of
    the skeleton, where its names of joints are not the only ones. stops: whether JointStops keep the joints in the
    ranges of the skeleton file, as strong as `drakearm.model.joint_stops.stop_strength` says; a discrete plant keeps
    them there itself. time_step: s, of the muscles and stops; 0 makes them continuous. name: with which the names of
    the new systems begin, for a Diagram with several arms. Raises ArmError if the plant does not have the arm's joints.
    """
    muscles = builder.AddNamedSystem(_named(name, "muscles"), HillMuscles_[float](arm, time_step))
    added = MuscleArm(arm, plant, muscles, None, model_instance=model_instance, name=name)
    arm_state = _arm_state(builder, added)
    builder.Connect(arm_state, muscles.GetInputPort("arm_state"))
    torque = muscles.GetOutputPort("generalized_force")
    if stops:
        ranges = [plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()]
        q_index = added._state_index[: len(arm.coordinates)]
        joint_stops = builder.AddNamedSystem(
            _named(name, "stops"),
            JointStops_[float](*(limits[q_index] for limits in ranges), time_step, *stop_strength(arm)),
        )
        added = replace(added, stops=joint_stops)
        builder.Connect(arm_state, joint_stops.GetInputPort("arm_state"))
        total = builder.AddNamedSystem(_named(name, "joint_torque"), Adder(2, len(arm.coordinates)))
        builder.Connect(torque, total.get_input_port(0))
        builder.Connect(joint_stops.GetOutputPort("generalized_force"), total.get_input_port(1))
        torque = total.get_output_port()
    torque = _on_joints(builder, added, torque, _named(name, "muscle_torque"))
    builder.Connect(torque, plant.get_applied_generalized_force_input_port())
    return added


def _named(prefix: str, name: str) -> str:
    return f"{prefix}_{name}" if prefix else name


def _arm_state(builder: DiagramBuilder, arm: MuscleArm) -> OutputPort:
    """q and v of the arm's joints, from the state of the plant."""
    port, index = arm.plant.get_state_output_port(), arm._state_index
    if index == list(range(port.size())):
        return port
    selection = MatrixGain(np.eye(port.size())[index])
    selected = builder.AddNamedSystem(_named(arm.name, "arm_state"), selection)
    builder.Connect(port, selected.get_input_port())
    return selected.get_output_port()


def _on_joints(builder: DiagramBuilder, arm: MuscleArm, torque: OutputPort, name: str) -> OutputPort:
    """The generalized forces of the plant for torques (n_q,), Nm, on the arm's joints."""
    count, index = arm.plant.num_velocities(), arm._v_index
    if index == list(range(count)):
        return torque
    spread = builder.AddNamedSystem(name, MatrixGain(np.eye(count)[:, index]))
    builder.Connect(torque, spread.get_input_port())
    return spread.get_output_port()


def _let_bodies_pass(builder: DiagramBuilder, plant: MultibodyPlant, scene_graph: SceneGraph) -> None:
    """Makes a skeleton with collision shapes move as it does without drawing: its bodies do not touch each other."""
    bodies = [plant.get_body(BodyIndex(i)) for i in range(plant.num_bodies())]
    shapes = GeometrySet([shape for body in bodies for shape in plant.GetCollisionGeometriesForBody(body)])
    scene_graph.collision_filter_manager().Apply(CollisionFilterDeclaration().ExcludeWithin(shapes))
    builder.Connect(scene_graph.get_query_output_port(), plant.get_geometry_query_input_port())


def MakeSimulator(diagram: Diagram, time_step: float = TIME_STEP) -> Simulator:
    """A Simulator for discrete muscles: second-order Runge-Kutta with fixed steps, one per time step of the muscles."""
    simulator = Simulator(diagram)
    integrator = ResetIntegratorFromFlags(simulator, "runge_kutta2", time_step)
    integrator.set_fixed_step_mode(True)
    integrator.set_maximum_step_size(time_step)
    return simulator
