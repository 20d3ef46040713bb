"""What each part of learning is worth: the default with one thing changed, over some seeds.

`python tests/benchmarks/ablation.py` prints a row of a table for every variant as it comes: errors without noise on the
Diagram, means over the movement, of which medians and the worst over the seeds. Names of variants choose among them.
What no default uses lives here and not in the package.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import gymnasium
import numpy as np
import torch
from gymnasium.vector import VectorEnv

from drakearm.diagrams import TrackingTask
from drakearm.experiments.metrics import run_policy
from drakearm.experiments.scenario import load_scenario
from drakearm.learning import PAPER, ArmVectorEnv, PpoSettings, imitate, train
from drakearm.learning.policy import Actor
from drakearm.model import load_arm
from drakearm.model.musculature import resting_states
from drakearm.model.reference import Reference
from drakearm.planning import plan
from drakearm.planning.feasibility import muscle_feasibility

SCENARIO = "timing-0.7s"


class Unforeseen(Reference):
    """A reference that shows the present wherever its preview should show what comes."""

    def preview(self, lookahead: tuple[int, ...] = (0,)) -> np.ndarray:
        return super().preview((0,) * len(lookahead))


class ExponentialReward(gymnasium.vector.VectorWrapper):
    """exp(r) for every reward r: 1 for a perfect step and near 0 far from the reference."""

    def step(self, actions: np.ndarray) -> tuple[Any, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        observation, reward, terminated, truncated, info = self.env.step(actions)
        return observation, np.exp(reward), terminated, truncated, info


class StartsAnywhere(ArmVectorEnv):
    """Episodes start at a random sample of the reference (Peng et al. 2018), with static optimization's activations."""

    def __init__(self, task: TrackingTask, num_envs: int):
        super().__init__(task, num_envs)
        q = task.reference.q
        activation = muscle_feasibility(task.arm, task.reference, task.load_mass).activation
        self._states = np.concatenate([resting_states(task.arm, q[k : k + 1], activation[k]) for k in range(len(q))])

    def _restart(self, which: np.ndarray) -> None:
        super()._restart(which)
        rows = np.array([self._generators[k].integers(self._last[k]) for k in np.flatnonzero(which)])
        self._row[which] = rows
        self._set_state(which, self._wanted[rows], self._states[rows])


@dataclass(frozen=True)
class Variant:
    """How one thing is done differently."""

    what: str
    settings: PpoSettings = PpoSettings()  # noqa: RUF009 (it is frozen)
    of_task: Callable[[TrackingTask], TrackingTask] = lambda task: task
    envs: Callable[[TrackingTask, int], VectorEnv] = ArmVectorEnv


DEFAULT = PpoSettings()
VARIANTS = {
    "default": Variant("default"),
    # One batch at a rate that moves nothing.
    "imitation-alone": Variant("imitation alone", replace(DEFAULT, batches=1, learning_rate=1e-12)),
    "no-imitation": Variant("no imitation, first deviation 0.3", replace(DEFAULT, imitation_rounds=0, initial_std=0.3)),
    "learned-exploration": Variant("exploration is learned, not faded", replace(DEFAULT, final_std=None)),
    "falling-rate": Variant(
        "learning rate falls instead of holding the divergence", replace(DEFAULT, target_kl=None, learning_rate=1e-4)
    ),
    "8-minibatches": Variant("8 minibatches", replace(DEFAULT, minibatches=8)),
    "2-minibatches": Variant("2 minibatches", replace(DEFAULT, minibatches=2)),
    "no-preview": Variant(
        "no preview of the reference",
        of_task=lambda task: replace(task, reference=Unforeseen(**vars(task.reference))),
    ),
    "exponential-reward": Variant(
        "exponential reward", envs=lambda task, num_envs: ExponentialReward(ArmVectorEnv(task, num_envs))
    ),
    "start-anywhere": Variant("episodes start anywhere on the reference", envs=StartsAnywhere),
    "paper-observation": Variant("paper's observation", of_task=lambda task: replace(task, observation="paper")),
    "paper-settings": Variant("paper's settings, full observation", PAPER),
    "paper": Variant("preset paper", PAPER, of_task=lambda task: replace(task, observation="paper")),
}


def measure(task: TrackingTask, variant: Variant, seed: int) -> tuple[np.ndarray, float]:
    """The mean error of each joint (n_q,), rad, and the seconds of training."""
    task, settings, began = variant.of_task(task), variant.settings, time.perf_counter()

    def prepare(actor: Actor) -> None:
        imitate(actor, [task], settings.imitation_rounds, seed)

    policy = train(
        variant.envs(task, settings.environments),
        settings,
        seed=seed,
        metadata={},
        prepare=prepare if settings.imitation_rounds else None,
    )
    seconds = time.perf_counter() - began
    recording = run_policy(task, policy)
    return np.abs(recording.q - recording.reference_q).mean(axis=0), seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("variants", nargs="*", metavar="VARIANT", help=f"all, or some of: {', '.join(VARIANTS)}")
    parser.add_argument("--seeds", type=int, default=5, help="how many")
    arguments = parser.parse_args()
    if unknown := set(arguments.variants) - set(VARIANTS):
        parser.error(f"there is no variant {', '.join(sorted(unknown))}: expected some of {', '.join(VARIANTS)}")
    torch.set_num_threads(1)
    scenario = load_scenario(SCENARIO)
    task = scenario.task(plan(load_arm(scenario.arm), scenario.movement).reference)
    print("| variant | shoulder, median | elbow, median | worst joint and seed | training (s), median |")
    print("|---|---|---|---|---|", flush=True)
    for name in arguments.variants or VARIANTS:
        measured = [measure(task, VARIANTS[name], seed) for seed in range(arguments.seeds)]
        errors = np.array([error for error, _ in measured])
        shoulder, elbow = np.median(errors, axis=0)
        seconds = np.median([seconds for _, seconds in measured])
        row = (VARIANTS[name].what, f"{shoulder:.4f}", f"{elbow:.4f}", f"{errors.max():.4f}", f"{seconds:.0f}")
        print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
