"""Records an arm in any Diagram: what `write_replay`, figures and exports show."""

from dataclasses import dataclass

import numpy as np
from pydrake.systems.framework import Context, DiagramBuilder, InputPort, OutputPort
from pydrake.systems.primitives import LogVectorOutput, VectorLogSink

from drakearm.diagrams.connections import source_of
from drakearm.diagrams.muscle_arm import MuscleArm
from drakearm.errors import TaskError
from drakearm.model.recording import Recording
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.model.skeleton import hand_motion, skeleton_plant

_OF_MUSCLES = (  # outputs of HillMuscles that are recorded
    "activation",
    "fiber_length",
    "fiber_velocity",
    "tendon_force",
    "mtu_length",
    "joint_moment",
    "fiber_power",
    "tendon_power",
    "metabolic_power",
)


@dataclass(frozen=True)
class Recorder:
    """The logs of an arm, which have one sample per control step."""

    arm: MuscleArm
    logs: dict[str, VectorLogSink]

    def Recording(self, root_context: Context, reference: Reference | None = None) -> Recording:
        """What has been recorded since the start of the simulation.

        reference: what the arm follows; the recording begins with its last samples if it is longer. Without one, the
        arm counts as its own reference. Raises TaskError if the reference is shorter than the recording, or has other
        joints.
        """
        arm, logs = self.arm.arm, {name: log.FindLog(root_context) for name, log in self.logs.items()}
        data = {name: log.data().T.copy() for name, log in logs.items()}
        t = logs["arm_state"].sample_times().copy()
        q, v = np.split(data.pop("arm_state"), 2, axis=1)
        p_WH, v_WH = hand_motion(skeleton_plant(arm), arm, q, v)
        return Recording(
            t=t,
            q=q,
            v=v,
            reference_q=q if reference is None else _last(reference.q, q),
            reference_v=v if reference is None else _last(reference.v, v),
            joint_moment=data.pop("joint_moment").reshape(len(t), len(arm.muscles), len(arm.coordinates)),
            p_WH=p_WH,
            v_WH=v_WH,
            reward=data.pop("reward", np.zeros((len(t), 1)))[:, 0],
            **data,
        )


def AddRecorder(
    builder: DiagramBuilder, arm: MuscleArm, *, excitation: OutputPort | None = None, reward: OutputPort | None = None
) -> Recorder:
    """Adds logs of an arm to a builder, before the Diagram is built. `Recorder.Recording` reads them afterwards.

    excitation: what counts as the excitations; if None, it is what the muscles' input is connected to. reward: if None,
    it is 0. Raises TaskError if the excitations of the muscles are not connected to a port.
    """
    ports = {
        "arm_state": _source(builder, arm.muscles.GetInputPort("arm_state")),
        "excitation": excitation or _source(builder, arm.muscles.GetInputPort("excitation")),
    } | {name: arm.muscles.GetOutputPort(name) for name in _OF_MUSCLES}
    if reward is not None:
        ports["reward"] = reward
    return Recorder(arm, {name: LogVectorOutput(port, builder, CONTROL_STEP) for name, port in ports.items()})


def _source(builder: DiagramBuilder, port: InputPort) -> OutputPort:
    source = source_of(builder, port)
    if source is None:
        raise TaskError(
            f"The input {port.get_name()} of the muscles is not connected: expected a source that can be recorded."
        )
    return source


def _last(reference: np.ndarray, recorded: np.ndarray) -> np.ndarray:
    """The last samples of a reference, as many as were recorded."""
    if len(reference) < len(recorded) or reference.shape[1] != recorded.shape[1]:
        raise TaskError(
            f"The reference has {len(reference)} samples of {reference.shape[1]} joints: expected {len(recorded)} or "
            f"more of {recorded.shape[1]}, as the recording has."
        )
    return reference[len(reference) - len(recorded) :]
