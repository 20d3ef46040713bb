"""An arm drawn in a user's own Diagram: its bodies and muscles are where they are."""

import re
import struct
from base64 import b64decode

import numpy as np
import pytest
from pydrake.geometry import Meshcat, MeshcatParams
from pydrake.math import RigidTransform
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams import AddMuscleArm, AddMuscleVisualizer
from drakearm.model import load_arm


@pytest.fixture
def meshcat():
    return Meshcat(MeshcatParams(host="localhost", port=0))


def transform(meshcat, path):
    """The latest transform (4, 4) that a page gets for a path."""
    for code in re.findall(r'fetch\("data:[^,"]*,([^"]*)"', meshcat.StaticHtml()):
        command = b64decode(code)  # msgpack
        if b"set_transform" in command and re.search(
            rb"\xa4path.{1,3}?" + re.escape(path.encode()) + rb"\xa6", command
        ):
            doubles = re.findall(rb"\xcb(.{8})", command.split(b"matrix")[1], re.DOTALL)
            return np.array([struct.unpack(">d", double)[0] for double in doubles]).reshape(4, 4).T
    raise AssertionError(f"no transform of {path}")


def test_bones_load_and_muscles_follow_the_arm(meshcat):
    arm, builder = load_arm(), DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm, load_mass=2.0)
    AddMuscleVisualizer(builder, muscle_arm, meshcat)
    builder.ExportInput(muscle_arm.muscles.GetInputPort("excitation"), "excitation")
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    diagram.GetInputPort("excitation").FixValue(context, np.zeros(14))
    for q in ([0.0, 0.3], [0.9, 1.4]):
        muscle_arm.SetState(context, np.array(q))
        diagram.ForcedPublish(context)
        plant_context = muscle_arm.plant.GetMyContextFromRoot(context)
        for body in ("r_humerus", "hand", "load"):
            pose = muscle_arm.plant.GetBodyByName(body).EvalPoseInWorld(plant_context)
            np.testing.assert_allclose(
                transform(meshcat, f"/drake/skeleton/{body}"), pose.GetAsMatrix4(), rtol=0.0, atol=1e-9
            )
        muscle = arm.muscles[0]
        body, point = muscle.points[0]
        start = muscle_arm.plant.GetBodyByName(body).EvalPoseInWorld(plant_context).multiply(np.array(point))
        np.testing.assert_allclose(transform(meshcat, f"/drake/muscles/{muscle.name}/0")[:3, 3], start, atol=1e-9)
    assert meshcat.HasPath("/drake/skeleton/load/0/shape")


def test_two_arms_stand_where_they_are_put(meshcat):
    """In one Diagram, on one page: each with its own muscles, which move on their own."""
    arm, builder = load_arm(), DiagramBuilder()
    arms = {name: AddMuscleArm(builder, arm, name=name) for name in ("left", "right")}
    for name, side in (("left", -0.4), ("right", 0.4)):
        AddMuscleVisualizer(builder, arms[name], meshcat, X_PW=RigidTransform([0.0, side, 0.0]))
        builder.ExportInput(arms[name].muscles.GetInputPort("excitation"), name)
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    for name, elbow in (("left", 0.3), ("right", 1.2)):
        diagram.GetInputPort(name).FixValue(context, np.zeros(14))
        arms[name].SetState(context, np.array([0.0, elbow]))
    diagram.ForcedPublish(context)
    hands = [transform(meshcat, f"/{name}/skeleton/hand") for name in arms]
    assert np.abs(hands[0] - hands[1]).max() > 0.1
    places = [transform(meshcat, f"/{name}")[:3, 3] for name in arms]
    np.testing.assert_allclose(places, [[0.0, -0.4, 0.0], [0.0, 0.4, 0.0]])
    assert meshcat.HasPath("/left/muscles") and not meshcat.HasPath("/drake/muscles")
