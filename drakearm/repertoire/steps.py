"""Learning a repertoire: its library is planned, a policy is trained, and tested on movements that it has not seen."""

import json
import shutil
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from drakearm.errors import RunFolderError, shown
from drakearm.experiments.metrics import versions
from drakearm.experiments.steps import with_batches
from drakearm.files.lock import locked
from drakearm.files.writing import replacement
from drakearm.learning import ArmVectorEnv, BatchReport, Policy, prepare, train
from drakearm.planning.library import Library, plan_library
from drakearm.repertoire.errors_picture import write_errors_picture
from drakearm.repertoire.errors_table import held_out_errors
from drakearm.repertoire.folder import CHECKPOINT, FILES
from drakearm.repertoire.repertoire import Movements, Repertoire, find_repertoire, load_repertoire
from drakearm.repertoire.scatter import NOISE, fitts, scatter

HELD_OUT = 200  # movements
HELD_OUT_SEED = 2**31  # plus the seed of the repertoire: libraries are not planned with such seeds
OnPlanned = Callable[[int, int], None]


def library_of(
    repertoire: Repertoire, movements: Movements, file: Path, on_planned: OnPlanned | None = None
) -> Library:
    """The library of movements in a file; it is planned if the file does not exist."""
    if not file.exists():
        report = (lambda done: on_planned(done, movements.count)) if on_planned else None
        plan_library(repertoire.loaded_arm, movements.source, movements.count, movements.seed, report).save(file)
    library = Library.load(file)
    if len(library.length) != movements.count:
        raise RunFolderError(f"{shown(file)} has {len(library.length)} movements: expected {movements.count}.")
    return library


def learn_repertoire(
    source: str | Path,
    folder: Path,
    *,
    seed: int = 0,
    batches: int | None = None,
    resume: bool = False,
    on_planned: OnPlanned | None = None,
    on_round: Callable[[int, int], None] | None = None,
    on_batch: Callable[[BatchReport], None] | None = None,
) -> dict[str, Any]:
    """Learns a repertoire (name or file) in a folder, with the files of FILES, and returns the content of errors.json.

    A library that the folder has already is kept, if the folder has the same repertoire. batches: replaces the number
    in the file. resume: whether to continue a training that was stopped, which then ends with the same policy as if it
    had not been; if there is none, the training begins. on_planned: called after each plan with the number of plans and
    of movements; on_round, on_batch: see `train_step`. Raises RunFolderError if the folder has another repertoire or
    another process works in it, TrainingError if the training to continue had another seed or other settings.
    """
    repertoire = load_repertoire(source)
    _claim(find_repertoire(source), folder / FILES["repertoire"])
    with locked(folder):
        return _learn(repertoire, folder, seed, batches, resume, on_planned, on_round, on_batch)


def _learn(
    repertoire: Repertoire,
    folder: Path,
    seed: int,
    batches: int | None,
    resume: bool,
    on_planned: OnPlanned | None,
    on_round: Callable[[int, int], None] | None,
    on_batch: Callable[[BatchReport], None] | None,
) -> dict[str, Any]:
    """See `learn_repertoire`. The folder is locked."""
    path = {name: folder / file for name, file in FILES.items()}
    checkpoint = folder / CHECKPOINT
    settings = with_batches(repertoire.training, batches)
    start = time.perf_counter()
    library = library_of(repertoire, repertoire.movements, path["library"], on_planned)
    planned = time.perf_counter()
    tasks = repertoire.tasks(library)
    if not resume:
        checkpoint.unlink(missing_ok=True)
    policy = train(
        ArmVectorEnv(tasks, settings.environments, redraw=True),
        settings,
        seed=seed,
        metadata={"repertoire": repertoire.name, "seed": seed, "versions": versions()},
        prepare=lambda actor: prepare(
            actor,
            tasks,
            settings,
            seed,
            lambda number: on_round(number, settings.imitation_rounds) if on_round else None,
        ),
        log_path=path["log"],
        resume_path=checkpoint,
        on_batch=on_batch,
    )
    policy.save(path["policy"])
    trained = time.perf_counter()
    errors = {
        "repertoire": repertoire.name,
        "seed": seed,
        "settings": asdict(settings),
        "planning_seconds": planned - start,
        "training_seconds": trained - planned,
        **evaluate_repertoire(repertoire, policy, path["held_out"], path["picture"], on_planned),
        "versions": versions(),
    }
    with replacement(path["errors"]) as partial:
        partial.write_text(json.dumps(errors, indent=1) + "\n", encoding="utf-8")
    checkpoint.unlink(missing_ok=True)
    return errors


def evaluate_repertoire(
    repertoire: Repertoire, policy: Policy, file: Path, picture: Path, on_planned: OnPlanned | None = None
) -> dict[str, Any]:
    """How good a policy is in HELD_OUT movements that it has not seen, as errors.json has it.

    held_out: its errors, and those of static optimization. motor_noise: how the hand scatters, in cm, and Fitts' law,
    in s and s/bit; see `scatter` and `fitts`.
    file: of the library with these movements, which is planned if it does not exist. picture: where the errors are
    drawn.
    """
    movements = replace(repertoire.movements, count=HELD_OUT, seed=(repertoire.movements.seed + HELD_OUT_SEED) % 2**32)
    tasks = repertoire.tasks(library_of(repertoire, movements, file, on_planned))
    policy.check(tasks[0])
    errors, static = held_out_errors(tasks, policy.act), held_out_errors(tasks, None)
    spread = scatter(tasks, policy.act)
    home = np.mean([task.reference.q[0] for task in tasks], axis=0)
    law = fitts(tasks[0], home, policy.act)
    write_errors_picture(picture, tasks, policy.act, errors, static, law, repertoire.name)
    return {
        "held_out": {"policy": errors.summary(), "static optimization, told the load": static.summary()},
        "motor_noise": {
            "share": NOISE,
            "hand_scatter_median_cm": float(np.median(spread)),
            "hand_scatter_95_cm": float(np.percentile(spread, 95)),
            "fitts": None if law is None else {"slope": law.slope, "intercept": law.intercept, "r": law.correlation},
        },
    }


def _claim(source: Path, kept: Path) -> None:
    """Copies the repertoire's file into the folder. Raises RunFolderError if it has another one."""
    kept.parent.mkdir(parents=True, exist_ok=True)
    if kept.exists() and kept.resolve() != source.resolve() and kept.read_bytes() != source.read_bytes():
        raise RunFolderError(
            f"{shown(kept.parent)} holds another repertoire: expected an empty folder, or one with the same."
        )
    if not kept.exists():
        shutil.copyfile(source, kept)
