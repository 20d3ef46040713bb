"""The signals: the quantities of an arm and its reference that senses and rewards can read."""

import math
from collections.abc import Iterable

from drakearm.errors import TaskError, listed
from drakearm.model.arm import Arm
from drakearm.model.reference import CONTROL_STEP

RECENT = 4  # control steps: as old as what people sense of their arms
MEMORY = 0.25  # s, time constant with which the accumulated error is forgotten
REMEMBERED = math.exp(-CONTROL_STEP / MEMORY)  # share of the accumulated error, per control step
SIGNALS = {  # meaning, size and unit, for n muscles and n_q coordinates
    "arm_state": "q and v of the joints (2 n_q), rad and rad/s",
    "arm_acceleration": "acceleration of the joints (n_q), rad/s^2; only for rewards, because the start has none",
    "reference": "desired q and v now (2 n_q), rad and rad/s",
    "tracking_error": "desired q and v minus q and v of the joints (2 n_q), rad and rad/s",
    "accumulated_error": "integral of the error of q since the start (n_q), rad s; forgotten within about MEMORY",
    "preview_q": "desired q at each time of the task's lookahead (n_q len(lookahead)), rad",
    "preview_v": "desired v at the same times (n_q len(lookahead)), rad/s",
    "excitation": "excitations during the last control step (n), 0 at the start",
    "recent_excitation": "excitations of the last RECENT control steps (n RECENT), the latest first, 0 at the start",
    "activation": "activations (n), 0 to 1",
    "fiber_length": "lengths of the muscle fibers (n), m",
    "fiber_velocity": "velocities of the muscle fibers (n), m/s, positive if the fiber lengthens",
    "tendon_force": "forces of the tendons (n), N",
    "metabolic_power": "heat and work of the muscles (n), W, with the excitations of the last control step",
    "load_mass": "mass in the hand in this episode (1), kg",
    "strength": "factors of the maximum isometric forces in this episode (n)",
}
# What nerves report, with a delay.
OF_BODY = (
    "arm_state",
    "tracking_error",
    "accumulated_error",
    "activation",
    "fiber_length",
    "fiber_velocity",
    "tendon_force",
)


def signal_size(name: str, arm: Arm, lookahead: tuple[int, ...]) -> int:
    """How many numbers a signal has. lookahead: of the task, in control steps."""
    n, n_q = len(arm.muscles), len(arm.coordinates)
    sizes = {
        "arm_state": 2 * n_q,
        "arm_acceleration": n_q,
        "reference": 2 * n_q,
        "tracking_error": 2 * n_q,
        "accumulated_error": n_q,
        "preview_q": n_q * len(lookahead),
        "preview_v": n_q * len(lookahead),
        "recent_excitation": n * RECENT,
        "load_mass": 1,
    }
    return sizes.get(name, n)


def check_signals(what: str, reads: Iterable[str], *, of_sense: bool = False) -> None:
    """Raises TaskError if a sense or reward, which `what` names in the message, reads a signal that it cannot read."""
    known = [name for name in SIGNALS if not (of_sense and name == "arm_acceleration")]
    for name in reads:
        if name not in known:
            raise TaskError(f"{what} reads the signal {name!r}: expected one of {listed(known, 200)}.")
