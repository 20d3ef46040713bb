"""The signals: everything about an arm and its reference that senses and rewards can read."""

from collections.abc import Iterable

from drakearm.errors import TaskError
from drakearm.model.arm import Arm

SIGNALS = {
    "arm_state": "q and v of the joints (2 n_q), rad and rad/s",
    "arm_acceleration": "of the joints (n_q), rad/s^2; for rewards only, as it exists after the first step",
    "reference": "desired q and v at this moment (2 n_q), rad and rad/s",
    "preview_q": "desired q at each time of the task's lookahead (n_q len(lookahead)), rad",
    "preview_v": "desired v at the same times (n_q len(lookahead)), rad/s",
    "excitation": "that was held until this moment (n); 0 at the start",
    "activation": "(n), 0..1",
    "fiber_length": "(n), m",
    "fiber_velocity": "(n), m/s",
    "tendon_force": "(n), N",
}


def signal_size(name: str, arm: Arm, lookahead: tuple[int, ...]) -> int:
    """How many numbers a signal has, for n muscles and n_q coordinates."""
    n, n_q = len(arm.muscles), len(arm.coordinates)
    of_joints = {
        "arm_state": 2 * n_q,
        "arm_acceleration": n_q,
        "reference": 2 * n_q,
        "preview_q": n_q * len(lookahead),
        "preview_v": n_q * len(lookahead),
    }
    return of_joints.get(name, n)


def check_signals(what: str, reads: Iterable[str], *, of_sense: bool = False) -> None:
    """Raises TaskError where `what`, a sense or a reward, reads a signal that it cannot have."""
    known = [name for name in SIGNALS if not (of_sense and name == "arm_acceleration")]
    for name in reads:
        if name not in known:
            raise TaskError(f"{what} reads the signal {name!r}: expected some of {', '.join(known)}.")
