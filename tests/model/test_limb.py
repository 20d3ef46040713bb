"""Limbs from points: lengths of known geometry, slack lengths, the cache of fits, and refusals in one sentence."""

import logging

import numpy as np
import pytest

from drakearm.errors import ArmError
from drakearm.model import load_arm
from drakearm.model.loader import load_limb
from drakearm.model.musculature import muscle_geometry
from tests.limbs import ELBOW, EXTENSOR, FLEXOR, ROLL, WORLD, hinge, link, muscle, write_fork, write_limb


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setattr("drakearm.model.fit_cache.cache_folder", lambda: tmp_path / "cache")
    return tmp_path / "cache" / "fits"


def geometry(arm, *q):
    """Lengths (n,) and moment arms (n, n_q)."""
    return muscle_geometry(np.array(q), arm.muscle_table, arm.path_table)


def test_length_and_moment_arm_of_a_straight_muscle_are_those_of_a_triangle(tmp_path):
    arm = load_arm(write_limb(tmp_path))
    start, end = np.array([0.03, 0.25]), np.array([0.03, -0.05])
    for q in (0.0, 0.7, 2.3):
        length, moment_arm = geometry(arm, q)
        turned = np.array([[np.cos(q), -np.sin(q)], [np.sin(q), np.cos(q)]]) @ end
        assert length[0] == pytest.approx(np.linalg.norm(turned - start), abs=5e-6)
        along = (start - turned) / np.linalg.norm(start - turned)
        assert moment_arm[0, 0] == pytest.approx(turned[0] * along[1] - turned[1] * along[0], abs=5e-5)


def test_moment_arm_over_a_cylinder_around_the_joint_is_its_radius(tmp_path):
    arm = load_arm(write_limb(tmp_path))
    for q in np.deg2rad([40.0, 90.0, 135.0]):
        assert geometry(arm, q)[1][1, 0] == pytest.approx(-0.02, abs=2e-5)


def test_a_side_decides_how_a_muscle_passes_a_cylinder(tmp_path):
    front = {**ROLL, "side": [1, 0, 0]}
    arm = load_arm(write_limb(tmp_path, (FLEXOR, EXTENSOR), (front,)))
    assert geometry(arm, 0.3)[1][1, 0] == pytest.approx(0.02, abs=2e-5)


def test_muscles_of_a_tree_depend_on_the_joints_between_their_bodies(tmp_path):
    arm = load_arm(write_fork(tmp_path))
    crossed = {m.name: {name for term in m.path for name in term.coordinates} for m in arm.muscles}
    assert crossed["wrist_flexor"] == {"wrist"}
    assert crossed["left_flexor"] == {"left_finger"}
    assert crossed["right_extensor"] == {"right_finger"}
    assert crossed["long"] == {"wrist", "left_finger"}


def test_coordinates_and_gravity_can_be_left_out(tmp_path):
    arm = load_arm(write_fork(tmp_path))
    assert arm.coordinates == ("wrist", "left_finger", "right_finger")
    assert arm.gravity == (0.0, 0.0, -9.81)
    assert arm.load_frame is None


def test_fibers_are_optimal_at_the_given_posture_while_the_tendon_is_just_taut(tmp_path):
    for fields, q in (({}, 1.2), ({"optimal_posture_deg": [90]}, np.pi / 2)):
        limb = load_limb(write_limb(tmp_path, **fields))
        length, _ = geometry(limb.arm, q)
        slack = limb.arm.muscle_table["tendon_slack_length"]
        np.testing.assert_allclose(length - slack, limb.arm.muscle_table["optimal_fiber_length"], atol=1e-12)
        assert set(limb.optimal_posture) == {"flexor", "extensor"}
        np.testing.assert_allclose(limb.optimal_posture["flexor"], [q])


