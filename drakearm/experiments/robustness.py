"""How robust a run is: with all perturbations of its scenario file, and with one perturbation at a time.

The policy of the run moves the arm; without a training, static optimization does.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from drakearm.diagrams import Perturbation
from drakearm.experiments.metrics import STOCHASTIC_RUNS, metrics_of_runs, versions
from drakearm.experiments.perturbed import SEED, run_policy_perturbed
from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.static import run_static
from drakearm.learning import Policy
from drakearm.model.loader import arm_folder
from drakearm.model.recording import Recording, save_recordings
from drakearm.task import TrackingTask

ROBUST_RUNS = 12  # of each movement: 48 of the four timed movements, as in the paper
SINGLE: dict[str, list[dict[str, Any]]] = {  # name and what it consists of, as in a scenario file
    "none": [],
    "push of 2 Nm at 0.3 s for 0.1 s": [{"type": "push", "torque": 2.0, "start": 0.3, "duration": 0.1}],
    "1 kg in the hand": [{"type": "extra_load", "mass": 1.0}],
    "muscles with 80 % of their strength": [{"type": "strength", "factor": 0.8}],
    "motor noise of 20 %": [{"type": "motor_noise", "share": 0.2}],
    "senses 20 ms late": [{"type": "sensor_delay", "delay": 0.02}],
    "senses 50 ms late": [{"type": "sensor_delay", "delay": 0.05}],
}


def robust_step(run: RunFolder) -> dict[str, Any]:
    """Runs ROBUST_RUNS times with the perturbations of the scenario. Writes the recordings and robustness.json."""
    with run.locked():
        scenario = run.scenario()
        task = run.task(scenario)
        recordings = _runs(run, task, scenario.perturbations, ROBUST_RUNS)
        metrics = {
            "scenario": scenario.name,
            **metrics_of_runs("perturbed", task, recordings, scenario.success),
            "seed": SEED,
            "versions": versions(),
        }
        with run.replacing("robust", arm_folder(scenario.arm)) as new:
            save_recordings(recordings, new.path("robust_runs"))
            new.write_record(metrics)
        return metrics


def single_step(run: RunFolder) -> dict[str, Any]:
    """Runs STOCHASTIC_RUNS times with each of `SINGLE`. Writes single_perturbations.json and returns its content.

    tracking_error_mean: for each name, the mean error (rad) of each joint, over all runs.
    """
    with run.locked():
        scenario = run.scenario()
        task = run.task(scenario)
        errors = {}
        for name, contents in SINGLE.items():
            runs = _runs(run, task, [Perturbation.read(content) for content in contents], STOCHASTIC_RUNS)
            errors[name] = np.mean([np.abs(each.q - each.reference_q).mean(axis=0) for each in runs], axis=0).tolist()
        content = {"scenario": scenario.name, "tracking_error_mean": errors, "seed": SEED, "versions": versions()}
        with run.replacing("single", arm_folder(scenario.arm)) as new:
            new.write_record(content)
        return content


def _runs(run: RunFolder, task: TrackingTask, perturbations: Sequence[Perturbation], count: int) -> list[Recording]:
    if not run.path("training").exists():
        return run_static(task, perturbations, seed=SEED, runs=count)
    policy = Policy.load(run.existing("policy", "train"))
    return run_policy_perturbed(task, policy, perturbations, seed=SEED, runs=count)
