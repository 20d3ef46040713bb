"""Smoothly shaded round shapes for Meshcat."""

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import InMemoryMesh, Mesh

SIDES = 8  # of a cross section
_ACROSS = np.array([0.31, 0.52, 0.79])  # a direction in which paths rarely run
_ANGLE = 2.0 * np.pi * np.arange(SIDES) / SIDES
_CIRCLE = np.stack([np.cos(_ANGLE), np.sin(_ANGLE), np.zeros(SIDES)], axis=1)


def frustum(first: float, last: float, overlap: float) -> Mesh:
    """A tube along z from 0 to 1, with these radii at its ends, beyond which it reaches by the overlap."""
    ends = np.stack([_CIRCLE * first - [0.0, 0.0, overlap], _CIRCLE * last + [0.0, 0.0, 1.0 + overlap]])
    return _smooth(ends, np.stack([_CIRCLE, _CIRCLE]))


def tube(path: np.ndarray, radius: float) -> Mesh | None:
    """A tube of this radius (m) along a path (K, 3), m. None if the path has no length."""
    steps = np.diff(path, axis=0)
    length = np.linalg.norm(steps, axis=1)
    moves = length > 0.0
    if not moves.any():
        return None
    along = steps[moves] / length[moves, None]
    along = np.concatenate([along, along[-1:]])
    first = np.cross(along, _ACROSS)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    axes = np.stack([first, np.cross(along, first), along], axis=1)
    normals = _CIRCLE @ axes
    centers = np.concatenate([path[:1], path[1:][moves]])
    return _smooth(centers[:, None] + radius * normals, normals)


def _smooth(rings: np.ndarray, normals: np.ndarray) -> Mesh:
    """The surface through rings (K, SIDES, 3), m, with a normal at each of their points."""
    k = np.arange(1, SIDES + 1)
    after = k % SIDES + 1
    faces = np.stack([k, after, after + SIDES, k + SIDES], axis=1)
    lines = [f"v {x:.5g} {y:.5g} {z:.5g}" for x, y, z in rings.reshape(-1, 3).tolist()]
    lines += [f"vn {x:.2g} {y:.2g} {z:.2g}" for x, y, z in normals.reshape(-1, 3).tolist()]
    for i in range(len(rings) - 1):
        lines += ["f " + " ".join(f"{n}//{n}" for n in face) for face in (faces + i * SIDES).tolist()]
    return Mesh(InMemoryMesh(mesh_file=MemoryFile("\n".join(lines) + "\n", ".obj", "round")))
