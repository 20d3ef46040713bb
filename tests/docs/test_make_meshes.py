"""The meshes of arm14: closed, smooth, made by the script, and where the muscles are attached."""

import importlib
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Mesh, SceneGraph
from pydrake.multibody.plant import MultibodyPlant

from drakearm.model import load_arm
from drakearm.model.skeleton import add_skeleton

DOCS = Path(__file__).parents[2] / "docs"
sys.path.insert(0, str(DOCS))
make_meshes, surfaces = importlib.import_module("make_meshes"), importlib.import_module("surfaces")
sys.path.remove(str(DOCS))

ARM = load_arm()
FOLDER = ARM.skeleton.parent
NEAR = 0.02  # m
FLIPPED = 0.01  # largest share of faces, in narrow notches, that do not look where the normals of their corners do


@pytest.fixture(scope="module", params=make_meshes.MESHES, ids=lambda make: make.__name__)
def made(request):
    return request.param.__name__, request.param()


def corners(face):
    return list(dict.fromkeys(face))


def face_normals(mesh):
    a, b, c, d = (mesh.vertices[mesh.faces[:, i]] for i in range(4))
    return np.cross(c - a, d - b)


def test_each_edge_belongs_to_two_faces(made):
    edges = Counter(edge for f in map(corners, made[1].faces.tolist()) for edge in zip(f, f[1:] + f[:1], strict=True))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)


def test_normals_have_length_1_and_point_outwards(made):
    mesh = made[1]
    assert np.isfinite(mesh.vertices).all()
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-9)
    agree = (face_normals(mesh) * mesh.normals[mesh.faces].mean(axis=1)).sum(axis=1) > 0.0
    assert np.mean(~agree) <= FLIPPED
    volume = (mesh.vertices[mesh.faces].mean(axis=1) * face_normals(mesh)).sum() / 6.0  # by the divergence theorem
    assert volume > 0.0


def test_the_script_makes_the_files_of_the_package(made, tmp_path):
    name, mesh = made
    surfaces.write_obj(tmp_path / "made.obj", mesh)
    assert (tmp_path / "made.obj").read_bytes() == (FOLDER / f"{name}.obj").read_bytes()


def test_all_meshes_of_the_skeleton_are_made_and_small():
    files = sorted(FOLDER.glob("*.obj"))
    assert [file.stem for file in files] == sorted(make.__name__ for make in make_meshes.MESHES)
    assert sum(file.stat().st_size for file in files) < 300_000
    skeleton = ARM.skeleton.read_text()
    assert all(f'filename="{file.name}"' in skeleton for file in files)


def test_muscles_begin_and_end_at_bones():
    plant, scene_graph = MultibodyPlant(0.0), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    add_skeleton(plant, ARM)
    plant.Finalize()
    inspector = scene_graph.model_inspector()
    for muscle in ARM.muscles:
        for body, point in (muscle.points[0], muscle.points[-1]):
            shapes = map(inspector.GetShape, plant.GetVisualGeometriesForBody(plant.GetBodyByName(body)))
            files = [shape.source().path() for shape in shapes if isinstance(shape, Mesh)]
            bones = np.concatenate([read_vertices(file) for file in files if "skin" not in file.name])
            assert np.linalg.norm(bones - point, axis=1).min() < NEAR, muscle.name


def read_vertices(file):
    rows = [line.split()[1:] for line in file.read_text().splitlines() if line.startswith("v ")]
    return np.array(rows, dtype=float)


def test_a_ball_and_a_rod_are_round():
    ball = surfaces.surface(surfaces.ball([0.1, 0.2, 0.3], 0.05), [0.0, 0.1, 0.2], [0.2, 0.3, 0.4], [0.013] * 3)
    outward = (ball.vertices - [0.1, 0.2, 0.3]) / 0.05
    np.testing.assert_allclose(np.linalg.norm(outward, axis=1), 1.0, atol=1e-6)
    np.testing.assert_allclose(ball.normals, outward, atol=1e-6)
    rod = surfaces.rod([[0, 0, 0], [0, 1, 0]], [0.1, 0.1], 5, 8)
    along = np.clip(rod.vertices[:, 1], 0.0, 1.0)[:, None] * [0.0, 1.0, 0.0]
    np.testing.assert_allclose(np.linalg.norm(rod.vertices - along, axis=1), 0.1, atol=1e-9)
    np.testing.assert_allclose(rod.normals, (rod.vertices - along) / 0.1, atol=1e-9)
