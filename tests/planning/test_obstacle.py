"""Obstacles: distances agree with SceneGraph, plans go around, and impossible movements are refused."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.geometry import Capsule, Cylinder, GeometryInstance, ProximityProperties, Role, SceneGraph
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import DiagramBuilder

from drakearm.errors import PlanningError
from drakearm.experiments.scenario import load_scenario
from drakearm.model import load_arm
from drakearm.model.obstacle import Obstacle, add_obstacle
from drakearm.model.skeleton import add_skeleton
from drakearm.planning import PlanningModel, plan

ARM = load_arm("arm14")
OBSTACLE = Obstacle(position=(0.3, 0.35, 0.17), axis=(0.1, -0.2, 1.0), radius=0.04)


@pytest.fixture(scope="module")
def scene():
    """A plant whose outline and obstacle are geometries that SceneGraph can measure, in a Diagram."""
    builder = DiagramBuilder()
    scene_graph = builder.AddSystem(SceneGraph())
    plant = builder.AddSystem(MultibodyPlant(time_step=0.0))
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    add_skeleton(plant, ARM)
    plant.Finalize()
    builder.Connect(plant.get_geometry_pose_output_port(), scene_graph.get_source_pose_port(plant.get_source_id()))
    context = plant.CreateDefaultContext()

    def register(body, X_BG, shape, name):
        geometry = GeometryInstance(X_BG, shape, name)
        geometry.set_proximity_properties(ProximityProperties())
        frame = plant.GetBodyFrameIdOrThrow(body.index())
        return scene_graph.RegisterGeometry(plant.get_source_id(), frame, geometry)

    parts = []
    for capsule in ARM.outline:
        (name, p_BP), (other, p_CQ) = capsule.ends
        body = plant.GetBodyByName(name)
        q = plant.GetBodyByName(other).EvalPoseInWorld(context).multiply(np.array(p_CQ))
        p, q = np.array(p_BP), body.EvalPoseInWorld(context).inverse().multiply(q)
        X_BG = RigidTransform(RotationMatrix.MakeFromOneVector(q - p, 2), 0.5 * (p + q))
        parts.append(register(body, X_BG, Capsule(capsule.radius, np.linalg.norm(q - p)), capsule.name))
    X_WO = RigidTransform(RotationMatrix.MakeFromOneVector(OBSTACLE.direction, 2), np.array(OBSTACLE.position))
    obstacle = register(plant.world_body(), X_WO, Cylinder(OBSTACLE.radius, 50.0), "obstacle")
    diagram = builder.Build()
    return diagram, diagram.CreateDefaultContext(), plant, scene_graph, parts, obstacle


@pytest.mark.parametrize("seed", range(20))
def test_clearance_is_the_distance_that_scene_graph_measures(scene, seed):
    _, root, plant, scene_graph, parts, obstacle = scene
    q = np.random.default_rng(seed).uniform([-1.0, 0.0], [1.5, 2.2])
    plant.SetPositions(plant.GetMyMutableContextFromRoot(root), q)
    query = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(root))
    measured = [query.ComputeSignedDistancePairClosestPoints(part, obstacle).distance for part in parts]
    found, _ = PlanningModel(ARM, obstacle=OBSTACLE).clearance(q)
    np.testing.assert_allclose(found, measured, atol=1e-4)


@pytest.mark.parametrize("seed", range(5))
def test_derivatives_of_the_clearance(seed):
    model = PlanningModel(ARM, obstacle=OBSTACLE)
    q = np.random.default_rng(seed).uniform([-1.0, 0.0], [1.5, 2.2])
    _, derivative = model.clearance(q)
    step = 1e-6 * np.eye(2)
    differences = [(model.clearance(q + h)[0] - model.clearance(q - h)[0]) / 2e-6 for h in step]
    np.testing.assert_allclose(derivative, np.transpose(differences), atol=1e-7)


def test_the_shipped_obstacle_is_in_the_way_and_is_passed():
    with_bar, without = load_scenario("obstacle"), load_scenario("no-obstacle")
    assert without.obstacle is None and with_bar.movement.target_deg == without.movement.target_deg
    model = PlanningModel(ARM, obstacle=with_bar.obstacle)
    straight = plan(ARM, without.movement).reference.q
    assert min(model.clearance(q)[0].min() for q in straight) < -0.02
    found = plan(ARM, with_bar.movement, obstacle=with_bar.obstacle)
    states = found.reference.trajectory()
    dense = [model.clearance(states.value(t).ravel())[0].min() for t in np.arange(0.0, 0.8, 5e-4)]
    assert min(dense) > 0.005
    assert found.verification.clearance == pytest.approx(min(dense), abs=1e-3)


def request(**changes):
    scenario = load_scenario("obstacle")
    return plan(ARM, replace(scenario.movement, **changes), obstacle=scenario.obstacle)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"start_deg": (0, 50)}, r"start has the hand inside the obstacle, at a distance of -[\d.]+ cm"),
        ({"target_deg": (0, 50)}, "target has the hand inside the obstacle"),
        ({"start_deg": (5, 35)}, "start has the hand too near to the obstacle"),
        ({"angle_limit_deg": ((-1, 1), (0, 91))}, "There is no way around the obstacle"),
    ],
)
def test_what_the_obstacle_forbids_is_said_in_a_sentence(changes, message):
    with pytest.raises(PlanningError, match=message):
        request(**changes)


def test_an_arm_without_an_outline_meets_no_obstacle():
    with pytest.raises(PlanningError, match="has no outline"):
        plan(replace(ARM, outline=()), load_scenario("no-obstacle").movement, obstacle=OBSTACLE)


def test_the_obstacle_is_drawn_in_the_world():
    scene_graph, plant = SceneGraph(), MultibodyPlant(time_step=0.0)
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    add_obstacle(plant, OBSTACLE)
    plant.Finalize()
    (geometry,) = plant.GetVisualGeometriesForBody(plant.world_body())
    inspector = scene_graph.model_inspector()
    assert inspector.GetProperties(geometry, Role.kIllustration) is not None
    np.testing.assert_allclose(inspector.GetPoseInFrame(geometry).translation(), OBSTACLE.position)
    along = inspector.GetPoseInFrame(geometry).rotation().matrix()[:, 2]
    np.testing.assert_allclose(along, OBSTACLE.direction, atol=1e-12)
