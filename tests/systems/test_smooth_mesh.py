"""Round shapes for Meshcat: where their vertices and normals are."""

import numpy as np
import pytest

from drakearm.systems.smooth_mesh import SIDES, frustum, tube


def read(mesh):
    lines = [line.split() for line in mesh.source().in_memory().mesh_file.contents().decode().splitlines()]
    vertices, normals = (np.array([row[1:] for row in lines if row[0] == kind], dtype=float) for kind in ("v", "vn"))
    faces = np.array([[int(corner.split("//")[0]) - 1 for corner in row[1:]] for row in lines if row[0] == "f"])
    return vertices, normals, faces


def assert_outward(vertices, normals, faces):
    a, b, c, d = (vertices[faces[:, i]] for i in range(4))
    assert ((np.cross(c - a, d - b) * normals[faces].mean(axis=1)).sum(axis=1) > 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=0.02)


def test_a_frustum_is_along_z():
    vertices, normals, faces = read(frustum(0.3, 0.8, 0.05))
    np.testing.assert_allclose(np.hypot(*vertices[:, :2].T), [0.3] * SIDES + [0.8] * SIDES, atol=1e-4)
    np.testing.assert_allclose(vertices[:, 2], [-0.05] * SIDES + [1.05] * SIDES)
    assert_outward(vertices, normals, faces)


def test_a_tube_keeps_its_radius_also_where_the_path_stands_still_or_turns_back():
    path = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 0], [1, 1, 0], [0.5, 1.0, 0.2], [1, 1, 0]], dtype=float)
    vertices, normals, _ = read(tube(path, 0.01))
    centers = np.repeat(path[[0, 1, 3, 4, 5]], SIDES, axis=0)
    np.testing.assert_allclose(np.linalg.norm(vertices - centers, axis=1), 0.01, atol=1e-4)
    np.testing.assert_allclose(vertices - centers, 0.01 * normals, atol=2e-4)
    assert_outward(*read(tube(path[:2], 0.01)))


@pytest.mark.parametrize("path", [np.zeros((5, 3)), np.ones((1, 3))])
def test_a_path_without_length_has_no_tube(path):
    assert tube(path, 0.01) is None
