"""Bones for bodies without shapes: from joint to joint, with nothing for bodies that have no length."""

import numpy as np
import pytest
from pydrake.geometry import Capsule, Meshcat, MeshcatParams, SceneGraph, Sphere
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drakearm.systems.plain_bones import plain_bones
from drakearm.systems.skeleton_drawing import SkeletonDrawing

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
URDF = f"""<robot name="limb">
  <link name="thigh">{INERTIAL}</link>
  <link name="shank">{INERTIAL}<visual><geometry><sphere radius="0.1"/></geometry></visual></link>
  <link name="foot">{INERTIAL}</link>
  <joint name="hip" type="revolute"><parent link="world"/><child link="thigh"/><axis xyz="0 1 0"/>
    <limit effort="1" lower="-1" upper="1" velocity="1"/></joint>
  <joint name="knee" type="revolute"><parent link="thigh"/><child link="shank"/><axis xyz="0 1 0"/>
    <origin xyz="0 0.3 -0.4"/><limit effort="1" lower="-1" upper="1" velocity="1"/></joint>
  <joint name="ankle" type="fixed"><parent link="shank"/><child link="foot"/><origin xyz="0 0 -0.4"/></joint>
</robot>"""


@pytest.fixture
def registered():
    plant, scene_graph = MultibodyPlant(0.0), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    Parser(plant).AddModelsFromString(URDF, "urdf")
    plant.Finalize()
    return plant, scene_graph


def test_a_bone_reaches_from_joint_to_joint(registered):
    plant, _ = registered
    (_, ball), (X_BG, rod) = plain_bones(plant, plant.GetBodyByName("thigh"))
    assert isinstance(ball, Sphere) and isinstance(rod, Capsule)
    assert rod.length() == pytest.approx(0.5) and rod.radius() < ball.radius() < 0.1
    ends = [X_BG.multiply([0.0, 0.0, z]) for z in (-0.25, 0.25)]
    np.testing.assert_allclose(ends, [[0.0, 0.0, 0.0], [0.0, 0.3, -0.4]], atol=1e-9)


def test_the_world_and_the_last_body_have_none(registered):
    plant, _ = registered
    assert plain_bones(plant, plant.world_body()) == []
    assert plain_bones(plant, plant.GetBodyByName("foot")) == []


def test_only_bodies_without_shapes_get_them(registered):
    meshcat = Meshcat(MeshcatParams(host="localhost", port=0))
    SkeletonDrawing(meshcat, "/limb", *registered)
    assert [meshcat.HasPath(f"/limb/{part}") for part in ("thigh/0", "thigh/1", "shank/0", "shank/1", "foot")] == [
        True, True, True, False, False,
    ]  # fmt: skip
