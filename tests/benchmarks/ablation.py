"""What each part of learning contributes: the default and variants with one change each, for several seeds.

`python tests/benchmarks/ablation.py` trains every variant and prints one row of a table for each. The errors are means
over the movement, without noise, on the Diagram; the table has medians and the worst one over the seeds. Names of
variants select some of them. `--quick` trains each variant very briefly and only shows that it works. Rewards and
starts that no default uses are defined in this script and not in the package.
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
from drakearm.learning.input_scaling import InputScaling
from drakearm.learning.policy import Actor
from drakearm.model import load_arm
from drakearm.model.reference import Reference
from drakearm.planning import plan
from drakearm.planning.feasibility import muscle_feasibility
from drakearm.task import OBSERVATIONS, Reward, Start, StartState, TrackingTask

SCENARIO = "timing-0.7s"


@dataclass(frozen=True)
class ExponentialReward(Reward):
    """exp(r), where r is another reward: 1 for a perfect step, near 0 far from the reference."""

    type = "exponential"
    of: Reward

    @property
    def reads(self) -> tuple[str, ...]:  # type: ignore[override]
        return self.of.reads

    def __call__(self, *signals: np.ndarray) -> np.ndarray:
        return np.exp(self.of(*signals))


@dataclass(frozen=True)
class StartAnywhere(Start):
    """At a random sample of the reference (Peng et al. 2018), with the activations of static optimization."""

    activation: np.ndarray = field(compare=False)  # (N, n), one row per sample of the reference

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
    """A way to train that differs from the default in one point."""

    what: str  # how the table names it
    settings: PpoSettings = PpoSettings()  # noqa: RUF009 (it is frozen)
    change_task: Callable[[TrackingTask], TrackingTask] = lambda task: task


DEFAULT = PpoSettings()
VARIANTS = {
    "default": Variant("default"),
    # One batch, with a learning rate that is too small to change the policy.
    "imitation-alone": Variant("imitation alone", replace(DEFAULT, batches=1, learning_rate=1e-12)),
    "no-imitation": Variant("no imitation, initial noise 0.3", replace(DEFAULT, imitation_rounds=0, initial_std=0.3)),
    "learned-exploration": Variant("noise is learned, not scheduled", replace(DEFAULT, final_std=None)),
    "falling-rate": Variant(
        "learning rate falls linearly, not adapted", replace(DEFAULT, target_kl=None, learning_rate=1e-4)
    ),
    "8-minibatches": Variant("8 minibatches", replace(DEFAULT, minibatches=8)),
    "2-minibatches": Variant("2 minibatches", replace(DEFAULT, minibatches=2)),
    "no-preview": Variant("no preview of the reference", change_task=lambda task: replace(task, lookahead=(0, 0, 0))),
    "exponential-reward": Variant(
        "exponential reward, exp of eq. 6",
        change_task=lambda task: replace(task, reward=ExponentialReward(task.reward)),
    ),
    "start-anywhere": Variant("episodes start anywhere on the reference", change_task=start_anywhere),
    "paper-observation": Variant("paper's observation", change_task=paper_observation),
    "paper-settings": Variant("paper's settings, full observation", PAPER),
    "paper": Variant("preset paper", PAPER, change_task=paper_observation),
}


def shortened(settings: PpoSettings) -> PpoSettings:
    """The settings, changed for a very short training."""
    rounds = min(settings.imitation_rounds, 1)
    return replace(settings, batches=1, environments=4, steps=20, epochs=1, minibatches=1, imitation_rounds=rounds)


def measure(task: TrackingTask, settings: PpoSettings, seed: int) -> tuple[np.ndarray, float]:
    """The mean error of each joint, (n_q,), rad, and the duration of the training, s."""
    began = time.perf_counter()

    def prepare(actor: Actor) -> InputScaling:
        return imitate(actor, [task], settings.imitation_rounds, seed)

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
    parser.add_argument("--seeds", type=int, default=5, help="number of seeds, from 0")
    parser.add_argument("--quick", action="store_true", help="one seed and a very short training for each variant")
    arguments = parser.parse_args()
    if unknown := set(arguments.variants) - set(VARIANTS):
        parser.error(f"there is no variant {', '.join(sorted(unknown))}: expected names from {', '.join(VARIANTS)}")
    torch.set_num_threads(1)
    scenario = load_scenario(SCENARIO)
    task = scenario.task(plan(load_arm(scenario.arm), scenario.movement).reference)
    print("| variant | shoulder, median | elbow, median | worst joint and seed | training (s), median |")
    print("|---|---|---|---|---|", flush=True)
    for name in arguments.variants or VARIANTS:
        variant = VARIANTS[name]
        settings = shortened(variant.settings) if arguments.quick else variant.settings
        seeds = range(1 if arguments.quick else arguments.seeds)
        measured = [measure(variant.change_task(task), settings, seed) for seed in seeds]
        errors = np.array([error for error, _ in measured])
        shoulder, elbow = np.median(errors, axis=0)
        seconds = np.median([seconds for _, seconds in measured])
        row = (variant.what, f"{shoulder:.4f}", f"{elbow:.4f}", f"{errors.max():.4f}", f"{seconds:.0f}")
        print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
