"""Smooth closed surfaces from simple shapes that are blended into each other, for `make_meshes.py`.

A shape is a function of points (N, 3), m: negative inside, positive outside, and near its surface about the distance
from it, m.
"""

from collections.abc import Callable, Sequence
from itertools import combinations, product
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.interpolate import make_interp_spline

Shape = Callable[[np.ndarray], np.ndarray]
_STEP = 1e-5  # m, of the gradient's differences
_PROJECTIONS = 4
_LATITUDE = np.radians(52.0)
_CORNERS = np.array(list(product((0, 1), repeat=3)))


class Mesh(NamedTuple):
    """A closed surface: vertices (V, 3), m, their normals (V, 3), of length 1 and outwards, and faces (F, 4).

    A face lists its vertices counterclockwise from outside. A triangle repeats its last one.
    """

    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray


def tube(
    points: Sequence[Sequence[float]], radii: Sequence[float], squeeze: Sequence[float] = (1.0, 1.0, 1.0)
) -> Shape:
    """A round tube along a smooth curve through points, with a radius (m) at each. Its ends are halves of balls.

    squeeze: factors by which the axes of the cross section are longer.
    """
    curve = _curve(np.array(points) / squeeze, radii, 6 * len(points) - 5)
    start, step, radius = curve[:-1, :3], np.diff(curve[:, :3], axis=0), curve[:, 3]

    def distance(p: np.ndarray) -> np.ndarray:
        nearest = np.full(len(p), np.inf)
        for a, d, r, change in zip(start, step, radius, np.diff(radius), strict=False):
            offset = p / squeeze - a
            share = np.clip(offset @ d / (d @ d), 0.0, 1.0)
            nearest = np.minimum(nearest, np.linalg.norm(offset - share[:, None] * d, axis=1) - (r + share * change))
        return nearest * min(squeeze)

    return distance


def ball(center: Sequence[float], radii: float | Sequence[float]) -> Shape:
    """A ball, or an ellipsoid with these half axes, m."""
    axes = np.broadcast_to(radii, 3)
    return lambda p: (np.linalg.norm((p - center) / axes, axis=1) - 1.0) * axes.min()


def plate(corners: Sequence[Sequence[float]], thickness: float) -> Shape:
    """A triangle with rounded edges, this thick (m)."""
    a, b, c = np.array(corners)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal)
    sides = [(a, b - a), (b, c - b), (c, a - c)]

    def distance(p: np.ndarray) -> np.ndarray:
        inside, to_side = np.ones(len(p), bool), np.full(len(p), np.inf)
        for start, side in sides:
            offset = p - start
            inside &= offset @ np.cross(normal, side) >= 0.0
            share = np.clip(offset @ side / (side @ side), 0.0, 1.0)
            to_side = np.minimum(to_side, np.linalg.norm(offset - share[:, None] * side, axis=1))
        return np.where(inside, np.abs((p - a) @ normal), to_side) - 0.5 * thickness

    return distance


def blend(shapes: Sequence[Shape], width: float) -> Shape:
    """The union of shapes, whose edges are rounded over a width (m): a polynomial smooth minimum (Quilez 2013)."""

    def distance(p: np.ndarray) -> np.ndarray:
        total = shapes[0](p)
        for shape in shapes[1:]:
            other = shape(p)
            near = np.maximum(width - np.abs(total - other), 0.0) / width
            total = np.minimum(total, other) - 0.25 * width * near * near
        return total

    return distance


