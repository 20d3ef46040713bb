"""A limb that is imported from OpenSim moves, weighs and pulls as it does there."""

import math
from importlib.util import find_spec

import numpy as np
import pytest

from drakearm.importing.opensim_file import import_opensim
from drakearm.importing.opensim_model import OpenSimProgram
from drakearm.model import load_arm
from drakearm.model.skeleton import skeleton_plant
from tests.importing.limbs import (
    HERE,
    assert_bodies_are_in_place,
    changed,
    geometry,
    imported,
    poses_in_drake,
    postures,
    refusal,
    shared,
)

if not find_spec("opensim"):
    pytest.skip("OpenSim is not installed", allow_module_level=True)
opensim = import_opensim()  # not with importorskip: that would leave OpenSim's library path to all later tests

LEG = HERE / "leg.osim"
TRANSLATION = ("<coefficients>0 0</coefficients>", "<coefficients>0.01 0</coefficients>")


@pytest.fixture(scope="module")
def leg(tmp_path_factory):
    return imported(LEG, tmp_path_factory.mktemp("leg") / "leg")


def test_every_body_is_where_opensim_has_it(leg):
    assert_bodies_are_in_place(*leg, OpenSimProgram(LEG, {}))


def test_accelerations_are_those_of_opensim(leg):
    """Without muscles, in motion: masses, inertias, axes and gravity are the same."""
    limb, arm = leg
    model = opensim.Model(str(LEG))
    model.updForceSet().clearAndDestroy()
    model.finalizeConnections()
    state = model.initSystem()
    coordinates = [model.getCoordinateSet().get(name) for name in arm.coordinates]
    plant = skeleton_plant(arm)
    context = plant.CreateDefaultContext()
    for q in postures(limb):
        v = 3.0 * np.sin(10.0 * q)
        for coordinate, angle, speed in zip(coordinates, q.tolist(), v.tolist(), strict=True):
            coordinate.setValue(state, angle, False)
            coordinate.setSpeedValue(state, speed)
        model.realizeAcceleration(state)
        theirs = [coordinate.getAccelerationValue(state) for coordinate in coordinates]
        plant.SetPositionsAndVelocities(context, np.concatenate([q, v]))
        ours = plant.EvalTimeDerivatives(context).CopyToVector()[len(q) :]
        np.testing.assert_allclose(ours, theirs, rtol=1e-8, atol=1e-6)


def test_lengths_and_moment_arms_are_those_of_opensim(leg):
    limb, arm = leg
    q = postures(limb, 50)
    length, arms = OpenSimProgram(LEG, {}).sampler(arm.muscle_names, arm.coordinates)(q)
    ours = geometry(arm, q)
    np.testing.assert_allclose(ours[0], length, atol=3e-5)
    np.testing.assert_allclose(ours[1], arms, atol=1e-4)
    assert np.median(np.abs(ours[1] - arms)) < 1e-5


def test_every_parameter_is_kept(leg):
    muscles = {muscle.name: muscle for muscle in leg[1].muscles}
    vasti = muscles["vasti"]
    assert vasti.model == "thelen2003" and vasti.tendon == "compliant"
    numbers = (
        vasti.max_isometric_force,
        vasti.optimal_fiber_length,
        vasti.tendon_slack_length,
        vasti.pennation_angle,
        vasti.max_contraction_velocity,
        vasti.tendon_strain,
        vasti.passive_strain,
        vasti.active_width,
        vasti.passive_shape,
        vasti.force_velocity_shape,
        vasti.eccentric_force,
        vasti.activation_time,
        vasti.deactivation_time,
        vasti.minimum_activation,
    )
    assert numbers == (2000.0, 0.09, 0.12, 0.08, 8.0, 0.035, 0.55, 0.48, 4.2, 0.28, 1.6, 0.013, 0.045, 0.02)
    hamstrings = muscles["hamstrings"]
    assert (hamstrings.model, hamstrings.tendon) == ("degroote2016", "rigid")
    assert (hamstrings.tendon_strain, hamstrings.passive_strain) == (0.049, 0.7)
    gluteus = muscles["gluteus"]
    assert (gluteus.model, gluteus.tendon_strain, gluteus.passive_strain) == ("degroote2016", 0.05, 0.65)


