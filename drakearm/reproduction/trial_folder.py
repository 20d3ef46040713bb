"""The folder of a trial: a run folder, in which the trial is completed at once or in several goes."""

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from drakearm.errors import RunFolderError, shown
from drakearm.experiments import (
    Preset,
    RunFolder,
    evaluate_step,
    load_scenario,
    plan_step,
    replay_step,
    robust_step,
    single_step,
    static_step,
    train_step,
)
from drakearm.experiments.metrics import versions
from drakearm.experiments.steps import with_batches
from drakearm.files import replacement
from drakearm.files.reading import read_json
from drakearm.learning import PAPER, BatchReport, PpoSettings
from drakearm.model.recording import Recording, load_recordings
from drakearm.planning.feasibility import muscle_feasibility
from drakearm.reproduction.trial import Method, Outcome, Trial

Tell = Callable[[float, str], None]  # told how much of the trial's work is done, and what is done now

_RECORD = "trial.json"  # how the trial is made: another one is refused
_READ = ("policy", "training_log", "metrics", "recording", "noisy", "robustness", "robust_runs", "single")
_EVALUATION = 50_000  # control steps of training that take about as long as all that is not training
_IMITATION_ROUND = 36_000  # control steps of training that take about as long as a round of imitation
_COMPARED = ("timing-0.7s", 0)  # scenario and seed of the trials that also run with one perturbation at a time


