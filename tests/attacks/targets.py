"""The types of files: which valid file is mutated how, and how a mutated one is read and used."""

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from drakearm.errors import RunFolderError
from drakearm.experiments import (
    RunFolder,
    evaluate_step,
    evaluation_metrics,
    load_scenario,
    make_task_env,
    replay_step,
    run_metrics,
)
from drakearm.files import read_json
from drakearm.learning import ArmVectorEnv, Policy
from drakearm.model import load_arm
from drakearm.model.equilibrium import find_equilibrium
from drakearm.model.recording import Recording, load_recordings
from drakearm.model.reference import Reference
from drakearm.planning import plan
from drakearm.task import LOOKAHEAD
from tests.attacks.binaries import mutate_npz, mutate_policy
from tests.attacks.mutations import Mutation, mutate_bytes, mutate_json, mutate_xml, mutate_yaml

STEPS = 3  # control steps that are simulated


@dataclass(frozen=True)
class Target:
    """A type of file.

    file: the valid file, relative to the folder of the seeds; of a folder, any of its files. use: reads and uses the
    file in a copy of the seeds, and returns numbers, which must be finite. share: of all cases.
    """

    name: str
    file: str
    use: Callable[[Path], Any]
    share: float

    def attack(self, seeds: Path, folder: Path, seed: int) -> Any:
        """Uses mutation number `seed` of the file. folder: is made, as a copy of the seeds with the mutated file."""
        random = Random(f"{self.name}:{seed}")
        shutil.copytree(seeds, folder)
        file = folder / self.file
        if file.is_dir():
            file = random.choice(sorted(path for path in file.iterdir() if path.is_file()))
        file.write_bytes(_MUTATIONS.get(file.suffix, mutate_bytes)(random, file.read_bytes()))
        return self.use(folder)


_MUTATIONS: dict[str, Mutation] = {
    ".json": mutate_json,
    ".npz": mutate_npz,
    ".safetensors": mutate_policy,
    ".urdf": mutate_xml,
    ".yaml": mutate_yaml,
}


def use_scenario(folder: Path) -> Any:
    """Plans a scenario's movement, and makes the task of following it."""
    scenario = load_scenario(folder / "scenario.yaml")
    found = plan(load_arm(scenario.arm), scenario.movement, scenario.load_mass, scenario.obstacle)
    task = scenario.task(found.reference)
    margins = [value for value in vars(found.verification).values() if not isinstance(value, str | None)]
    return [vars(found.reference), found.costs, margins, task.observation.size]


def use_arm(folder: Path) -> Any:
    """Holds a posture of the arm, and simulates a few steps of its diagram."""
    arm = load_arm(folder / "arm")
    equilibrium = find_equilibrium(arm, np.full(len(arm.coordinates), 0.6))
    env = make_task_env(load_scenario(folder / "scenario.yaml").task(_reference(folder)))
    observation, _ = env.reset(seed=0)
    steps = [env.step(np.full(len(arm.muscles), 0.3))[:2] for _ in range(STEPS)]
    return [equilibrium, observation, steps]


def use_reference(folder: Path) -> Any:
    """Follows a reference for a few steps."""
    task = load_scenario(folder / "scenario.yaml").task(_reference(folder))
    envs = ArmVectorEnv(task, 1)
    observation, _ = envs.reset(seed=0)
    steps = [envs.step(np.full((1, len(task.arm.muscles)), 0.3))[:2] for _ in range(STEPS)]
    return [observation, steps, task.reference.preview_trajectory(LOOKAHEAD).value(task.reference.duration)]


def use_recording(folder: Path) -> Any:
    """Computes the metrics of a recording."""
    scenario = load_scenario(folder / "scenario.yaml")
    recording = Recording.load(folder / "run" / "recording.npz")
    recording.check(load_arm(folder / "arm"))
    return run_metrics(scenario.task(_reference(folder)), recording, scenario.success)


def use_recordings(folder: Path) -> Any:
    """Computes the metrics of the runs with noise."""
    scenario = load_scenario(folder / "scenario.yaml")
    recordings = load_recordings(folder / "run" / "noisy.npz")
    recordings[0].check(load_arm(folder / "arm"))
    return evaluation_metrics(scenario.task(_reference(folder)), recordings[0], recordings, scenario.success)


def use_policy(folder: Path) -> Any:
    """Lets a policy decide the excitations for a few observations."""
    task = load_scenario(folder / "scenario.yaml").task(_reference(folder))
    policy = Policy.load(folder / "run" / "policy.safetensors")
    policy.check(task)
    rng = np.random.default_rng(0)
    observations = rng.uniform(-3.0, 3.0, (20, task.observation.size))
    return [policy.act(observations), policy.act(observations, rng)]


def use_json(file: str) -> Callable[[Path], Any]:
    """Reads a JSON file."""
    return lambda folder: read_json(folder / "run" / file, RunFolderError)


def use_run(folder: Path) -> Any:
    """Evaluates a run's policy and makes the replay."""
    run = RunFolder(folder / "run")
    metrics = evaluate_step(run)
    replay_step(run)
    return metrics


def _reference(folder: Path) -> Reference:
    return Reference.load(folder / "run" / "reference.npz")


@cache
def targets() -> dict[str, Target]:
    """All types of files, by name."""
    found = [
        Target("scenario", "scenario.yaml", use_scenario, 0.25),
        Target("muscles", "arm/muscles.yaml", use_arm, 0.2),
        Target("skeleton", "arm/skeleton.urdf", use_arm, 0.12),
        Target("reference", "run/reference.npz", use_reference, 0.12),
        Target("recording", "run/recording.npz", use_recording, 0.04),
        Target("noisy", "run/noisy.npz", use_recordings, 0.03),
        Target("policy", "run/policy.safetensors", use_policy, 0.13),
        Target("plan", "run/plan.json", use_json("plan.json"), 0.02),
        Target("training", "run/training.json", use_json("training.json"), 0.02),
        Target("metrics", "run/metrics.json", use_json("metrics.json"), 0.02),
        Target("run", "run", use_run, 0.05),
    ]
    return {target.name: target for target in found}
