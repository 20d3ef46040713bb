"""The arm with its muscles, as a part of a Diagram."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import Adder

from drakearm.model import Arm
from drakearm.model.equilibrium import Equilibrium, find_equilibrium
from drakearm.model.joint_stops import stop_strength
from drakearm.model.musculature import RESTING_ACTIVATION, require_state
from drakearm.model.obstacle import Obstacle, add_obstacle
from drakearm.model.skeleton import add_skeleton, load_inertia, neutral_posture
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
    plant: MultibodyPlant
    muscles: "HillMuscles"
    stops: "JointStops | None"
    load_mass: float = 0.0  # kg, in the hand

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
        StateError for arrays of another size or numbers that are not finite, and EquilibriumError if a muscle has no
        equilibrium.
        """
        n_q = len(self.arm.coordinates)
        q = np.asarray(q, dtype=float)
        v = np.zeros(n_q) if v is None else np.asarray(v, dtype=float)
        require_state("joint angles", q, (n_q,))
        require_state("joint speeds", v, (n_q,))
        context = self.plant.GetMyMutableContextFromRoot(root_context)
        self.plant.SetPositions(context, q)
        self.plant.SetVelocities(context, v)
        self.muscles.SetEquilibrium(self.muscles.GetMyMutableContextFromRoot(root_context), q, activation)

    def SetBody(self, root_context: Context, load_mass: float, strength: float | np.ndarray) -> None:
        """Sets the load (kg) and the factors of the maximum isometric forces, one number or (n,).

        Only for an arm with a variable load. Raises StateError for other numbers than positive ones.
        """
        load = self.plant.GetBodyByName(LOAD)
        load.SetSpatialInertiaInBodyFrame(self.plant.GetMyMutableContextFromRoot(root_context), load_inertia(load_mass))
        self.muscles.SetStrength(self.muscles.GetMyMutableContextFromRoot(root_context), strength)

    def SetEquilibrium(self, root_context: Context, q: np.ndarray) -> Equilibrium:
        """Sets the arm to rest at q (n_q,), rad, with muscles that hold it there, and returns this equilibrium.

        Nothing moves while the muscles get the excitations of the equilibrium, so Drake's `Linearize` works there.
        Raises EquilibriumError if the muscles are too weak to hold the posture.
        """
        equilibrium = find_equilibrium(self.arm, q, self.load_mass)
        self.SetState(root_context, q, activation=equilibrium.activation)
        return equilibrium


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
) -> MuscleArm:
    """Adds plant, muscles and joint stops to a builder and connects them to each other.

    load_mass: kg, welded to the hand. variable_load: whether `MuscleArm.SetBody` can change it. stops: whether
    JointStops keep the joints in the ranges of the skeleton file, as strong as `stop_strength` says. time_step: s, of
    the muscles and stops; 0 makes them continuous. scene_graph: where the shapes of the skeleton and of the obstacle
    are registered for drawing. obstacle: only drawn, the arm passes through it. The plant is always continuous:
    simulate with `MakeSimulator`, or with an integrator of your choice. Its default joint angles are 0, or as near to 0
    as their ranges allow.
    """
    plant = builder.AddNamedSystem("plant", MultibodyPlant(time_step=0.0))
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
    muscles = builder.AddNamedSystem("muscles", HillMuscles_[float](arm, time_step))
    builder.Connect(plant.get_state_output_port(), muscles.GetInputPort("arm_state"))
    torque = muscles.GetOutputPort("generalized_force")
    joint_stops = None
    if stops:
        joint_stops = builder.AddNamedSystem(
            "stops",
            JointStops_[float](
                plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits(), time_step, *stop_strength(arm)
            ),
        )
        builder.Connect(plant.get_state_output_port(), joint_stops.GetInputPort("arm_state"))
        total = builder.AddNamedSystem("joint_torque", Adder(2, len(arm.coordinates)))
        builder.Connect(torque, total.get_input_port(0))
        builder.Connect(joint_stops.GetOutputPort("generalized_force"), total.get_input_port(1))
        torque = total.get_output_port()
    builder.Connect(torque, plant.get_applied_generalized_force_input_port())
    return MuscleArm(arm, plant, muscles, joint_stops, load_mass)


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
