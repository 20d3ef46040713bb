"""The models of these tests, and what drakearm makes of them."""

from pathlib import Path

import numpy as np
import pytest

from drakearm.errors import ImportingError
from drakearm.importing import import_limb, write_limb
from drakearm.model import load_arm
from drakearm.model.musculature import muscle_geometry
from drakearm.model.skeleton import skeleton_plant

HERE = Path(__file__).parent
SHARED = Path(__file__).parents[3] / "shared"


def shared(name):
    """A file of ../shared; skips the test where it is missing."""
    if not (SHARED / name).is_file():
        pytest.skip(f"{name} is not here")
    return SHARED / name


def changed(folder, name, *changes):
    """The path of a copy of a model of these tests, with texts replaced: (old, new)."""
    text = (HERE / name).read_text()
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    file = folder / name
    file.write_text(text)
    return file


def imported(file, folder, **options):
    """The ImportedLimb, and the arm that is loaded from its folder."""
    limb = import_limb(file, **options)
    write_limb(limb, folder)
    return limb, load_arm(folder)


def refusal(file, **options):
    """The sentence with which the import is refused."""
    with pytest.raises(ImportingError) as caught:
        import_limb(file, **options)
    return str(caught.value)


def postures(limb, number=20, inside=0.0):
    """Random joint angles (number, n_q) within the limits, or a fraction of the range inside of them."""
    lower, upper = np.array(list(limb.selection.limits.values())).T
    margin = inside * (upper - lower)
    return np.random.default_rng(7).uniform(lower + margin, upper - margin, (number, len(lower)))


def poses_in_drake(arm, q):
    """Body -> pose (4, 4) in the world."""
    plant = skeleton_plant(arm)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    model = plant.GetModelInstanceByName(arm.name)
    bodies = [plant.get_body(i) for i in plant.GetBodyIndices(model)]
    return {body.name(): plant.EvalBodyPoseInWorld(context, body).GetAsMatrix4() for body in bodies}


def assert_bodies_are_in_place(limb, arm, program):
    """Every body is where the program has it, in random postures."""
    for q in postures(limb):
        program.set_coordinates(dict(zip(arm.coordinates, q.tolist(), strict=True)))
        ours = poses_in_drake(arm, q)
        for link in limb.links:
            if link.body:
                shift = np.eye(4)
                shift[:3, 3] = link.shift
                np.testing.assert_allclose(ours[link.name] @ shift, program.poses()[link.name], atol=1e-9)


def geometry(arm, q):
    """Lengths (m, n) and moment arms (m, n, n_q) at joint angles (m, n_q)."""
    results = [muscle_geometry(x, arm.muscle_table, arm.path_table) for x in q]
    return np.array([length for length, _ in results]), np.array([arms for _, arms in results])