class TrialFolder:
    """Makes a trial in a folder of its own, and reads what it gave.

    Whatever is finished there is kept. So a trial that was stopped at any moment can be completed later, and ends with
    the same outcome, but for the seconds that it took.
    """

    def __init__(self, folder: Path, trial: Trial, batches: int | None = None):
        """folder: of all trials. batches: of each training, instead of the scenario's number.

        Raises ScenarioError if there is no such scenario, or if its file is invalid; TrainingError if the number of
        batches is impossible.
        """
        scenario = load_scenario(trial.scenario)
        self.trial = trial
        self.run = RunFolder(folder / scenario.name / trial.method.name / f"seed-{trial.seed}")
        self.preset = Preset.paper if trial.method is Method.ppo_alone else None
        self.batches = batches
        self.settings = _settings(trial.method, scenario.training, batches)
        self._steps = ["metrics"]  # what is made after the plan and the training, by its main file
        self._steps += ["replay"] if trial.seed == 0 else []  # each takes some MB
        self._steps += ["robustness"] if scenario.perturbations else []
        self._steps += ["single"] if (trial.scenario, trial.seed) == _COMPARED else []

    @property
    def label(self) -> str:
        """The trial in words, which can be a file's name."""
        return f"{self.run.folder.parents[1].name}, {self.trial.method}, seed {self.trial.seed}"

    @property
    def work(self) -> float:
        """How much there is to do, in control steps of training."""
        return _EVALUATION + self._training_work

    @property
    def finished(self) -> bool:
        """Whether nothing is left to do."""
        training_stopped = self.run.path("checkpoint").exists()
        return not training_stopped and all(self.run.path(name).exists() for name in self._steps)

    def check(self) -> None:
        """Raises RunFolderError if the folder holds something else than this trial, or a part of it."""
        problem = self._problem()
        if problem:
            raise RunFolderError(
                f"{shown(self.run.folder)} {problem}: choose another folder with --out, or make it again with "
                "--overwrite."
            )

    def complete(self, tell: Tell, overwrite: bool = False) -> None:
        """Does what is left to do. overwrite: whether to begin again if the folder holds something else.

        Raises RunFolderError if it does and may not be overwritten; otherwise as the steps of a run do.
        """
        run, static = self.run, self.trial.method is Method.static
        with run.locked():
            tell(0.0, "plan")
            try:
                self.check()
                planned = self._recorded() is not None and run.path("reference").exists()
            except RunFolderError:
                if not overwrite:
                    raise
                planned = False
            if not planned:
                plan_step(run, self.trial.scenario, preset=self.preset)
                with replacement(run.folder / _RECORD) as partial:
                    partial.write_text(json.dumps(self._record(), indent=2) + "\n", encoding="utf-8")
            if not static:
                self._train(tell)
            steps = {
                "metrics": ("evaluation", static_step if static else evaluate_step),
                "replay": ("replay", replay_step),
                "robustness": ("perturbed runs", robust_step),
                "single": ("single perturbations", single_step),
            }
            for number, name in enumerate(self._steps):
                if not run.path(name).exists():
                    text, step = steps[name]
                    tell(self._training_work + _EVALUATION * number / len(self._steps), text)
                    step(run)

    def outcome(self) -> Outcome:
        """What the finished trial gave, from its files. Raises RunFolderError if one is missing or damaged."""
        run, learned = self.run, self.trial.method is not Method.static
        scenario, planned = run.scenario(), run.read_json("plan", "plan")
        task = run.task(scenario)
        metrics = run.read_json("metrics", "evaluate")
        seconds = {
            "plan": planned["seconds"],
            "train": metrics.get("training_seconds", 0.0),
            "evaluate": metrics["evaluation_seconds"],
        }
        robust = load_recordings(run.existing("robust_runs", "reproduce")) if "robustness" in self._steps else []
        return Outcome(
            trial=self.trial,
            task=task,
            noise_free=Recording.load(run.existing("recording", "evaluate")),
            noisy=tuple(load_recordings(run.existing("noisy", "evaluate"))),
            perturbed=tuple(robust),
            metrics=metrics,
            learning_curve=_columns(run.existing("training_log", "train")) if learned else None,
            feasibility=muscle_feasibility(task.arm, task.reference, task.load_mass),
            seconds=seconds,
        )

    def _train(self, tell: Tell) -> None:
        def show_round(number: int, rounds: int) -> None:
            tell(self._imitation_work * number / rounds, f"imitation, round {number} of {rounds}")

        def show_batch(report: BatchReport) -> None:
            of_batches = (self._training_work - self._imitation_work) * report.batch / report.batches
            tell(self._imitation_work + of_batches, f"batch {report.batch} of {report.batches}")

        tell(0.0, "training")
        train_step(
            self.run,
            seed=self.trial.seed,
            batches=self.batches,
            resume=True,
            on_round=show_round,
            on_batch=show_batch,
        )

    @property
    def _imitation_work(self) -> float:
        return _IMITATION_ROUND * self.settings.imitation_rounds if self.settings else 0.0

    @property
    def _training_work(self) -> float:
        s = self.settings
        return self._imitation_work + s.batches * s.environments * s.steps if s else 0.0

    def _record(self) -> dict[str, Any]:
        settings = asdict(self.settings) if self.settings else None
        return json.loads(json.dumps({"settings": settings, "versions": versions()}))

    def _recorded(self) -> dict[str, Any] | None:
        """The record in the folder; None if the trial has not got so far."""
        file = self.run.folder / _RECORD
        return read_json(file, RunFolderError) if file.exists() else None

    def _problem(self) -> str | None:
        """What is different about the folder, if it does not hold this trial."""
        recorded = self._recorded()
        if recorded is None:
            return None
        for name, value in self._record().items():
            if recorded.get(name) != value:
                return f"was made with other {name}"
        if self.run.path("scenario").exists() and not self.run.holds_plan_of(self.trial.scenario, self.preset):
            return "was made from another scenario file or arm"
        for name in _READ:
            try:
                if self.run.path(name).exists():
                    self.run.existing(name, "reproduce")
            except RunFolderError:
                return f"has another {self.run.path(name).name} than drakearm wrote"
        return None


def _settings(method: Method, training: PpoSettings, batches: int | None) -> PpoSettings | None:
    """How a method is trained; None if it does not learn."""
    if method is Method.static:
        return None
    return with_batches(PAPER if method is Method.ppo_alone else training, batches)


def _columns(log: Path) -> dict[str, np.ndarray]:
    """The columns of a training's log by their names."""
    table = np.atleast_1d(np.genfromtxt(log, delimiter=",", names=True))
    return {name: table[name] for name in table.dtype.names or ()}