def test_what_is_not_kept_is_said(leg, tmp_path):
    report = (leg[1].skeleton.parent / "report.md").read_text()
    for sentence in (
        "muscles that cross no joint are left out: soleus",
        "left out: CoordinateActuator: motor",
        "ankle_angle is locked at 17.1887 degrees, as in the file",
        "gluteus: active_force_width_scale 1.2",
        "hamstrings: the curves of Millard2012EquilibriumMuscle: degroote2016 is used",
        "loads hang at the mass center of toes",
    ):
        assert sentence in report
    assert "Everyone may use it" in (leg[1].skeleton.parent / "CREDITS.md").read_text()


def test_coordinates_can_be_locked_and_bodies_left_out(tmp_path):
    _, arm = imported(LEG, tmp_path / "locked", locks={"hip_adduction": 10.0, "hip_flexion": 5.0})
    assert arm.coordinates == ("knee_angle",)
    assert arm.muscle_names == ("vasti", "hamstrings")
    program = OpenSimProgram(LEG, {})
    program.set_coordinates({"hip_adduction": math.radians(10.0), "hip_flexion": math.radians(5.0), "knee_angle": -1.0})
    np.testing.assert_allclose(poses_in_drake(arm, np.array([-1.0]))["foot"], program.poses()["foot"], atol=1e-9)
    only, arm = imported(LEG, tmp_path / "only", only=["thigh", "shank"])
    assert arm.coordinates == ("knee_angle",) and arm.muscle_names == ("vasti",)
    assert any("leave the kept bodies are left out: hamstrings, gluteus, soleus" in note for note in only.notes)
    assert any("thigh is fixed in the world" in note for note in only.notes)


def test_a_translating_knee_is_named_or_frozen(tmp_path):
    file = changed(tmp_path, "leg.osim", TRANSLATION)
    sentence = refusal(file)
    for part in ("joint knee ", "--freeze knee=DEG", "--lock knee_angle=DEG"):
        assert part in sentence
    others = {"hip_flexion": 0.0, "hip_adduction": 0.0}
    limb, _ = imported(file, tmp_path / "frozen", frozen={"knee": -50.0}, locks=others)
    knee = next(link for link in limb.links if link.joint == "knee_angle")
    thigh = next(link for link in limb.links if link.name == "thigh")
    assert (knee.origin[:3, 3] - thigh.shift)[0] == pytest.approx(0.01 * math.radians(-50.0))
    assert knee.axis == pytest.approx([0.0, 0.0, 1.0])
    assert "has nothing to freeze" in refusal(file, frozen={"ankle": 0.0})
    assert "no joint kne (did you mean knee?)" in refusal(file, frozen={"kne": 0.0})


def test_a_coupled_coordinate_is_named(tmp_path):
    coupler = """<ConstraintSet name="constraintset"><objects><CoordinateCouplerConstraint name="coupler">
        <coupled_coordinates_function><LinearFunction><coefficients>0.5 0</coefficients></LinearFunction>
        </coupled_coordinates_function><independent_coordinate_names>hip_flexion</independent_coordinate_names>
        <dependent_coordinate_name>knee_angle</dependent_coordinate_name>
        </CoordinateCouplerConstraint></objects></ConstraintSet>"""
    file = changed(tmp_path, "leg.osim", ("<!--CONSTRAINTS-->", coupler))
    assert "knee_angle follows hip_flexion" in refusal(file)
    _, arm = imported(file, tmp_path / "locked", locks={"knee_angle": -20.0})
    assert arm.coordinates == ("hip_flexion", "hip_adduction")


@pytest.mark.parametrize(
    "options, expected",
    [
        ({"only": ["thig"]}, "no body thig (did you mean thigh?)"),
        ({"locks": {"knee": 0.0}}, "no coordinate knee"),
        ({"tip": ("hand", (0.0, 0.0, 0.0))}, "no body hand for the tip"),
        ({"only": ["shank", "foot"]}, "0 coordinates that move"),
    ],
)
def test_unknown_names_are_refused(options, expected):
    assert expected in refusal(LEG, **options)


