"""Skeleton files: whatever Drake's Parser does with them, a damaged or impossible one is refused in one sentence."""

import random
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest
from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams import AddMuscleArm, MakeSimulator
from drakearm.errors import LONGEST_MESSAGE, ArmError
from drakearm.model import load_arm
from drakearm.model.skeleton import add_skeleton
from drakearm.model.skeleton_file import check_skeleton

ARM = load_arm("arm14")
URDF = ARM.skeleton.read_text()
LIMIT = '<limit lower="0" upper="2.26892803"'


@pytest.fixture
def add(tmp_path):
    """Adds a skeleton to a plant. Its file has the given text or bytes."""

    def add(content, ending=".urdf", arm=ARM):
        file = tmp_path / f"skeleton{ending}"
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
        add_skeleton(MultibodyPlant(0.0), replace(arm, skeleton=file))

    return add


def edited(old, new):
    assert old in URDF
    return URDF.replace(old, new)


def refusal(add, *arguments):
    with pytest.raises(ArmError) as error:
        add(*arguments)
    return one_sentence(error.value)


def one_sentence(error):
    message = str(error)
    assert "skeleton" in message and len(message) <= LONGEST_MESSAGE and "\n" not in message
    return message


WRONG = {
    "no bytes": (b"", "not valid XML in line 1"),
    "binary": (b"\xff\xfe\x00\x01", "not text"),
    "NUL": (b"\x00" * 100, "not valid XML"),
    "plain text": ("a skeleton", "not valid XML"),
    "cut off": (URDF[:3000], "not valid XML in line 76"),
    "two roots": (URDF + "<robot/>", "not valid XML"),
    "entities": ('<!DOCTYPE a [<!ENTITY b "cc">]>' + URDF.split("?>", 1)[1], "document type"),
    "deep": ("<a>" * 3000 + "</a>" * 3000, "XML_ELEMENT_DEPTH_EXCEEDED"),
    "no robot": ("<mujoco/>", "does not contain a robot tag"),
    "mass is text": (edited('mass value="0.5819"', 'mass value="heavy"'), "line 81: .* got 'heavy'"),
    "mass is NaN": (edited('mass value="0.5819"', 'mass value="nan"'), "line 81: .* got 'nan'"),
    "mass is infinite": (edited('mass value="0.5819"', 'mass value="inf"'), "line 81: .* got 'inf'"),
    "mass is negative": (edited('mass value="0.5819"', 'mass value="-1"'), "line 79: no body has this mass"),
    "mass is 0": (edited('mass value="0.5819"', 'mass value="0"'), "line 79: no body has this mass"),
    "mass is huge": (edited('mass value="0.5819"', 'mass value="1e300"'), "no body has this mass"),
    "inertia is negative": (edited('ixx="0.00011"', 'ixx="-1"'), "line 79: no body has this mass"),
    "inertia breaks the triangle inequality": (edited('ixx="0.00011"', 'ixx="1"'), "line 79: no body has this mass"),
    "nothing has mass": (re.sub(r"(?s)<inertial>.*?</inertial>", "", URDF), "shoulder moves bodies .* 0 kg m.2"),
    "limits out of order": (edited(LIMIT, '<limit lower="3" upper="2"'), "lower limit is above its upper limit"),
    "limit is NaN": (edited(LIMIT, '<limit lower="nan" upper="2"'), r"line 1\d\d: .* got 'nan'"),
    "limit is huge": (edited(LIMIT, '<limit lower="0" upper="1e300"'), "elbow has the limits 0 and 1e.300 rad"),
    "axis is 0": (edited("0.04940001 0.03660001 0.99810825", "0 0 0"), "elbow' axis is zero"),
    "axis is NaN": (edited("0.04940001 0.03660001 0.99810825", "0 0 nan"), "got 0 0 nan"),
    "prismatic": (
        edited('"elbow" type="revolute"', '"elbow" type="prismatic"'),
        "elbow is prismatic: expected revolute",
    ),
    "planar": (edited('"elbow" type="revolute"', '"elbow" type="planar"'), "elbow is planar: expected revolute"),
    "floating": (edited('"elbow" type="revolute"', '"elbow" type="floating"'), "'elbow' specified as type floating"),
    "unknown type": (edited('"elbow" type="revolute"', '"elbow" type="knee"'), "unrecognized type: 'knee'"),
    "mimic": (edited(LIMIT, f'<mimic joint="shoulder"/>{LIMIT}'), "constraints, such as mimic joints"),
    "friction": (edited(LIMIT, f'<dynamics friction="1"/>{LIMIT}'), r"line 1\d\d: .*friction"),
    "negative damping": (edited(LIMIT, f'<dynamics damping="-1"/>{LIMIT}'), "damping must be nonnegative"),
    "body twice": (edited('<link name="radius">', '<link name="ulna">'), "already contains a body named 'ulna'"),
    "joint twice": (edited('<joint name="elbow"', '<joint name="shoulder"'), "already contains .* 'shoulder_parent'"),
    "unknown parent": (edited('parent link="world"', 'parent link="mars"'), "link named 'mars'"),
    "own parent": (edited('parent link="world"', 'parent link="base"'), "body base to itself"),
    "cycle": (edited('parent link="world"', 'parent link="hand"'), "loops"),
    "not connected": (re.sub(r'(?s)<joint name="thorax".*?</joint>', "", URDF), "base to the world"),
    "body for loads": (edited("</robot>", '<link name="load"/></robot>'), "body load"),
    "no tip": (edited('<frame name="hand_tip"', '<frame name="tip"'), "no frame hand_tip"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_skeleton_is_refused_with_the_reason(add, name):
    content, expected = WRONG[name]
    assert re.search(expected, refusal(add, content))


def test_bodies_of_muscles_must_exist(add):
    muscle = replace(ARM.muscles[0], points=(("fin", (0.0, 0.0, 0.0)),))
    assert "no body fin, where TRIlong is attached" in refusal(add, URDF, ".urdf", replace(ARM, muscles=(muscle,)))


def test_coordinates_are_in_the_order_of_the_chain(add):
    """The order of a plant's q is that of the chain, whatever the order of the joints in the file is."""
    elbow = re.search(r'(?s)<joint name="elbow".*?</joint>', URDF)[0]
    swapped = URDF.replace(elbow, "").replace('<joint name="shoulder"', elbow + '<joint name="shoulder"')
    add(swapped)
    turned = replace(ARM, coordinates=ARM.coordinates[::-1])
    assert "moving joints are shoulder, elbow" in refusal(add, swapped, ".urdf", turned)


@pytest.mark.parametrize("ending", [".txt", ".dmd.yaml", ".obj", ""])
def test_only_files_of_skeletons_are_read(add, ending):
    assert "expected a skeleton file with the ending" in refusal(add, URDF, ending)


def test_missing_skeleton_is_refused():
    with pytest.raises(ArmError, match="cannot be read"):
        add_skeleton(MultibodyPlant(0.0), replace(ARM, skeleton=ARM.skeleton.parent / "nowhere.urdf"))


def test_two_joints_that_turn_the_same_bodies_about_the_same_axis_are_refused(add):
    """Without a mass between them both could accelerate in opposite directions without any force."""
    joints = "".join(
        f'<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>'
        '<axis xyz="0 0 1"/></joint>'
        for name, parent, child in (("shoulder", "world", "a"), ("elbow", "a", "hand"))
    )
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    text = f'<robot name="arm"><link name="a"/><link name="hand">{inertial}</link>{joints}</robot>'
    muscles = tuple(replace(muscle, points=()) for muscle in ARM.muscles)
    arm = replace(ARM, muscles=muscles, outline=(), load_frame="hand", tip_frame="hand")
    assert "can move without moving any mass" in refusal(add, text, ".urdf", arm)


def test_missing_and_damaged_meshes_are_refused_where_they_are_drawn(tmp_path):
    file = tmp_path / "skeleton.urdf"
    for mesh in ("a.obj", "package://nowhere/a.obj", "package://drake_models/a.obj", "http://localhost/a.obj"):
        file.write_text(edited('filename="scapula.obj"', f'filename="{mesh}"'))
        builder = DiagramBuilder()
        with pytest.raises(ArmError, match=r"skeleton.urdf is refused by Drake: line 18"):
            AddMuscleArm(builder, replace(ARM, skeleton=file), scene_graph=builder.AddSystem(SceneGraph()))


def test_collision_shapes_change_nothing(tmp_path):
    shutil.copytree(ARM.skeleton.parent, tmp_path, dirs_exist_ok=True)  # the meshes are beside the skeleton
    file = tmp_path / "skeleton.urdf"
    ball = '<collision><geometry><sphere radius="0.5"/></geometry></collision>'
    file.write_text(
        edited('<link name="hand">', f'<link name="hand">{ball}').replace('me="base">', f'me="base">{ball}')
    )
    reached = []
    for arm in (ARM, replace(ARM, skeleton=file)):
        builder = DiagramBuilder()
        muscle_arm = AddMuscleArm(builder, arm, scene_graph=builder.AddSystem(SceneGraph()))
        builder.ExportInput(muscle_arm.muscles.GetInputPort("excitation"), "excitation")
        diagram = builder.Build()
        simulator = MakeSimulator(diagram)
        context = simulator.get_mutable_context()
        diagram.GetInputPort("excitation").FixValue(context, np.full(14, 0.1))
        simulator.AdvanceTo(0.02)
        reached.append(muscle_arm.plant.GetPositions(muscle_arm.plant.GetMyContextFromRoot(context)))
    np.testing.assert_array_equal(reached[0], reached[1])


def test_any_damaged_file_is_accepted_or_refused_in_one_sentence(add):
    """Numbers, names, elements and bytes of the file are changed at random. What is accepted has finite dynamics."""
    rng, refused = random.Random(0), 0
    number, name = re.compile(r'(?<=[" ])-?\d[\d.e-]*(?=[" ])'), re.compile(r'(?<==")[A-Za-z_]+(?=")')
    element = re.compile(r"(?s)<(link|joint|inertial|limit|axis|origin|mass|inertia)\b[^>]*?(/>|>.*?</\1>)")
    for _ in range(300):
        pattern = rng.choice([number, number, name, element, re.compile(".")])
        at = rng.choice(list(pattern.finditer(URDF)))
        new = {
            number: rng.choice(["0", "-1", "1e-300", "1e300", "1e12", "nan", "x", "", f"-{at[0]}"]),
            name: rng.choice(["", "world", "hand", "load", "fixed", "prismatic", "\x01", "n" * 1000]),
            element: rng.choice(["", 2 * at[0]]),
        }.get(pattern, rng.choice(["\x00", "<", '"', ""]))
        text = URDF[: at.start()] + new + URDF[at.end() :]
        try:
            add(text)
        except ArmError as error:
            refused += 1
            one_sentence(error)
    assert 100 < refused < 300


@pytest.mark.parametrize(
    ("before", "added"),
    [
        ("<robot ", 'version="1.0" '),
        ("</robot>", '<transmission name="t"><type>x</type></transmission>'),
    ],
)
def test_tags_for_other_programs_are_no_error(tmp_path, before, added):
    """Files of robots in ROS have them. Drake ignores them."""
    text = URDF
    at = text.index(before) + (len(before) if before.startswith("<robot") else 0)
    file = tmp_path / "robot.urdf"
    file.write_text(text[:at] + added + text[at:])
    check_skeleton(replace(ARM, skeleton=file))
