"""The drawn muscles: the positions of their pieces, their colors, and their motion in a Diagram."""

import re
import struct
from base64 import b64decode

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.geometry import Meshcat, MeshcatParams
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams import AddMuscleArm, MakeSimulator
from drakearm.model import Arm, MakeTorqueArm, load_arm
from drakearm.systems.muscle_drawing import MuscleDrawing, activation_color, segment_pose, upright
from drakearm.systems.muscle_path import smooth_path
from drakearm.systems.muscle_visualizer import MuscleVisualizer

PIECES, TENDON = 11, 2  # pieces per muscle, and those of the tendon at each end

coordinate = st.floats(-1.0, 1.0).map(lambda x: round(x, 4))
points = st.tuples(coordinate, coordinate, coordinate).map(np.array)


@pytest.fixture(scope="module")
def arm() -> Arm:
    return load_arm()


@pytest.fixture
def meshcat() -> Meshcat:
    params = MeshcatParams()
    params.host, params.port = "localhost", 0
    return Meshcat(params)


@given(start=points, end=points)
def test_segment_runs_from_start_to_end(start: np.ndarray, end: np.ndarray) -> None:
    pose, length = segment_pose(start, end)
    np.testing.assert_allclose(pose.translation(), start, atol=1e-12)
    np.testing.assert_allclose(pose.multiply([0.0, 0.0, length]), end, atol=1e-12)


def test_color_goes_from_slate_to_red_and_darkens_on_the_way() -> None:
    colors = activation_color(np.linspace(0.0, 1.0, 101))
    red, green, blue = colors.T
    assert blue[0] > green[0] > red[0]
    assert red[-1] > 0.7 and green[-1] < 0.1 and blue[-1] < 0.2
    assert np.all(np.diff(red - blue) > 0.0)
    assert np.all(np.diff(colors @ [0.2126, 0.7152, 0.0722]) < 0.0)
    assert np.all((colors >= 0.0) & (colors <= 1.0))


def test_upright_turns_gravity_down(arm: Arm) -> None:
    down = upright(arm).rotation().multiply(np.array(arm.gravity))
    np.testing.assert_allclose(down / np.linalg.norm(down), [0.0, 0.0, -1.0], atol=1e-12)
    np.testing.assert_allclose(upright(arm).rotation().multiply([1.0, 0.0, 0.0]), [1.0, 0.0, 0.0])


@given(corners=st.lists(points, min_size=2, max_size=7))
def test_a_smooth_path_goes_through_its_points_in_order(corners: list[np.ndarray]) -> None:
    path, at = smooth_path(np.array(corners)), 0
    for corner in corners:
        distance = np.linalg.norm(path[at:] - corner, axis=1)
        assert distance.min() < 1e-9
        at += int(np.argmin(distance))


def test_the_pieces_of_a_muscle_join_and_keep_its_volume(arm: Arm, meshcat: Meshcat) -> None:
    plant = MakeTorqueArm(arm)
    context = plant.CreateDefaultContext()
    drawing = MuscleDrawing(meshcat, "/muscles", arm, plant)
    activation = np.linspace(0.0, 1.0, len(arm.muscles))
    volumes = []
    for q in ([0.0, 0.3], [0.8, 1.5]):
        plant.SetPositions(context, q)
        X_WB = plant.get_body_poses_output_port().Eval(context)
        drawing.draw(X_WB, activation)
        scene = _scene(meshcat)
        volume = []
        for muscle in arm.muscles:
            p_W = np.array([X_WB[int(plant.GetBodyByName(b).index())].multiply(p) for b, p in muscle.points])
            poses = [scene[f"/muscles/{muscle.name}/{k}", "matrix"].reshape(4, 4).T for k in range(PIECES)]
            scales = np.array([scene[f"/muscles/{muscle.name}/{k}/shape", "scale"] for k in range(PIECES)])
            starts = [pose[:3, 3] for pose in poses]
            ends = [(pose @ [0.0, 0.0, scale[2], 1.0])[:3] for pose, scale in zip(poses, scales, strict=True)]
            np.testing.assert_allclose([starts[0], ends[-1]], p_W[[0, -1]], atol=1e-9)
            np.testing.assert_allclose(starts[1:], ends[:-1], atol=1e-9)
            belly = scales[TENDON:-TENDON]
            volume.append(float((belly[:, 0] * belly[:, 1] * belly[:, 2]).sum()))
            assert (scales[:TENDON, 0] * 0.25 < 0.5 * belly[:, 0].max()).all()  # tendons are thinner
        volumes.append(volume)
    # Where the belly bends, its straight pieces are a little shorter than the path.
    np.testing.assert_allclose(volumes[0], volumes[1], rtol=0.06)


def test_color_properties_hold_linear_light(arm: Arm, meshcat: Meshcat) -> None:
    plant = MakeTorqueArm(arm)
    X_WB = plant.get_body_poses_output_port().Eval(plant.CreateDefaultContext())
    MuscleDrawing(meshcat, "/muscles", arm, plant).draw(X_WB, np.ones(len(arm.muscles)))
    scene = _scene(meshcat)
    shape = f"/muscles/{arm.muscle_names[0]}/{TENDON}/shape/surface/<object>"
    linear = np.hstack([scene[shape, f"material.color[{c}]"] for c in "rgb"])
    encoded = 1.055 * linear ** (1 / 2.4) - 0.055  # the definition of sRGB, above its toe
    np.testing.assert_allclose(encoded, activation_color(np.array(1.0)), atol=1e-3)


def test_a_diagram_moves_the_muscles(arm: Arm, meshcat: Meshcat) -> None:
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm)
    MuscleVisualizer.AddToBuilder(builder, muscle_arm.plant, muscle_arm.muscles, meshcat)
    builder.ExportInput(muscle_arm.muscles.GetInputPort("excitation"), "excitation")
    diagram = builder.Build()
    simulator = MakeSimulator(diagram)
    context = simulator.get_mutable_context()
    diagram.GetInputPort("excitation").FixValue(context, np.zeros(len(arm.muscles)))

    def pose() -> np.ndarray:
        return _scene(meshcat)[f"/drake/muscles/{arm.muscle_names[0]}/3", "matrix"]

    muscle_arm.SetState(context, np.array([0.0, 0.3]))
    diagram.ForcedPublish(context)
    low = pose()
    muscle_arm.SetState(context, np.array([1.0, 0.3]))
    diagram.ForcedPublish(context)
    high = pose()
    simulator.AdvanceTo(0.05)  # the arm falls
    assert not np.allclose(low, high)
    assert not np.allclose(high, pose())


def _scene(meshcat: Meshcat) -> dict[tuple[str, str], np.ndarray]:
    """The numbers of every transform ("matrix", in column order) and property in the scene, by path and name."""
    scene = {}
    for code in re.findall(r'fetch\("data:[^,"]*,([^"]*)"', meshcat.StaticHtml()):
        command = b64decode(code)  # msgpack
        match = re.search(rb"\xa4path.*?(/.*?)(?:\xa6(matrix)|\xa8property.(.*?)\xa5value)", command, re.DOTALL)
        if match and b"set_object" not in command:
            name = match[2] or match[3]
            doubles = re.findall(rb"\xcb(.{8})", command[match.end() :], re.DOTALL)
            values = np.array([struct.unpack(">d", d)[0] for d in doubles])
            scene[match[1].decode(), name.decode()] = values
    return scene
