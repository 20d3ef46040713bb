"""Libraries: only movements that the muscles can make, the same for the same seed, and kept in one file."""

from dataclasses import fields, replace

import numpy as np
import pytest
from pydantic import ValidationError

from drakearm.errors import PlanningError, RunFolderError
from drakearm.model import MakeTorqueArm
from drakearm.model.skeleton import hand_motion
from drakearm.planning import Library, Mixture, Reaches, muscle_feasibility, plan_library
from drakearm.planning.costs import Posture, TorqueRate

SOURCE = Reaches(
    start_deg=((-40.0, 20.0), (40.0, 100.0)),
    target_deg=((-40.0, 20.0), (40.0, 100.0)),
    duration=(0.4, 0.6),
    load_mass=(0.0, 1.0),
    hold=0.1,
    speed_limit=(15.0, 15.0),
    torque_limit=(60.0, 60.0),
    costs=[TorqueRate(weight=0.1), Posture(running=0.1)],
)


@pytest.fixture(scope="module")
def library(arm):
    return plan_library(arm, SOURCE, 3, seed=1, jobs=1)


def test_the_muscles_can_make_every_movement(arm, library):
    for reference, load_mass in zip(library.references, library.load_mass, strict=True):
        assert reference.problem() is None
        assert 0.5 <= reference.duration <= 0.7 and 0.0 <= load_mass <= 1.0
        assert muscle_feasibility(arm, reference, load_mass).feasible


def test_the_seed_and_nothing_else_determines_it(arm, library):
    longer = plan_library(arm, SOURCE, 4, seed=1, jobs=2)
    for one, other in zip(library.references, longer.references, strict=False):
        np.testing.assert_array_equal(one.q, other.q)
    assert len(longer.references) == 4
    assert plan_library(arm, SOURCE, 1, seed=2, jobs=1).load_mass[0] != library.load_mass[0]


def test_a_file_keeps_it(library, tmp_path):
    library.save(tmp_path / "library.npz")
    loaded = Library.load(tmp_path / "library.npz")
    for field in fields(Library):
        np.testing.assert_array_equal(getattr(loaded, field.name), getattr(library, field.name))
    replace(library, length=library.length + 1).save(tmp_path / "wrong.npz")
    with pytest.raises(RunFolderError, match="samples, expected"):
        Library.load(tmp_path / "wrong.npz")


def test_targets_can_be_positions_of_the_hand(arm):
    box = ((0.2, 0.3, -1.0), (0.3, 0.5, 1.0))
    rng = np.random.default_rng(0)
    q = np.array([replace(SOURCE, target_box=box).draw(arm, rng).movement.target for _ in range(10)])
    p_WH, _ = hand_motion(MakeTorqueArm(arm), arm, q, 0.0 * q)
    assert (p_WH >= box[0]).all() and (p_WH <= box[1]).all()
    with pytest.raises(PlanningError, match="finds no target"):
        replace(SOURCE, target_deg=SOURCE.start_deg, least_way_deg=200.0).draw(arm, rng)


def test_what_no_muscle_can_do_is_said(arm, monkeypatch):
    monkeypatch.setattr("drakearm.planning.library._DRAWS", 3)
    with pytest.raises(PlanningError, match="can make none of 3 movements"):
        plan_library(arm, replace(SOURCE, load_mass=(50.0, 60.0)), 1, seed=0, jobs=1)


def test_a_range_begins_with_the_smaller_number():
    with pytest.raises(ValidationError, match="the smaller number first"):
        replace(SOURCE, duration=(0.6, 0.4))


def test_a_mixture_draws_from_each_source_by_its_share(arm):
    heavy = replace(SOURCE, load_mass=(5.0, 6.0))
    rng = np.random.default_rng(0)
    loads = [Mixture(sources=[SOURCE, heavy], shares=[1.0, 3.0]).draw(arm, rng).load_mass for _ in range(200)]
    assert np.mean(np.array(loads) > 4.0) == pytest.approx(0.75, abs=0.1)
    with pytest.raises(ValidationError, match="found 1 shares, expected 2"):
        Mixture(sources=[SOURCE, heavy], shares=[1.0])


def test_the_shares_are_those_of_the_movements_that_the_muscles_can_make(arm):
    """Most loads of the second source are too heavy. Half of the movements have its loads nevertheless."""
    heavy = replace(SOURCE, load_mass=(1.0, 30.0))
    library = plan_library(arm, Mixture(sources=[SOURCE, heavy], shares=[1.0, 1.0]), 24, seed=3, jobs=1)
    loads = [Mixture(sources=[SOURCE, heavy], shares=[1.0, 1.0]).pick(np.random.default_rng([3, k])) for k in range(24)]
    np.testing.assert_array_equal(library.load_mass >= 1.0, [source is heavy for source in loads])
    assert 6 <= np.sum(library.load_mass >= 1.0) <= 18
