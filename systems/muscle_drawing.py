"""The muscles of an arm as bodies in Meshcat: pale tendons, and bellies that are colored by their activation."""

import math
from typing import NamedTuple

import numpy as np
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.geometry import Meshcat, Rgba
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant

from drakearm.model import Arm
from drakearm.systems.muscle_path import MusclePaths
from drakearm.systems.smooth_mesh import frustum

TENDON_COLOR = Rgba(0.93, 0.90, 0.82, 1.0)
_BELLY_PIECES, _TENDON_PIECES = 7, 2  # per muscle, and per muscle and end
# Where the pieces begin and end: 0 to 1 is the first tendon, 1 to 2 the belly, 2 to 3 the second tendon.
_SHARES = np.concatenate(
    [
        np.linspace(0.0, 1.0, _TENDON_PIECES, endpoint=False),
        np.linspace(1.0, 2.0, _BELLY_PIECES, endpoint=False),
        np.linspace(2.0, 3.0, _TENDON_PIECES + 1),
    ]
)
_THICKNESS = 6.0e-4  # m / sqrt(N): radius of a belly at its optimal length over the square root of max_isometric_force
_LEAST_BELLY = 0.5  # optimal fiber lengths
_TENDON = 0.25  # radius of a tendon over that of the belly's middle
_OVERLAP = 0.04  # by which a piece is longer than its part of the path, so that bends have no gaps
_VISIBLE = 0.004  # change of a color channel
_SHORTEST = 1e-6  # m: a drawn length of 0 would have no normals
_RAMP = np.array(  # from slate at rest to red: even steps of lightness and hue in the Oklab space
    [
        [0.60, 0.67, 0.76],
        [0.67, 0.59, 0.64],
        [0.72, 0.50, 0.52],
        [0.76, 0.40, 0.40],
        [0.78, 0.27, 0.27],
        [0.80, 0.04, 0.10],
    ]
)


def activation_color(activation: np.ndarray) -> np.ndarray:
    """The colors (..., 3), sRGB in 0..1, of activations (...): slate at 0, red at 1."""
    at = np.linspace(0.0, 1.0, len(_RAMP))
    return np.stack([np.interp(activation, at, channel) for channel in _RAMP.T], axis=-1)


def segment_pose(start: np.ndarray, end: np.ndarray) -> tuple[RigidTransform, float]:
    """The pose of a straight piece of a muscle between two points (3,), m, and the length of the piece, m.

    The origin is at start, and z points to end. If the two points coincide, the axes are those of the parent frame.
    """
    along = end - start
    length = float(np.linalg.norm(along))
    if length == 0.0:
        return RigidTransform(start), 0.0
    return RigidTransform(RotationMatrix.MakeFromOneVector(along, 2), start), length


def upright(arm: Arm) -> RigidTransform:
    """The transform that turns the arm's world upright in Meshcat, whose z axis points up.

    Use it as in `meshcat.SetTransform("/drake", upright(arm))`. Without gravity it is the identity.
    """
    gravity = np.array(arm.gravity)
    if not gravity.any():
        return RigidTransform()
    up = -gravity / np.linalg.norm(gravity)
    axis = np.cross(up, [0.0, 0.0, 1.0])
    if not axis.any():
        axis = np.array([1.0, 0.0, 0.0])
    angle = math.acos(np.clip(up[2], -1.0, 1.0))
    return RigidTransform(AngleAxis(angle, axis / np.linalg.norm(axis)), np.zeros(3))


class _Drawn(NamedTuple):
    """A muscle's pieces, tendon, belly and tendon in order, and what their shapes depend on."""

    pieces: list[str]
    tendon: float  # m, slack length of both tendons together
    optimal: float  # m, length of the fibers at which the belly has its radius
    radius: float  # m


