"""What each part of learning is worth: the default with one thing changed, over some seeds.

`python tests/benchmarks/ablation.py` prints a row of a table for each variant when it is done: errors without noise on
the Diagram, means over the movement; medians and the worst over the seeds. Names of variants select some of them.
`--quick` trains each variant for a moment only, to show that it runs. What no default uses is defined here and not in
the package.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import torch

from drakearm.experiments.metrics import run_policy
from drakearm.experiments.scenario import load_scenario
from drakearm.learning import PAPER, ArmVectorEnv, PpoSettings, imitate, train
from drakearm.learning.policy import Actor
from drakearm.model import load_arm
from drakearm.model.reference import Reference
from drakearm.planning import plan
from drakearm.planning.feasibility import muscle_feasibility
from drakearm.task import OBSERVATIONS, Reward, Start, StartState, TrackingTask

SCENARIO = "timing-0.7s"


@dataclass(frozen=True)
class ExponentialReward(Reward):
    """exp(r) of another reward r: 1 for a perfect step and near 0 far from the reference."""

    type = "exponential"
    of: Reward

    @property
    def reads(self) -> tuple[str, ...]:  # type: ignore[override]
        return self.of.reads

    def __call__(self, *signals: np.ndarray) -> np.ndarray:
        return np.exp(self.of(*signals))


@dataclass(frozen=True)
class StartAnywhere(Start):
    """At a random sample of the reference (Peng et al. 2018), with static optimization's activations."""

    activation: np.ndarray = field(compare=False)  # (N, n), of the reference's samples

    def __call__(self, reference: Reference, rng: np.random.Generator | None) -> StartState:
        step = 0 if rng is None else int(rng.integers(len(reference.t) - 1))
        return StartState(reference.q[step], reference.v[step], self.activation[step], step)


def start_anywhere(task: TrackingTask) -> TrackingTask:
    activation = muscle_feasibility(task.arm, task.reference, task.load_mass).activation
    return replace(task, start=StartAnywhere(activation))


def paper_observation(task: TrackingTask) -> TrackingTask:
    return replace(task, senses=OBSERVATIONS["paper"])


@dataclass(frozen=True)
class Variant:
    """One thing that is done differently."""

    what: str
    settings: PpoSettings = PpoSettings()  # noqa: RUF009 (it is frozen)
    of_task: Callable[[TrackingTask], TrackingTask] = lambda task: task


DEFAULT = PpoSettings()
VARIANTS = {
    "default": Variant("default"),
    # One batch, with a learning rate that changes nothing.
    "imitation-alone": Variant("imitation alone", replace(DEFAULT, batches=1, learning_rate=1e-12)),
    "no-imitation": Variant("no imitation, first deviation 0.3", replace(DEFAULT, imitation_rounds=0, initial_std=0.3)),
    "learned-exploration": Variant("exploration is learned, not faded", replace(DEFAULT, final_std=None)),
    "falling-rate": Variant(
        "learning rate falls instead of holding the divergence", replace(DEFAULT, target_kl=None, learning_rate=1e-4)
    ),
    "8-minibatches": Variant("8 minibatches", replace(DEFAULT, minibatches=8)),
    "2-minibatches": Variant("2 minibatches", replace(DEFAULT, minibatches=2)),
    "no-preview": Variant("no preview of the reference", of_task=lambda task: replace(task, lookahead=(0, 0, 0))),
    "exponential-reward": Variant(
        "exponential reward", of_task=lambda task: replace(task, reward=ExponentialReward(task.reward))
    ),
    "start-anywhere": Variant("episodes start anywhere on the reference", of_task=start_anywhere),
    "paper-observation": Variant("paper's observation", of_task=paper_observation),
    "paper-settings": Variant("paper's settings, full observation", PAPER),
    "paper": Variant("preset paper", PAPER, of_task=paper_observation),
}


def quickened(settings: PpoSettings) -> PpoSettings:
    """The same settings for a moment's training."""
    rounds = min(settings.imitation_rounds, 1)
    return replace(settings, batches=1, environments=4, steps=20, epochs=1, minibatches=1, imitation_rounds=rounds)


def measure(task: TrackingTask, settings: PpoSettings, seed: int) -> tuple[np.ndarray, float]:
    """The mean error of each joint (n_q,), rad, and the seconds of training."""
    began = time.perf_counter()

    def prepare(actor: Actor) -> None:
        imitate(actor, [task], settings.imitation_rounds, seed)

    policy = train(
        ArmVectorEnv(task, settings.environments),
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
    parser.add_argument("--quick", action="store_true", help="one seed and a moment's training for each variant")
    arguments = parser.parse_args()
    if unknown := set(arguments.variants) - set(VARIANTS):
        parser.error(f"there is no variant {', '.join(sorted(unknown))}: expected some of {', '.join(VARIANTS)}")
    torch.set_num_threads(1)
    scenario = load_scenario(SCENARIO)
    task = scenario.task(plan(load_arm(scenario.arm), scenario.movement).reference)
    print("| variant | shoulder, median | elbow, median | worst joint and seed | training (s), median |")
    print("|---|---|---|---|---|", flush=True)
    for name in arguments.variants or VARIANTS:
        variant = VARIANTS[name]
        settings = quickened(variant.settings) if arguments.quick else variant.settings
        seeds = range(1 if arguments.quick else arguments.seeds)
        measured = [measure(variant.of_task(task), settings, seed) for seed in seeds]
        errors = np.array([error for error, _ in measured])
        shoulder, elbow = np.median(errors, axis=0)
        seconds = np.median([seconds for _, seconds in measured])
        row = (variant.what, f"{shoulder:.4f}", f"{elbow:.4f}", f"{errors.max():.4f}", f"{seconds:.0f}")
        print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