def test_a_slack_length_that_is_given_stays(tmp_path):
    limb = load_limb(write_limb(tmp_path, ({**FLEXOR, "tendon_slack_length": 0.17}, EXTENSOR)))
    assert limb.arm.muscles[0].tendon_slack_length == 0.17
    assert set(limb.optimal_posture) == {"extensor"}


def test_joints_without_limits_are_sampled_over_one_turn(tmp_path):
    skeleton = (WORLD, link("forearm"), hinge("elbow", "base", "forearm", limits=None))
    straight = muscle("flexor", [("base", [0.03, 0, 0.25]), ("forearm", [0.03, 0, -0.05])])
    (path,) = load_arm(write_limb(tmp_path, (straight,), (), skeleton)).muscles[0].path
    np.testing.assert_allclose(path.ranges, [(-np.pi, np.pi)])


def test_fits_of_tiny_limbs_are_as_good(tmp_path):
    def scaled(points):
        return [[body, [1e-3 * x for x in p]] for body, p in points]

    roll = {**ROLL, "radius": 2e-5}
    muscles = [{**m, "points": scaled(m["points"]), "optimal_fiber_length": 1e-4} for m in (FLEXOR, EXTENSOR)]
    limb = load_limb(write_limb(tmp_path, muscles, (roll,)))
    for fit in limb.fitted.values():
        assert fit.moment_arm_error < 2e-3 * fit.largest_moment_arm


def test_a_fit_is_kept_and_a_change_of_the_limb_gives_another(tmp_path, own_cache):
    first = load_arm(write_limb(tmp_path))
    (file,) = own_cache.iterdir()
    assert load_arm(tmp_path).muscles == first.muscles and len(list(own_cache.iterdir())) == 1
    content = file.read_text()
    for damaged in ("", "x", content[:-30], content.replace("0.0", "0.1")):
        file.write_text(damaged)
        assert load_arm(tmp_path).muscles == first.muscles
        assert file.read_text() == content
    load_arm(write_limb(tmp_path, surfaces=({**ROLL, "radius": 0.021},)))
    load_arm(write_limb(tmp_path, skeleton=(WORLD, link("forearm"), hinge("elbow", "base", "forearm", (0, 0, 0.01)))))
    assert len(list(own_cache.iterdir())) == 3


def test_a_cache_that_cannot_be_written_changes_nothing(tmp_path, monkeypatch):
    expected = load_arm(write_limb(tmp_path)).muscles
    (tmp_path / "file").write_text("")
    for folder in (None, tmp_path / "file"):
        monkeypatch.setattr("drakearm.model.fit_cache.cache_folder", lambda folder=folder: folder)
        assert load_arm(tmp_path).muscles == expected


def test_a_path_that_cannot_be_fitted_well_is_a_warning(tmp_path, caplog):
    """Over a sphere the muscle slides to the other side when the line goes through its center."""
    sphere = {"name": "roll", "type": "sphere", "body": "base", "center": [0, 0, 0], "radius": 0.02}
    with caplog.at_level(logging.WARNING, "drakearm"):
        limb = load_limb(write_limb(tmp_path, surfaces=(sphere,)))
    assert not limb.fitted["extensor"].is_good and limb.fitted["flexor"].is_good
    (record,) = caplog.records
    assert "The path of extensor misses its points by up to" in record.getMessage()


