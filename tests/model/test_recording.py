"""What a closed loop records: its quantities agree with each other as mechanics says."""

import numpy as np
import pytest

from drakearm.diagrams import MakePolicyLoop
from drakearm.model import MakeTorqueArm
from drakearm.model.recording import Recording


@pytest.fixture(scope="module")
def recording(task) -> Recording:
    flexors = np.array([0.1 if name in ("BIClong", "BRA") else 0.02 for name in task.arm.muscle_names])
    return MakePolicyLoop(task, lambda _: flexors).Run()


def rate(samples: np.ndarray, t: np.ndarray) -> np.ndarray:
    return np.gradient(samples, t, axis=0)[1:-1]


def test_the_hand_is_where_the_joints_bring_it(recording, arm):
    plant = MakeTorqueArm(arm)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, recording.q[-1])
    tip = plant.GetFrameByName(arm.tip_frame).CalcPoseInWorld(context).translation()
    np.testing.assert_allclose(recording.p_WH[-1], tip, atol=1e-12)
    np.testing.assert_allclose(rate(recording.p_WH, recording.t), recording.v_WH[1:-1], atol=0.02)
    assert recording.hand_speed.max() > 0.5


def test_muscles_deliver_the_power_with_which_their_paths_shorten(recording):
    delivered = (recording.fiber_power + recording.tendon_power)[1:-1]
    expected = -recording.tendon_force[1:-1] * rate(recording.mtu_length, recording.t)
    np.testing.assert_allclose(delivered, expected, atol=0.02 * np.abs(expected).max())


def test_muscles_deliver_the_power_that_their_torques_do_on_the_joints(recording):
    on_joints = (recording.muscle_torque * recording.v).sum(axis=1)
    delivered = (recording.fiber_power + recording.tendon_power).sum(axis=1)
    np.testing.assert_allclose(on_joints, delivered, atol=1e-3 * np.abs(delivered).max())
