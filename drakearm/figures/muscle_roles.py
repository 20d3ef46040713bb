"""What an arm's muscles do: which joints they cross, and where they pull them. Pictures order muscles by it."""

from dataclasses import dataclass

import numpy as np

from drakearm.model import Arm
from drakearm.model.inspection import joint_ranges
from drakearm.model.musculature import muscle_geometry

ROLES = "↑ pulls the joint's angle up, ↓ down, ↕ both, by the angle"
_SAMPLES = 91  # in the range of a joint
_ONE_WAY = 1.0 / 3.0  # of the mean moment arm over its mean absolute value: twice as much one way as the other
_ARROWS = {1: "↑", 0: "↕", -1: "↓"}


@dataclass(frozen=True)
class Role:
    """What some muscles have in common. muscles: their places in the arm.

    pulls: the joints that they cross, each with 1 if they pull its angle up, -1 if they pull it down, and 0 if this
    depends on the angle.
    """

    pulls: dict[str, int]
    muscles: tuple[int, ...]

    @property
    def label(self) -> str:
        return " ".join(f"{joint} {_ARROWS[pull]}" for joint, pull in self.pulls.items())


def muscle_roles(arm: Arm) -> list[Role]:
    """All roles of an arm's muscles, in the order of the joints: each muscle is in one.

    Muscles of two joints are between those of the one and those of the other. Of muscles with the same joints, those
    that pull the angle up come first, and those that pull it down last.
    """
    ranges = joint_ranges(arm).values()
    shares = np.linspace(0.0, 1.0, _SAMPLES)
    # All joints move at once: of most muscles the moment arm at a joint depends on the angle of this joint alone.
    angles = np.column_stack([r.lower + shares * (r.upper - r.lower) for r in ranges])
    arms = np.array([muscle_geometry(q, arm.muscle_table, arm.path_table)[1] for q in angles])
    mean, size = arms.mean(axis=0), np.abs(arms).mean(axis=0)
    pulls = np.where(np.abs(mean) > _ONE_WAY * size, np.sign(mean), 0.0).astype(int)

    found: dict[tuple[tuple[int, int], ...], list[int]] = {}
    for i, muscle in enumerate(arm.muscles):
        crossed = {name for term in muscle.path for name in term.coordinates}
        role = tuple((j, int(pulls[i, j])) for j, name in enumerate(arm.coordinates) if name in crossed)
        found.setdefault(role, []).append(i)
    return [
        Role({arm.coordinates[j]: pull for j, pull in role}, tuple(found[role])) for role in sorted(found, key=_place)
    ]


def _place(role: tuple[tuple[int, int], ...]) -> tuple[float, list[int], list[int]]:
    """Sorts by the middle of the joints, then by the joints, then by the pulls, that of the last joint first."""
    joints = [j for j, _ in role]
    middle = 0.5 * (joints[0] + joints[-1]) if joints else np.inf
    return middle, joints, [-pull for _, pull in reversed(role)]
