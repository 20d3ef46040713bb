"""The metrics of a run and its success, on recordings whose numbers are known."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from drakearm.errors import ScenarioError
from drakearm.experiments import SuccessCriterion, evaluation_metrics, run_metrics
from drakearm.experiments.success import HandAtGoal, JointError, NoContact
from drakearm.model import MakeTorqueArm, Obstacle
from drakearm.model.recording import Recording
from drakearm.model.skeleton import hand_motion
from tests.recordings import still_recording

BAR = Obstacle(position=(0.3, 0.2, 0.17), radius=0.03)


@pytest.fixture(scope="module")
def followed(task) -> Recording:
    """A run that follows the reference of the task exactly, with activations of 0.5 and 10 W per muscle."""
    q, v = task.reference.q, task.reference.v
    p_WH, v_WH = hand_motion(MakeTorqueArm(task.arm), task.arm, q, v)
    still = still_recording(len(q), 2, 14)
    muscles = np.ones_like(still.activation)
    motion = {"q": q, "v": v, "reference_q": q, "reference_v": v, "p_WH": p_WH, "v_WH": v_WH}
    return replace(still, **motion, activation=0.5 * muscles, metabolic_power=10.0 * muscles)


def off_by(recording: Recording, shoulder: float, elbow: float) -> Recording:
    return replace(recording, q=recording.q + np.array([shoulder, elbow]))


def test_a_run_on_the_reference_has_no_errors(task, followed):
    metrics = run_metrics(task, followed, [JointError(of="largest", below=1e-9), HandAtGoal(within=1e-9)])
    assert metrics["tracking_error_max"] == [0.0, 0.0] and metrics["hand_end_error_cm"] == pytest.approx(0.0, abs=1e-9)
    assert metrics["success"] == {"largest_error": True, "hand_at_goal": True}


def test_effort_is_integrated_over_time_and_summed_over_muscles(task, followed):
    metrics = run_metrics(task, followed, [])
    assert metrics["squared_activation"] == pytest.approx(14 * 0.25 * 0.75)
    assert metrics["metabolic_energy"] == pytest.approx(14 * 10.0 * 0.75)


def test_the_end_of_the_hand_is_measured_from_the_end_of_the_reference(task, followed):
    shift = np.array([0.03, 0.0, 0.04])
    missed = replace(followed, p_WH=followed.p_WH + shift, v_WH=followed.v_WH + shift)
    metrics = run_metrics(task, missed, [HandAtGoal(within=0.049), HandAtGoal(within=0.051)])
    assert metrics["hand_end_error_cm"] == pytest.approx(5.0)
    assert metrics["hand_end_speed"] == pytest.approx(0.05)
    assert HandAtGoal(within=0.051)(task, missed, metrics) and not HandAtGoal(within=0.049)(task, missed, metrics)


@pytest.mark.parametrize(
    ("criterion", "name", "met"),
    [
        (JointError(of="end", below=0.1), "end_error", False),
        (JointError(of="mean", below=0.3), "mean_error", True),
        (JointError(of="end", below=0.1, joints=("elbow",)), "elbow_end_error", True),
        (JointError(of="end", below=0.1, joints=("shoulder", "elbow")), "shoulder_elbow_end_error", False),
    ],
)
def test_a_joint_error_counts_for_the_joints_that_are_named(task, followed, criterion, name, met):
    assert run_metrics(task, off_by(followed, 0.2, 0.05), [criterion])["success"] == {name: met}


def test_clearance_is_measured_between_the_samples_too(task, followed):
    """Every fifth sample is enough, because cubic splines follow the speeds as well."""
    with_bar = replace(task, obstacle=BAR)
    sparse = Recording(**{name: samples[::5] for name, samples in vars(followed).items()})
    metrics, coarse = (run_metrics(with_bar, recording, [NoContact()]) for recording in (followed, sparse))
    assert metrics["clearance_cm"] == min(metrics[f"{part}_clearance_cm"] for part in ("forearm", "wrist", "hand"))
    assert coarse["clearance_cm"] == pytest.approx(metrics["clearance_cm"], abs=0.01)


def test_a_bar_in_the_way_is_touched(task, followed):
    middle = followed.p_WH[len(followed.t) // 2]
    bar = Obstacle(position=tuple(float(x) for x in middle), radius=0.02)
    metrics = run_metrics(replace(task, obstacle=bar), followed, [NoContact()])
    assert metrics["success"] == {"no_contact": False} and metrics["hand_clearance_cm"] < -2.0


@pytest.mark.parametrize(
    ("criterion", "sentence"),
    [
        (NoContact(), "no_contact needs an obstacle"),
        (JointError(of="end", below=0.1, joints=("knee",)), "names the joint knee: expected shoulder, elbow"),
    ],
)
def test_a_criterion_that_does_not_fit_is_refused(task, criterion, sentence):
    with pytest.raises(ScenarioError, match=sentence):
        criterion.check(task)


def test_the_success_rate_is_that_of_the_runs_with_noise(task, followed):
    noisy = [off_by(followed, error, 0.0) for error in (0.05, 0.15, 0.02, 0.3)]
    metrics = evaluation_metrics(task, followed, noisy, [JointError(of="mean", below=0.1)])
    assert metrics["success_rate"] == {"mean_error": 0.5}
    assert np.array(metrics["noisy"]["end_error"])[:, 0].tolist() == pytest.approx([0.05, 0.15, 0.02, 0.3])
    assert metrics["noise_free"]["success"] == {"mean_error": True}


def test_a_criterion_of_a_users_own_is_read_and_used(task, followed):
    @dataclass(frozen=True)
    class Slow(SuccessCriterion):
        type = "slow"
        speed: float  # rad/s

        def __call__(self, task, recording, metrics):
            return bool(np.abs(recording.v).max() < self.speed)

    criterion = SuccessCriterion.read({"type": "slow", "speed": 2.0})
    assert criterion == Slow(2.0)
    assert run_metrics(task, followed, [criterion])["success"] == {"slow": False}
