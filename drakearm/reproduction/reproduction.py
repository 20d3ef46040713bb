"""Reproduces experiments: learns and runs all their trials, and reports what they gave."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from drakearm.errors import DrakearmError
from drakearm.files.lock import locked
from drakearm.files.writing import storage
from drakearm.reproduction.board import Board
from drakearm.reproduction.choices import Backend
from drakearm.reproduction.experiment import Experiment
from drakearm.reproduction.perturbation_table import perturbation_table
from drakearm.reproduction.report import write_report
from drakearm.reproduction.sweep import Watch, run_trials
from drakearm.reproduction.trial import Outcome, Trial
from drakearm.reproduction.trial_folder import TrialFolder

TRIALS, _BOARD = "trials", ".running"  # folders in that of the reproduction


@dataclass(frozen=True)
class Reproduction:
    """What a reproduction gave."""

    outcomes: Sequence[Outcome]  # of the trials that did not fail
    failures: Mapping[Trial, str]  # why the others failed
    earlier: int  # how many trials were finished already, before this command
    completed: int  # how many were completed by it
    report: Path | None  # report.html; None if nothing can be reported


def reproduce(
    experiments: Sequence[Experiment],
    folder: Path,
    *,
    command: str,
    seeds: int = 1,
    batches: int | None = None,
    jobs: int | None = None,
    backend: Backend | None = None,
    overwrite: bool = False,
    prepare: Callable[[], None] | None = None,
    watch: Watch | None = None,
) -> Reproduction:
    """Completes the trials of experiments in a folder, and writes the report there.

    Trials that are finished are loaded, and a training that was stopped is continued. So a reproduction that was killed
    at any moment and is called again gives the same results, but for the seconds that they took.

    command: that is shown in the report. batches: of each training, instead of the scenario's number. overwrite:
    whether to make those trials again that the folder holds with other settings. For the rest, see `run_trials`.

    Raises RunFolderError, before any work begins, if the folder holds trials that were made with other settings,
    versions or files of scenarios, and may not be overwritten; SweepError as `run_trials` does; StorageError.
    """
    failures: dict[Trial, str] = {}
    folders: dict[Trial, TrialFolder] = {}
    with storage(folder, "cannot be made"):
        folder.mkdir(parents=True, exist_ok=True)
    place = folder.absolute()  # workers may have another current folder
    with locked(folder):
        for trial in dict.fromkeys(trial for experiment in experiments for trial in experiment.trials(seeds)):
            try:
                folders[trial] = TrialFolder(place / TRIALS, trial, batches)
            except DrakearmError as error:
                failures[trial] = str(error)
        unfinished = [each for each in folders.values() if not (_belongs(each, overwrite) and each.finished)]
        failures |= run_trials(
            unfinished,
            Board(place / _BOARD),
            jobs=jobs,
            backend=backend,
            overwrite=overwrite,
            prepare=prepare,
            watch=watch,
        )
        made = {trial: each for trial, each in folders.items() if trial not in failures}
        outcomes = [each.outcome() for each in made.values()]
        shown = [outcome for experiment in experiments for outcome in _whole(experiment, outcomes, seeds)]
        replays = {trial: each.run.path("replay") for trial, each in made.items()}
        links = {trial: str(page.relative_to(place)) for trial, page in replays.items() if page.exists()}
        table = perturbation_table(list(made.values()))
        tables = [table] if table else []
        report = write_report(folder, experiments, shown, command, links, tables) if shown else None
    return Reproduction(outcomes, failures, len(folders) - len(unfinished), len(unfinished), report)


def _belongs(folder: TrialFolder, overwrite: bool) -> bool:
    """Whether a folder holds its trial, or a part of it. Raises the error of `check` if not, unless it overwrites."""
    try:
        folder.check()
    except DrakearmError:
        if not overwrite:
            raise
        return False
    return True


def _whole(experiment: Experiment, outcomes: Sequence[Outcome], seeds: int) -> list[Outcome]:
    """The outcomes of those methods and seeds of which an experiment has all movements."""
    trials = experiment.trials(seeds)
    missing = set(trials) - {outcome.trial for outcome in outcomes}
    lacking = {(trial.method, trial.seed) for trial in missing}
    return [o for o in outcomes if o.trial in trials and (o.trial.method, o.trial.seed) not in lacking]
