"""The skeleton: mass matrix, gravity and Coriolis terms, frames and loads."""

import numpy as np
import pytest
from pydrake.multibody.plant import MultibodyPlant

from drakearm.errors import ArmError
from drakearm.model import MakeTorqueArm
from drakearm.model.skeleton import add_skeleton


def at(plant, q, v=(0.0, 0.0)):
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    plant.SetVelocities(context, v)
    return context


@pytest.mark.parametrize(
    ("elbow_deg", "mass_matrix", "gravity"),
    [
        (0.0, [[0.510803, 0.177893], [0.177893, 0.082105]], [-0.4303, -0.2633]),
        (90.0, [[0.306515, 0.076463], [0.076463, 0.082105]], [-3.4133, -3.276]),
    ],
)
def test_known_dynamics(arm, elbow_deg, mass_matrix, gravity):
    """The expected values are those of OpenSim 4.6."""
    plant = MakeTorqueArm(arm)
    context = at(plant, [0.0, np.deg2rad(elbow_deg)])
    np.testing.assert_allclose(plant.CalcMassMatrix(context), mass_matrix, atol=1e-6)
    np.testing.assert_allclose(plant.CalcGravityGeneralizedForces(context), gravity, atol=1e-4)


def test_dynamics_against_opensim(arm, oracle):
    statics = oracle("statics.npz")
    plant = MakeTorqueArm(arm)
    errors = {"mass matrix": 0.0, "gravity": 0.0, "Coriolis": 0.0, "center of mass of the hand": 0.0}
    for k, q in enumerate(statics["q"]):
        context = at(plant, q, statics["u_random"][k])
        grip = plant.GetFrameByName("grip").CalcPoseInWorld(context).translation()
        for name, ours, theirs in (
            ("mass matrix", plant.CalcMassMatrix(context), statics["mass_matrix"]),
            ("gravity", plant.CalcGravityGeneralizedForces(context), statics["tau_gravity"]),
            ("Coriolis", plant.CalcBiasTerm(context), statics["coriolis_bias"]),
            ("center of mass of the hand", grip, statics["hand_com_ground"]),
        ):
            errors[name] = max(errors[name], np.abs(ours - theirs[k]).max())
    print("largest errors:", errors)
    assert max(errors.values()) < 1e-9


def test_bodies_have_their_opensim_names_and_the_hand_has_its_frames(arm):
    plant = MakeTorqueArm(arm)
    for body in ("base", "r_humerus", "ulna", "radius", "proximal_row", "hand"):
        assert plant.HasBodyNamed(body)
    context = at(plant, [0.4, 1.0])
    wrist = plant.GetFrameByName("hand").CalcPoseInWorld(context)
    tip = plant.GetFrameByName("hand_tip").CalcPoseInWorld(context)
    assert np.linalg.norm(tip.translation() - wrist.translation()) == pytest.approx(0.1)


@pytest.mark.parametrize("mass", [1.0, 20.0])
def test_load_hangs_at_the_grip(arm, mass):
    """The torque that a load adds is its weight times the horizontal distance from grip to joint axis."""
    empty, loaded = MakeTorqueArm(arm), MakeTorqueArm(arm, load_mass=mass)
    q = [0.2, 1.3]
    context = at(empty, q)
    grip = empty.GetFrameByName("grip")
    jacobian = empty.CalcJacobianPositionVector(
        context, grip, np.zeros((3, 1)), empty.world_frame(), empty.world_frame()
    )
    added = loaded.CalcGravityGeneralizedForces(at(loaded, q)) - empty.CalcGravityGeneralizedForces(context)
    np.testing.assert_allclose(added, jacobian.T @ [0.0, -9.8066 * mass, 0.0], atol=1e-9)


@pytest.mark.parametrize("mass", [-1.0, np.nan, np.inf])
def test_impossible_load_is_refused(arm, mass):
    with pytest.raises(ArmError, match="load"):
        MakeTorqueArm(arm, load_mass=mass)


def test_skeleton_without_the_arms_joints_is_refused(arm, tmp_path):
    urdf = arm.skeleton.read_text().replace('"elbow" type="revolute"', '"knee" type="revolute"')
    (tmp_path / "skeleton.urdf").write_text(urdf.replace('<joint name="elbow"/>', '<joint name="knee"/>'))
    object_with = type(arm)(**{**arm_fields(arm), "skeleton": tmp_path / "skeleton.urdf"})
    with pytest.raises(ArmError, match=r"shoulder, knee.*expected.*shoulder, elbow"):
        add_skeleton(MultibodyPlant(0.0), object_with)


def test_unknown_frame_is_refused(arm):
    with pytest.raises(ArmError, match="fingertip"):
        add_skeleton(MultibodyPlant(0.0), type(arm)(**{**arm_fields(arm), "tip_frame": "fingertip"}))


def arm_fields(arm):
    return {name: getattr(arm, name) for name in arm.__dataclass_fields__}