class MuscleDrawing:
    """The muscles of an arm in Meshcat, which `draw` moves with the arm's bodies.

    A muscle follows a smooth path through its points (see `MusclePaths`). Half of the tendon is at each of its ends,
    with the slack length of the tendon; the rest is the belly. A belly becomes thicker as it becomes shorter, so that
    its volume stays, and its cross section is proportional to max_isometric_force. The pieces are at
    `<path>/<muscle>/<number>`.
    """

    def __init__(self, meshcat: Meshcat, path: str, arm: Arm, plant: MultibodyPlant, repeat: int = 1):
        """plant: a finalized plant with the arm's skeleton.

        repeat: after how many draws colors are sent again that have not changed visibly. A recording interpolates
        between the colors that it gets, so it needs 1.
        """
        self._meshcat, self._repeat = meshcat, repeat
        self._paths = MusclePaths(plant, arm)
        self._muscles: list[_Drawn] = []
        self._draws, self._shown = 0, np.full((len(arm.muscles), 3), np.inf)  # the colors that the page has
        for muscle in arm.muscles:
            pieces = [f"{path}/{muscle.name}/{k}" for k in range(_BELLY_PIECES + 2 * _TENDON_PIECES)]
            for k, piece in enumerate(pieces):
                j = k - _TENDON_PIECES
                belly = 0 <= j < _BELLY_PIECES
                ends = _profile(np.array([j, j + 1]) / _BELLY_PIECES) if belly else np.full(2, _TENDON)
                color = Rgba(*_RAMP[0]) if belly else TENDON_COLOR
                meshcat.SetObject(f"{piece}/shape/surface", frustum(ends[0], ends[1], _OVERLAP), color)
            self._muscles.append(
                _Drawn(
                    pieces,
                    muscle.tendon_slack_length,
                    muscle.optimal_fiber_length,
                    _THICKNESS * math.sqrt(muscle.max_isometric_force),
                )
            )

    def draw(
        self,
        X_WB: list[RigidTransform],
        activation: np.ndarray,
        time_in_recording: float | None = None,
    ) -> None:
        """Moves the muscles to the body poses X_WB and colors them by activation (n,).

        X_WB: in the order of BodyIndex. time_in_recording: time (s) of this frame in Meshcat's recording, if there is
        one.
        """
        colors = _linear(activation_color(activation))
        changed = (np.abs(colors - self._shown).max(axis=1) > _VISIBLE) | (self._draws % self._repeat == 0)
        self._shown[changed] = colors[changed]
        self._draws += 1
        for muscle, path, color, new in zip(self._muscles, self._paths(X_WB), colors, changed.tolist(), strict=True):
            ends, thickness = _cut(path, muscle)
            for k, piece in enumerate(muscle.pieces):
                belly = 0 <= k - _TENDON_PIECES < _BELLY_PIECES
                radius = muscle.radius * (thickness if belly else 1.0)
                paint = color if belly and new else None
                self._draw_piece(piece, ends[k], ends[k + 1], radius, paint, time_in_recording)

    def _draw_piece(
        self,
        piece: str,
        start: np.ndarray,
        end: np.ndarray,
        radius: float,
        color: np.ndarray | None,
        time: float | None,
    ) -> None:
        pose, length = segment_pose(start, end)
        self._meshcat.SetTransform(piece, pose, time)
        # Meshcat forgets the scale of a node when it sets its transform, so the shape has a node of its own.
        self._meshcat.SetProperty(f"{piece}/shape", "scale", [radius, radius, max(length, _SHORTEST)], time)
        for channel, value in zip("rgb", () if color is None else color, strict=color is not None):
            # Meshcat has several names for the color of a shape. This one works in a live scene and in a recording.
            name = f"material.color[{channel}]"
            self._meshcat.SetProperty(f"{piece}/shape/surface/<object>", name, float(value), time)


def _cut(path: np.ndarray, muscle: _Drawn) -> tuple[np.ndarray, float]:
    """The ends (pieces + 1, 3), m, of a muscle's pieces on its path (K, 3), and how much thicker its belly is."""
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1)))
    total = max(float(along[-1]), _SHORTEST)
    # A path may be too short for the tendon, in an impossible posture or where the points do not fit the path function.
    belly = min(max(total - muscle.tendon, _LEAST_BELLY * muscle.optimal), total)
    first, last = 0.5 * (total - belly), 0.5 * (total + belly)
    at = np.interp(_SHARES, (0.0, 1.0, 2.0, 3.0), (0.0, first, last, total))
    ends = np.stack([np.interp(at, along, axis) for axis in path.T], axis=-1)
    return ends, math.sqrt(muscle.optimal / belly)


def _profile(share: np.ndarray) -> np.ndarray:
    """The radius of a belly over that of its middle, at shares of its length from 0 to 1."""
    return _TENDON + (1.0 - _TENDON) * np.sin(np.pi * share) ** 0.8


def _linear(srgb: np.ndarray) -> np.ndarray:
    """Converts sRGB to linear light, which Meshcat's color properties expect (IEC 61966-2-1)."""
    return np.where(srgb > 0.04045, ((srgb + 0.055) / 1.055) ** 2.4, srgb / 12.92)