def refusal(folder):
    with pytest.raises(ArmError) as error:
        load_arm(folder)
    message = str(error.value)
    assert message.endswith(".") and "more problem" not in message
    return message


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"radius": 0.06}, "muscles.extensor: its point 2 is 23.9 mm inside of the cylinder roll at elbow"),
        ({"radius": None}, "surfaces.roll.radius: found None, expected a number"),
        ({"type": "cone"}, "surfaces.roll.type: found 'cone', expected 'cylinder' or 'sphere'"),
        ({"type": "sphere"}, "surfaces.roll.axis: a sphere has none"),
        ({"axis": None}, "surfaces.roll.axis: is missing, but required of a cylinder"),
        ({"axis": [0, 0, 0]}, "surfaces.roll.axis: found [0, 0, 0], expected a direction"),
        ({"axis": [0, 1]}, "surfaces.roll.axis: found [0, 1], expected three numbers"),
        ({"side": [0, 1, 0]}, "surfaces.roll.side: expected a direction across the axis"),
        ({"body": "bas"}, "there is no body bas, where the surface roll is (did you mean base?)"),
        ({"name": "rol"}, "muscles.extensor.wraps: found 'roll' (did you mean rol?), expected a name in surfaces: rol"),
        ({"colour": 1}, "surfaces.roll.colour: there is no such field"),
    ],
)
def test_a_wrong_surface_is_one_sentence(tmp_path, change, expected):
    assert expected in refusal(write_limb(tmp_path, surfaces=({**ROLL, **change},)))


def without(name):
    return {key: value for key, value in EXTENSOR.items() if key != name}


@pytest.mark.parametrize(
    ("wrong", "expected"),
    [
        (without("max_isometric_force"), "extensor.max_isometric_force: is missing, but required"),
        ({**without("optimal_fiber_length"), "optimal_fibre_length": 0.1}, "did you mean optimal_fiber_length?"),
        ({**EXTENSOR, "tendon_slack_lenght": 0.1}, "did you mean tendon_slack_length?"),
        ({**EXTENSOR, "optimal_fiber_length": 100}, "extensor.optimal_fiber_length: found 100, expected 1e-05 to 10 m"),
        ({**EXTENSOR, "optimal_fiber_length": 0.4}, "optimal fiber takes 400 mm of it: expected a shorter fiber"),
        ({**EXTENSOR, "pennation_angle": 20}, "extensor.pennation_angle: found 20, expected 0 to 1.4 rad"),
        ({**EXTENSOR, "wraps": "roll"}, "extensor.wraps: found 'roll', expected a list"),
        ({**EXTENSOR, "wraps": ["roll", "roll"]}, "extensor.wraps: found 2, expected 1"),
        ({**EXTENSOR, "points": EXTENSOR["points"][:1]}, "extensor.points: found 1, expected at least 2, or a path"),
        (
            {**EXTENSOR, "points": [["base", [0, 0, 0]], ["base", [0, 0, 1]]], "wraps": []},
            "no joint changes the length",
        ),
        ({**EXTENSOR, "points": [["base", [0, 0]], ["forearm", [0, 0, 1]]]}, "points.0: found ['base', [0, 0]], exp"),
        ({**EXTENSOR, "points": [["base", [0, 0, "a"]], ["forearm", [0, 0, 1]]]}, "points.0.1.2: found 'a', expected"),
        ({**EXTENSOR, "points": [["base", [0, 0, 0.1]], ["fore", [0, 0, 1]]]}, "there is no body fore, where extensor"),
        ({**EXTENSOR, "points": [["base", [0, 0, 0.1]], ["forearm", [0, 0, -0.1]]]}, "expected a side of this surface"),
    ],
)
def test_a_wrong_muscle_is_one_sentence(tmp_path, wrong, expected):
    assert expected in refusal(write_limb(tmp_path, (FLEXOR, wrong)))


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"tip": "foream"}, "there is no frame foream, which the arm limb names (did you mean forearm?)"),
        ({"optimal_posture_deg": [1, 2]}, "optimal_posture_deg: found 2, expected 1: one for each of elbow"),
        ({"optimal_posture_deg": 90}, "optimal_posture_deg: found 90, expected a list"),
        ({"skeleton": ELBOW[:1]}, "there is no joint that moves: expected at least one revolute joint"),
        ({"surfaces": [ROLL, ROLL]}, "surfaces: roll is given twice: expected every name once"),
    ],
)
def test_a_wrong_limb_is_one_sentence(tmp_path, fields, expected):
    assert expected in refusal(write_limb(tmp_path, **fields))