def surface(shape: Shape, low: Sequence[float], high: Sequence[float], spacing: Sequence[float]) -> Mesh:
    """The surface of a shape inside a box, with vertices about a spacing (m, per axis) apart.

    One vertex for each cell of a grid that the surface passes (surface nets, Gibson 1998), which is then moved onto the
    surface.
    """
    axes = [a + s * np.arange(int(np.ceil((b - a) / s)) + 1) for a, b, s in zip(low, high, spacing, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    inside = _well_composed(shape(grid.reshape(-1, 3)).reshape(grid.shape[:3]) < 0.0)
    assert not any(face.any() for k in range(3) for face in np.moveaxis(inside, k, 0)[[0, -1]]), "the box is too small"
    cells = np.stack([_corner(inside, corner) for corner in _CORNERS])
    passed = cells.any(axis=0) & ~cells.all(axis=0)
    number = np.cumsum(passed).reshape(passed.shape) - 1
    vertices = grid[:-1, :-1, :-1][passed] + 0.5 * np.array(spacing)
    for _ in range(_PROJECTIONS):
        slope = gradient(shape, vertices)
        move = -shape(vertices)[:, None] * slope / (slope * slope).sum(axis=1, keepdims=True)
        vertices += np.clip(move, -np.array(spacing), spacing)
    normals = gradient(shape, vertices)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(vertices, normals, _faces(inside, number, vertices))


def gradient(shape: Shape, p: np.ndarray) -> np.ndarray:
    """The gradient (N, 3) of a shape at points (N, 3), m: the direction outwards, where it is near the surface."""
    steps = _STEP * np.eye(3)
    return np.stack([shape(p + step) - shape(p - step) for step in steps], axis=1) / (2.0 * _STEP)


def _well_composed(inside: np.ndarray) -> np.ndarray:
    """Adds points to a set on a grid until it touches itself nowhere at an edge or a corner only.

    Then each edge of its surface belongs to two faces (Latecki 1997).
    """
    pairs = [(a, b) for a, b in combinations(_CORNERS, 2) if (a != b).sum() > 1]
    while True:
        added = np.zeros_like(inside)
        for a, b in pairs:
            free = np.flatnonzero(a == b)
            others = [c for c in _CORNERS if (c[free] == a[free]).all() and (c != a).any() and (c != b).any()]
            for first in (True, False):
                touch = _corner(inside, a) == first
                touch &= _corner(inside, b) == first
                for other in others:
                    touch &= _corner(inside, other) != first
                _corner(added, others[0] if first else a)[...] |= touch
        if not added.any():
            return inside
        inside |= added


def _corner(values: np.ndarray, corner: np.ndarray) -> np.ndarray:
    """The values of a grid at one of the 8 corners of each cell."""
    return values[tuple(slice(c, n - 1 + c) for c, n in zip(corner, values.shape, strict=True))]


def _faces(inside: np.ndarray, number: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """A quadrilateral around each edge of the grid that passes through the surface. number: of each cell's vertex."""
    quads = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        first, second = (np.moveaxis(inside, axis, 0)[part] for part in (slice(None, -1), slice(1, None)))
        crossing = np.moveaxis(first != second, 0, axis)
        at = np.argwhere(crossing)
        leaves = np.moveaxis(first, 0, axis)[crossing]  # the edge runs from inside to outside
        around = [
            at - np.eye(3, dtype=int)[u] * a - np.eye(3, dtype=int)[v] * b for a, b in ((1, 1), (0, 1), (0, 0), (1, 0))
        ]
        quad = np.stack([number[tuple(cell.T)] for cell in around], axis=1)
        quad[~leaves] = quad[~leaves, ::-1]
        quads.append(quad)
    quad = np.concatenate(quads)
    first, second = (np.linalg.norm(vertices[quad[:, i]] - vertices[quad[:, i + 2]], axis=1) for i in (0, 1))
    # Programs cut a quadrilateral from its first vertex on: the shorter cut follows the surface better.
    return np.where((first <= second)[:, None], quad, np.roll(quad, -1, axis=1))


def rod(
    points: Sequence[Sequence[float]], radii: Sequence[float], rings: int, sides: int, squeeze: float = 1.0
) -> Mesh:
    """The surface of a tube along a smooth curve through points, with a radius (m) at each and with round ends.

    It takes fewer vertices than `surface` where a tube is thin. squeeze: how much longer its cross section is along z.
    """
    curve = _curve(points, radii, rings)
    centers, radius = curve[:, :3], curve[:, 3]
    along = np.gradient(centers, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    lean = np.arctan(-np.gradient(radius) * (rings - 1) / _length(curve))
    # One more ring at each end, at this latitude of the ball that rounds it.
    out, in_ = np.sin(_LATITUDE), np.cos(_LATITUDE)
    centers = np.stack([centers[0] - out * radius[0] * along[0], *centers, centers[-1] + out * radius[-1] * along[-1]])
    along = np.stack([along[0], *along, along[-1]])
    lean = np.array([-_LATITUDE, *lean, _LATITUDE])
    radius = np.array([in_ * radius[0], *radius, in_ * radius[-1]])
    first = np.cross(along, [0.001, 0.001, 1.0])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(along, first)
    angle = 2.0 * np.pi * np.arange(sides) / sides
    x, y = np.cos(angle)[:, None], np.sin(angle)[:, None]
    surface_points = centers[:, None] + radius[:, None, None] * (x * first[:, None] + squeeze * y * second[:, None])
    normals = np.cos(lean)[:, None, None] * (x * first[:, None] + y / squeeze * second[:, None])
    normals += np.sin(lean)[:, None, None] * along[:, None]
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    tips = curve[[0, -1], :3] + np.array([[-1.0], [1.0]]) * curve[[0, -1], 3:] * along[[0, -1]]
    return Mesh(
        np.concatenate([surface_points.reshape(-1, 3), tips]),
        np.concatenate([normals.reshape(-1, 3), [-along[0], along[-1]]]),
        _rod_faces(len(centers), sides),
    )


def _rod_faces(rings: int, sides: int) -> np.ndarray:
    k = np.arange(sides)
    after, last, tip = (k + 1) % sides, sides * (rings - 1), np.full(sides, sides * rings)
    faces = [np.stack([k, after, after + sides, k + sides], axis=1) + sides * i for i in range(rings - 1)]
    ends = [np.stack([after, k, tip, tip], axis=1), np.stack([k + last, after + last, tip + 1, tip + 1], axis=1)]
    return np.concatenate(faces + ends)


def _curve(points: Sequence[Sequence[float]], radii: Sequence[float], count: int) -> np.ndarray:
    """Samples (count, 4), m, of a smooth curve through points, and of the radius along it."""
    at = np.arange(len(points))
    spline = make_interp_spline(at, np.column_stack([points, radii]), k=min(3, len(points) - 1))
    samples: np.ndarray = spline(np.linspace(0.0, at[-1], count))
    return samples


def _length(curve: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(curve[:, :3], axis=0), axis=1).sum())


def together(meshes: Sequence[Mesh]) -> Mesh:
    """Several surfaces as one mesh."""
    before = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, before, strict=True)]),
    )


def write_obj(file: Path, mesh: Mesh) -> None:
    """Writes a mesh as a Wavefront file, in steps of 0.1 mm."""
    lines = [f"v {x:.4f} {y:.4f} {z:.4f}" for x, y, z in mesh.vertices]
    lines += [f"vn {x:.2f} {y:.2f} {z:.2f}" for x, y, z in mesh.normals]
    lines += ["f " + " ".join(f"{k}//{k}" for k in dict.fromkeys(face)) for face in (mesh.faces + 1).tolist()]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
