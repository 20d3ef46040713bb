"""A library of movements: many plans, made in parallel and kept in one file."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Annotated

import numpy as np

from drakearm.errors import PlanningError, RunFolderError, shown
from drakearm.files.arrays import Layout, load_arrays, save_arrays
from drakearm.model.arm import Arm
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.model.skeleton import gravity_torque
from drakearm.model.static_optimization import negligible_reserve, static_activations
from drakearm.model.torque_arm import MakeTorqueArm
from drakearm.planning.feasibility import muscle_feasibility
from drakearm.planning.movement_source import MovementSource
from drakearm.planning.planner import plan

_DRAWS = 500  # of a source, until it has drawn a movement that the muscles can make
_SAMPLES = Layout(("N", "n_q"), -1e9, 1e9)


@dataclass(frozen=True)
class Library:
    """K movements with their loads. The samples of all references stand one below the other."""

    length: Annotated[np.ndarray, Layout(("K",), 2, 20_000)]  # samples of each reference
    load_mass: Annotated[np.ndarray, Layout(("K",), 0.0, 1000.0)]  # kg
    q: Annotated[np.ndarray, _SAMPLES]
    v: Annotated[np.ndarray, _SAMPLES]
    a: Annotated[np.ndarray, _SAMPLES]
    tau: Annotated[np.ndarray, _SAMPLES]

    @property
    def references(self) -> list[Reference]:
        """The references, in order."""
        cuts = np.cumsum(self.length.astype(int))[:-1]
        parts = zip(*(np.split(array, cuts) for array in (self.q, self.v, self.a, self.tau)), strict=True)
        return [Reference(CONTROL_STEP * np.arange(len(q)), q, v, a, tau) for q, v, a, tau in parts]

    def save(self, file: Path) -> None:
        """Writes an .npz. Raises StorageError if the file cannot be written."""
        save_arrays(self, file)

    @classmethod
    def load(cls, file: Path) -> "Library":
        """Reads what `save` wrote. Raises RunFolderError if the file is missing or damaged, or is no library."""
        library = load_arrays(cls, file)
        if library.length.sum() != len(library.q):
            raise RunFolderError(
                f"{shown(file)}: q: found {len(library.q)} samples, expected {library.length.sum():g}."
            )
        return library


def plan_library(
    arm: Arm,
    source: MovementSource,
    count: int,
    seed: int,
    on_planned: Callable[[int], None] | None = None,
    jobs: int = -1,
) -> Library:
    """Plans as many movements as `count` that the muscles can make, in parallel. The same seed gives the same library.

    Each movement has a generator of its own, so a longer library begins with the shorter one. on_planned: called after
    each movement with the number of those that are planned. jobs: how many processes; -1: one per core. Raises
    PlanningError if the muscles cannot make what the source draws.
    """
    from joblib import Parallel, delayed  # only here: it takes 0.1 s to import

    planned = []
    work = (delayed(_plan_one)(arm, source, [seed, k]) for k in range(count))
    for one in Parallel(jobs, return_as="generator", inner_max_num_threads=1, backend="loky")(work):
        planned.append(one)
        if on_planned:
            on_planned(len(planned))
    references = [reference for reference, _ in planned]
    return Library(
        np.array([len(reference.t) for reference in references]),
        np.array([load_mass for _, load_mass in planned]),
        *(np.concatenate([getattr(reference, name) for reference in references]) for name in ("q", "v", "a", "tau")),
    )


def _plan_one(arm: Arm, source: MovementSource, seed: list[int]) -> tuple[Reference, float]:
    """A movement that the muscles can make, and its load."""
    rng = np.random.default_rng(seed)
    source = source.pick(rng)
    for _ in range(_DRAWS):
        movement, load_mass = source.draw(arm, rng)
        if not all(_can_rest(arm, q, load_mass) for q in (movement.start, movement.target)):
            continue
        try:
            reference = plan(arm, movement, load_mass).reference
        except PlanningError:
            continue
        if muscle_feasibility(arm, reference, load_mass).feasible:
            return reference, load_mass
    raise PlanningError(
        f"The muscles of the arm {arm.name} can make none of {_DRAWS} movements that the source {source.type} has "
        "drawn: expected easier ones."
    )


def _can_rest(arm: Arm, q: np.ndarray, load_mass: float) -> bool:
    """Whether the muscles can hold a posture. It costs much less than a plan."""
    n, n_q = len(arm.muscles), len(arm.coordinates)
    torque = load_mass * _gravity(arm, q, 1.0) + (1.0 - load_mass) * _gravity(arm, q, 0.0)  # linear in the load
    start, weighting = np.full(n, 0.1), np.eye(n_q)
    muscles, paths = arm.muscle_table, arm.path_table
    _, reserve = static_activations(q, np.zeros(n_q), torque, start, weighting, muscles, paths)
    return bool(np.abs(reserve).max() <= negligible_reserve(q, muscles, paths))


def _gravity(arm: Arm, q: np.ndarray, load_mass: float) -> np.ndarray:
    return gravity_torque(_plant(arm, load_mass), q)


_plant = lru_cache(maxsize=4)(MakeTorqueArm)
