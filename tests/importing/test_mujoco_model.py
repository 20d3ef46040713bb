"""A limb that is imported from MuJoCo moves, weighs and pulls as it does there."""

import numpy as np
import pytest

from drakearm.importing.mujoco_model import MujocoProgram
from drakearm.model.skeleton import skeleton_plant
from tests.importing.limbs import HERE, assert_bodies_are_in_place, changed, geometry, imported, postures, refusal

mujoco = pytest.importorskip("mujoco")

LEG = HERE / "leg.xml"


@pytest.fixture(scope="module")
def leg(tmp_path_factory):
    return imported(LEG, tmp_path_factory.mktemp("leg") / "leg")


def test_every_body_is_where_mujoco_has_it(leg):
    assert_bodies_are_in_place(*leg, MujocoProgram(LEG))


def test_accelerations_are_those_of_mujoco(leg):
    """Without muscles and joint damping, in motion: masses, inertias, axes and gravity are the same."""
    limb, arm = leg
    model = mujoco.MjModel.from_xml_path(str(LEG))
    model.dof_damping[:] = 0.0
    model.opt.disableflags = mujoco.mjtDisableBit.mjDSBL_ACTUATION | mujoco.mjtDisableBit.mjDSBL_LIMIT
    data = mujoco.MjData(model)
    plant = skeleton_plant(arm)
    context = plant.CreateDefaultContext()
    for q in postures(limb):
        v = 3.0 * np.sin(10.0 * q)
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(model, data)
        plant.SetPositionsAndVelocities(context, np.concatenate([q, v]))
        ours = plant.EvalTimeDerivatives(context).CopyToVector()[len(q) :]
        np.testing.assert_allclose(ours, data.qacc, rtol=1e-8, atol=1e-6)


def test_lengths_and_moment_arms_are_those_of_mujoco(leg):
    limb, arm = leg
    q = postures(limb, 50)
    length, arms = MujocoProgram(LEG).sampler(arm.muscle_names, arm.coordinates)(q)
    ours = geometry(arm, q)
    np.testing.assert_allclose(ours[0], length, atol=1e-5)
    np.testing.assert_allclose(ours[1], arms, atol=1e-4)
    assert np.median(np.abs(ours[1] - arms)) < 1e-5


def test_rigid_tendons_give_the_fiber_lengths_of_mujoco(leg):
    """MuJoCo maps a range of tendon lengths to one of fiber lengths over the optimal one."""
    vasti, rectus = leg[1].muscles
    assert (vasti.tendon, vasti.max_isometric_force, vasti.pennation_angle) == ("rigid", 2000.0, 0.0)
    for muscle, lengths, fibers in ((vasti, (0.2, 0.3), (0.7, 1.1)), (rectus, (0.4, 0.6), (0.6, 1.1))):
        for length, fiber in zip(lengths, fibers, strict=True):
            ours = (length - muscle.tendon_slack_length) / muscle.optimal_fiber_length
            assert ours == pytest.approx(fiber)
    assert (vasti.activation_time, vasti.deactivation_time) == (0.012, 0.05)
    assert (vasti.max_contraction_velocity, vasti.eccentric_force) == (1.5, 1.2)


def test_a_tendon_of_negative_length_is_made_longer_and_the_fibers_are_not(leg, tmp_path):
    file = changed(
        tmp_path, "leg.xml", ('lengthrange="0.2 0.3" range="0.7 1.1"', 'lengthrange="0.2 0.3" range="0.9 1.1"')
    )
    limb, arm = imported(file, tmp_path / "longer")
    vasti = arm.muscles[0]
    assert vasti.tendon_slack_length == pytest.approx(1e-3)
    q = np.array([[0.0, 0.0, 0.5]])
    before, after = (geometry(a, q)[0][0, 0] for a in (leg[1], arm))
    fiber = 0.9 + (before - 0.2) / 0.5
    assert (after - vasti.tendon_slack_length) / vasti.optimal_fiber_length == pytest.approx(fiber, abs=1e-5)
    assert any("a tendon of -250 mm" in note for note in limb.muscles[0].notes)


def test_what_is_not_kept_is_said(leg):
    report = (leg[1].skeleton.parent / "report.md").read_text()
    for sentence in (
        "left out: damping of joints, up to 0.2",
        "left out: actuators that are no muscles: motor",
        "all muscles: the curves of MuJoCo: thelen2003 with similar ones is used",
        "loads hang at the mass center of body3",
    ):
        assert sentence in report
    assert "Everyone may use it" in (leg[1].skeleton.parent / "CREDITS.md").read_text()


@pytest.mark.parametrize(
    "joint, expected",
    [
        ('<joint name="knee" type="slide" axis="0 1 0"', "a translation: knee."),
        ('<joint name="knee" type="ball"', "a ball joint: knee."),
    ],
)
def test_joints_that_are_no_hinges_are_named(joint, expected, tmp_path):
    ranges = ' range="-5 100" limited="true" ref="10"'
    new = joint + (' range="0 90" limited="true"' if "ball" in joint else ranges)
    file = changed(tmp_path, "leg.xml", ('<joint name="knee" axis="0 1 0"' + ranges, new))
    assert expected in refusal(file)
    ball = '<body name="ball"><freejoint name="loose"/><geom size="0.1"/></body>'
    assert "a free joint: loose." in refusal(changed(tmp_path, "leg.xml", ("<worldbody>", f"<worldbody>{ball}")))


def test_a_coupled_joint_is_named_or_locked(tmp_path):
    file = changed(
        tmp_path, "leg.xml", ("  <actuator>", '<equality><joint joint1="knee" joint2="hip"/></equality><actuator>')
    )
    assert "knee follows hip" in refusal(file)
    _, arm = imported(file, tmp_path / "locked", locks={"knee": 20.0, "adduction": 0.0})
    assert arm.coordinates == ("hip",) and arm.muscle_names == ("rectus",)


def test_damaged_files_are_refused_in_one_sentence(tmp_path):
    file = tmp_path / "damaged.xml"
    for text in ("", "<a/>", LEG.read_text()[:500]):
        file.write_text(text)
        assert "refused by MuJoCo" in refusal(file)
    assert "cannot be frozen" in refusal(LEG, frozen={"knee": 0.0})