def test_the_tip_can_be_chosen(tmp_path):
    locks = {"hip_flexion": 0.0, "hip_adduction": 0.0}
    _, arm = imported(LEG, tmp_path / "leg", locks=locks, tip=("thigh", (0.1, 0.2, 0.3)))
    plant = skeleton_plant(arm)
    frame = plant.GetFrameByName(arm.tip_frame)
    assert frame.body().name() == "thigh"
    np.testing.assert_allclose(frame.GetFixedPoseInBodyFrame().translation(), [0.1, 0.2, 0.3])


def test_damaged_files_are_refused_in_one_sentence(tmp_path):
    for text, expected in (("", "refused by OpenSim"), ("<a/>", "refused by OpenSim"), (LEG.read_text()[:5000], "Xml")):
        file = tmp_path / "damaged.osim"
        file.write_text(text)
        assert expected in refusal(file)
    file.write_text('<OpenSimDocument Version="40000"><Model name="empty"/></OpenSimDocument>')
    assert "empty has 0 coordinates that move" in refusal(file)
    assert "There is no file" in refusal(tmp_path / "missing.osim")
    assert "expected a model of OpenSim (.osim) or MuJoCo (.xml)" in refusal(HERE / "limbs.py")


def test_arm26_is_as_close_as_other_converters_and_closer(tmp_path):
    """MyoConverter's figure for arm26 is 0.46 mm in the mean of the moment arms."""
    file = shared("models/arm26.osim")
    limb, arm = imported(file, tmp_path / "arm26")
    q = postures(limb, 300)
    _, arms = OpenSimProgram(file, {}).sampler(arm.muscle_names, arm.coordinates)(q)
    error = np.abs(geometry(arm, q)[1] - arms)[np.abs(arms) > 1e-9]
    print(f"moment arms: mean {1e3 * error.mean():.4f} mm, median {1e3 * np.median(error):.4f} mm")
    assert error.mean() < 0.46e-3 and np.median(error) < 5e-6


@pytest.mark.slow
@pytest.mark.extra
def test_the_papers_arm_is_what_drakearm_ships(tmp_path, oracle):
    """Bodies and parameters are equal, and paths no farther from OpenSim than in the table of docs/validation.md."""
    limb, arm = imported(shared("arm14/14muscles.osim"), tmp_path / "arm14", tip=("hand", (0.0, -0.1, 0.0)))
    shipped = load_arm("arm14")
    assert arm.muscle_names == shipped.muscle_names and arm.gravity == pytest.approx(shipped.gravity)
    np.testing.assert_allclose(
        np.array(arm.muscle_table.tolist()), np.array(shipped.muscle_table.tolist()), rtol=1e-9, atol=1e-12
    )
    for q in postures(limb, 5):
        ours, theirs = poses_in_drake(arm, q), poses_in_drake(shipped, q)
        for body in theirs:
            np.testing.assert_allclose(ours[body], theirs[body], atol=1e-7)
    grid = oracle("paths_grid.npz")
    inside = np.abs(grid["shoulder"] - math.radians(22.5)) <= math.radians(82.5) + 1e-9
    shoulder, elbow = grid["shoulder"][inside], grid["elbow"][grid["elbow"] > -1e-9]
    q = np.stack(np.meshgrid(shoulder, elbow, indexing="ij"), axis=-1).reshape(-1, 2)
    theirs = grid["moment_arm"][:, inside][:, :, grid["elbow"] > -1e-9]
    error = np.abs(geometry(arm, q)[1] - np.moveaxis(theirs.reshape(14, -1, 2), 0, 1))
    print("largest errors in mm: shoulder and elbow moment arm")
    for name, (by_shoulder, by_elbow) in zip(arm.muscle_names, 1e3 * error.max(axis=0), strict=True):
        print(f"| {name} | {by_shoulder:.2f} | {by_elbow:.2f} |")
    assert error.max() < 1.4e-3
