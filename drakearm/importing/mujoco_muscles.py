"""The numbers of MuJoCo's muscles, as drakearm's muscles have them: rigid tendons, and the nearest of Thelen's curves.

MuJoCo's curves are quadratic splines (documentation, "Muscles"). Thelen's (2003) are made equal to them in the area
under the active force-length curve, in the length at which the passive force is max_isometric_force, in the force at
half the largest speed of shortening, (1 - 0.5)^2, and in the largest eccentric force.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

from scipy.optimize import brentq

from drakearm.importing.source import SourceMuscle
from drakearm.importing.tissue import ASSUMED

_SHORTEST_TENDON = 1e-3  # m: MuJoCo's muscles may have none, or even negative lengths
_HALF_SPEED_SHAPE = 0.5  # of Thelen's force-velocity curve, with 0.25 at half the largest speed


def read_muscles(
    mujoco: Any, loaded: Any, data: Any, actuators: Mapping[str, int], body_name: Callable[[int], str]
) -> tuple[tuple[SourceMuscle, ...], list[str]]:
    """The muscles of a model at its present posture, and what is left out of its actuators, in words."""
    muscles, others, without_tendon = [], [], []
    for name, i in actuators.items():
        if loaded.actuator_gaintype[i] != mujoco.mjtGain.mjGAIN_MUSCLE:
            others.append(name)
        elif loaded.actuator_trntype[i] != mujoco.mjtTrn.mjTRN_TENDON:
            without_tendon.append(name)
        else:
            tendon = loaded.actuator_trnid[i, 0]
            points, bodies = _path(mujoco, loaded, tendon, body_name)
            fields, extra, notes = _fields(mujoco, loaded, i)
            muscles.append(SourceMuscle(name, fields, points, bodies, notes, extra))
    lost = {"actuators that are no muscles": others, "muscles that pull on no tendon": without_tendon}
    return tuple(muscles), [f"{what}: {', '.join(names)}" for what, names in lost.items() if names]


def _fields(mujoco: Any, loaded: Any, i: int) -> tuple[dict[str, Any], float, tuple[str, ...]]:
    """Fields, extra length, and what is not kept. MuJoCo's mju_muscleGain and mju_muscleBias define its numbers."""
    gain, bias = loaded.actuator_gainprm[i, :9].copy(), loaded.actuator_biasprm[i, :9].copy()
    lowest, highest, force, scale, shortest, longest, speed, _, eccentric = gain
    shortest_length, longest_length = loaded.actuator_lengthrange[i]
    if force < 0.0:
        force = scale / max(loaded.actuator_acc0[i], 1e-15)
    optimal = (longest_length - shortest_length) / (highest - lowest)
    slack = shortest_length - lowest * optimal

    def passive(length: float) -> float:
        """The passive force at a length over the optimal one, less the largest active force."""
        total = slack + length * optimal
        tension = mujoco.mju_muscleBias(total, loaded.actuator_lengthrange[i], loaded.actuator_acc0[i], bias)
        return -tension / force - 1.0

    extra = max(0.0, _SHORTEST_TENDON - slack)
    stiff = passive(4.0) > 0.0
    fields = {
        **ASSUMED,
        "max_isometric_force": float(force),
        "optimal_fiber_length": float(optimal),
        "tendon_slack_length": float(slack + extra),
        "pennation_angle": 0.0,
        "max_contraction_velocity": float(speed),
        "activation_time": float(loaded.actuator_dynprm[i, 0]),
        "deactivation_time": float(loaded.actuator_dynprm[i, 1]),
        "active_width": float((0.5 * (longest - shortest)) ** 2 / math.pi),  # area: half of the range, sqrt(pi width)
        "force_velocity_shape": _HALF_SPEED_SHAPE,
        "eccentric_force": float(max(eccentric, 1.1)),
        "passive_strain": float(brentq(passive, 1.0, 4.0) - 1.0) if stiff else ASSUMED["passive_strain"],
        "model": "thelen2003",
        "tendon": "rigid",
    }
    notes = ["the curves of MuJoCo: thelen2003 with similar ones is used"]
    if extra > 0.0:
        notes.append(
            f"a tendon of {1e3 * slack:.3g} mm: tendon and path are longer by {1e3 * extra:.3g} mm, fibers not"
        )
    if loaded.actuator_dynprm[i, 2] != 0.0:
        notes.append(f"the smoothing of activation, tausmooth {loaded.actuator_dynprm[i, 2]:g}")
    return fields, float(extra), tuple(notes)


def _path(
    mujoco: Any, loaded: Any, tendon: int, body_name: Callable[[int], str]
) -> tuple[tuple[tuple[str, tuple[float, ...]], ...], frozenset[str]]:
    """The sites of a tendon, and all bodies that it touches. A tendon with a pulley has the sites of all branches."""
    points, bodies = [], set()
    wraps = mujoco.mjtWrap
    for k in range(loaded.tendon_adr[tendon], loaded.tendon_adr[tendon] + loaded.tendon_num[tendon]):
        kind, item = loaded.wrap_type[k], loaded.wrap_objid[k]
        if kind == wraps.mjWRAP_SITE:
            body = body_name(loaded.site_bodyid[item])
            points.append((body, tuple(loaded.site_pos[item].tolist())))
            bodies.add(body)
        elif kind in (wraps.mjWRAP_SPHERE, wraps.mjWRAP_CYLINDER):
            bodies.add(body_name(loaded.geom_bodyid[item]))
        elif kind == wraps.mjWRAP_JOINT:
            bodies.add(body_name(loaded.jnt_bodyid[item]))
    return tuple(points), frozenset(bodies)
