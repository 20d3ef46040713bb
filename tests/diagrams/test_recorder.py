"""A recorder in a Diagram of the user's own: what it records is what the arm did, and a replay shows it."""

import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

from drakearm import write_replay
from drakearm.diagrams import AddMuscleArm, AddRecorder, MakeSimulator
from drakearm.errors import TaskError
from drakearm.model.reference import Reference

EXCITATION = np.linspace(0.0, 0.3, 14)


@pytest.fixture
def recorded(arm):
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm)
    source = builder.AddSystem(ConstantVectorSource(EXCITATION))
    builder.Connect(source.get_output_port(), muscle_arm.muscles.GetInputPort("excitation"))
    recorder = AddRecorder(builder, muscle_arm)
    simulator = MakeSimulator(builder.Build())
    context = simulator.get_mutable_context()
    muscle_arm.SetState(context, [0.1, 0.9])
    simulator.AdvanceTo(0.2)
    return recorder, context


def test_a_recording_is_what_the_arm_did(arm, recorded, tmp_path):
    recorder, context = recorded
    recording = recorder.Recording(context)
    recording.check(arm)
    np.testing.assert_allclose(recording.t, np.linspace(0.0, 0.2, 21), atol=1e-12)
    np.testing.assert_array_equal(recording.excitation, np.tile(EXCITATION, (21, 1)))
    np.testing.assert_array_equal(recording.q[0], [0.1, 0.9])
    plant = recorder.arm.plant
    end = plant.GetMyContextFromRoot(context)
    np.testing.assert_array_equal(recording.q[-1], plant.GetPositions(end))
    tip = plant.GetFrameByName(arm.tip_frame).CalcPoseInWorld(end).translation()
    np.testing.assert_allclose(recording.p_WH[-1], tip, atol=1e-12)
    np.testing.assert_array_equal(recording.reference_q, recording.q)
    write_replay(tmp_path / "own.html", arm, recording)
    assert "TRIlong" in (tmp_path / "own.html").read_text()


def test_a_recording_has_the_last_samples_of_its_reference(recorded):
    recorder, context = recorded
    samples = np.linspace(0.0, 1.0, 60).reshape(30, 2)
    still = np.zeros((30, 2))
    reference = Reference(0.01 * np.arange(30), samples, still, still, still)
    np.testing.assert_array_equal(recorder.Recording(context, reference).reference_q, samples[9:])
    short = Reference(reference.t[:5], samples[:5], still[:5], still[:5], still[:5])
    with pytest.raises(TaskError, match="The reference has 5 samples of 2 joints: expected 21 or more of 2"):
        recorder.Recording(context, short)


def test_excitations_without_a_source_are_an_error(arm):
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm)
    with pytest.raises(TaskError, match="The input excitation of the muscles is not connected"):
        AddRecorder(builder, muscle_arm)
