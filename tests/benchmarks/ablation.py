"""What each part of learning contributes: the default and variants with one change each, on several movements.

`python tests/benchmarks/ablation.py` trains every variant and prints one row of a table for each: the mean error of the
worse joint over a movement (mrad), without noise, on the Diagram; per movement the median over the seeds, and the
largest of all. Names of variants select some of them. Trainings run in parallel, each on one core. `--quick` trains
some variants very briefly and only shows that it works. Rewards and starts that no default uses are defined in this
script and not in the package.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from unittest.mock import patch

import numpy as np
import torch
from joblib import Parallel, delayed

from drakearm.experiments.environments import scenario_task
from drakearm.experiments.metrics import run_policy
from drakearm.learning import PAPER, ArmVectorEnv, PpoSettings, prepare, train
from drakearm.learning.input_scaling import InputScaling
from drakearm.model.reference import Reference
from drakearm.planning.feasibility import muscle_feasibility
from drakearm.task import OBSERVATIONS, Reward, Start, StartState, TrackingTask

MOVEMENTS = ("reach-000", "reach-225", "timing-0.4s", "timing-0.7s", "lift-2kg")


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


@contextmanager
def without_rehearsal() -> Iterator[None]:
    """The expert aims at the reference."""
    with patch("drakearm.learning.imitation.rehearse", lambda tasks, stiffness: None):
        yield


@contextmanager
def without_scaling() -> Iterator[None]:
    """The networks get the observations as they are."""
    with patch.object(InputScaling, "of", lambda observations: InputScaling.none(observations.shape[1])):
        yield


@dataclass(frozen=True)
class Variant:
    """A way to train that differs from the default in one point."""

    what: str  # how the table names it
    settings: PpoSettings = PpoSettings()  # noqa: RUF009 (it is frozen)
    change_task: Callable[[TrackingTask], TrackingTask] = lambda task: task
    change_code: Callable[[], "contextmanager[None]"] = ExitStack  # type: ignore[assignment]


DEFAULT = PpoSettings()
WIDE = replace(DEFAULT, initial_std=0.3, final_std=0.03)
VARIANTS = {
    "default": Variant("default"),
    # One batch, with a learning rate that is too small to change the policy.
    "imitation-alone": Variant("imitation alone", replace(DEFAULT, batches=1, learning_rate=1e-12)),
    "no-rehearsal": Variant("the expert does not rehearse", change_code=without_rehearsal),
    "no-scaling": Variant("observations are not scaled", change_code=without_scaling),
    "no-imitation": Variant("no imitation, noise from 0.3 to 0.03", replace(WIDE, imitation_rounds=0)),
    "wide": Variant("noise from 0.3 to 0.03", WIDE),
    "medium": Variant("noise from 0.1 to 0.01", replace(DEFAULT, initial_std=0.1, final_std=0.01)),
    "learned-exploration": Variant("noise is learned, not scheduled", replace(DEFAULT, final_std=None)),
    "small-steps": Variant("0.02 nats per batch", replace(DEFAULT, target_kl=0.02)),
    "32-arms": Variant("32 arms", replace(DEFAULT, environments=32, epochs=10, minibatches=8)),
    "128-arms": Variant("128 arms, 30 batches", replace(DEFAULT, environments=128, batches=30, minibatches=32)),
    "narrow": Variant("layers of 32 units", replace(DEFAULT, actor_layers=(32,) * 5, critic_layers=(32,) * 3)),
    "wide-layers": Variant("layers of 128 units", replace(DEFAULT, actor_layers=(128,) * 5, critic_layers=(128,) * 3)),
    "no-preview": Variant("no preview of the reference", change_task=lambda task: replace(task, lookahead=(0, 0, 0))),
    "exponential-reward": Variant(
        "exponential reward, exp of eq. 6",
        change_task=lambda task: replace(task, reward=ExponentialReward(task.reward)),
    ),
    "start-anywhere": Variant("episodes start anywhere on the reference", change_task=start_anywhere),
    "paper-observation": Variant("paper's observation", change_task=paper_observation),
    "paper": Variant("preset paper", PAPER, change_task=paper_observation),
}


QUICK = ("default", "no-rehearsal", "no-scaling", "exponential-reward", "start-anywhere", "paper")


def shortened(settings: PpoSettings) -> PpoSettings:
    """The settings, changed for a very short training."""
    rounds = min(settings.imitation_rounds, 1)
    return replace(settings, batches=1, environments=4, steps=20, epochs=1, minibatches=1, imitation_rounds=rounds)


def measure(name: str, movement: str, seed: int, quick: bool) -> tuple[float, float]:
    """The mean error of the worse joint, rad, and the duration of the training, s."""
    torch.set_num_threads(1)
    variant = VARIANTS[name]
    settings = shortened(variant.settings) if quick else variant.settings
    task = variant.change_task(scenario_task(movement))
    began = time.perf_counter()
    with variant.change_code():
        policy = train(
            ArmVectorEnv(task, settings.environments),
            settings,
            seed=seed,
            metadata={},
            prepare=lambda actor: prepare(actor, [task], settings, seed),
        )
    seconds = time.perf_counter() - began
    recording = run_policy(task, policy)
    return float(np.abs(recording.q - recording.reference_q).mean(axis=0).max()), seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("variants", nargs="*", metavar="VARIANT", help=f"all, or some of: {', '.join(VARIANTS)}")
    parser.add_argument("--seeds", type=int, default=5, help="number of seeds, from 0")
    parser.add_argument("--jobs", type=int, default=2, help="number of trainings at the same time")
    parser.add_argument(
        "--quick", action="store_true", help="some variants, one movement and seed, and very short trainings"
    )
    arguments = parser.parse_args()
    if unknown := set(arguments.variants) - set(VARIANTS):
        parser.error(f"there is no variant {', '.join(sorted(unknown))}: expected names from {', '.join(VARIANTS)}")
    movements = MOVEMENTS[2:3] if arguments.quick else MOVEMENTS
    seeds = 1 if arguments.quick else arguments.seeds
    print(f"| variant | {' | '.join(movements)} | largest | training (s), median |")
    print(f"|{'---|' * (len(movements) + 3)}", flush=True)
    for name in arguments.variants or (QUICK if arguments.quick else VARIANTS):
        trainings = [(name, movement, seed, arguments.quick) for movement in movements for seed in range(seeds)]
        # Forked: another process could not read the rewards and starts of this script.
        workers = Parallel(n_jobs=arguments.jobs, backend="multiprocessing")
        measured = workers(delayed(measure)(*training) for training in trainings)
        errors, seconds = np.array(measured).T
        medians = np.median(1e3 * errors.reshape(len(movements), seeds), axis=1)
        cells = [*(f"{median:.1f}" for median in medians), f"{1e3 * errors.max():.1f}", f"{np.median(seconds):.0f}"]
        print(f"| {VARIANTS[name].what} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
