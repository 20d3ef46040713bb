"""What each part of learning a repertoire contributes: the shipped `reaching` and variants with one change each.

`python tests/benchmarks/repertoire_ablation.py` learns every variant from the same library, which is smaller than the
shipped one, and prints one row of a table for each: errors in movements that no variant has seen, without noise. A
number is the median over the seeds; the last columns have the worst seed and the duration of a training. Names of
variants select some of them. Trainings run in parallel, each on one core. `--quick` trains some variants very briefly
and only shows that it works.
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from joblib import Parallel, delayed

from drakearm.learning import ArmVectorEnv, Policy, prepare, train
from drakearm.planning import Library, plan_library
from drakearm.repertoire import Repertoire, held_out_errors, load_repertoire
from drakearm.task import OBSERVATIONS, RewardWeights, TrackingTask

MOVEMENTS, HELD_OUT = 384, 200
HELD_OUT_SEED = 2**31 + 100  # the shipped policy is tested with another seed
SHORTER: dict[str, Any] = {"batches": 100, "imitation_rounds": 4}  # a training takes about 80 s of one core
SQUARES = RewardWeights(position=(10.0, 10.0), velocity=(0.1, 0.1), acceleration=(1e-6, 1e-6))
Change = Callable[[TrackingTask], TrackingTask]


def without(*names: str) -> Change:
    """Leaves senses out of the observation."""
    return lambda task: replace(task, senses=tuple(sense for sense in task.senses if sense.name not in names))


@dataclass(frozen=True)
class Variant:
    """A way to learn that differs from the shipped one in one point."""

    what: str  # how the table names it
    settings: dict[str, Any] = field(default_factory=dict)
    change_task: Change = lambda task: task


VARIANTS = {
    "default": Variant("default"),
    # One batch, with a learning rate that is too small to change the policy.
    "imitation-alone": Variant("imitation alone", {"batches": 1, "learning_rate": 1e-12}),
    "squares": Variant("squared errors, as in the paper", change_task=lambda task: replace(task, reward=SQUARES)),
    "no-imitation": Variant("no imitation, noise from 0.3", {"imitation_rounds": 0, "initial_std": 0.3}),
    "no-small-errors": Variant("without small_tracking_error", change_task=without("small_tracking_error")),
    "no-integral": Variant("without accumulated_error", change_task=without("accumulated_error")),
    "no-force": Variant("without tendon_force", change_task=without("tendon_force")),
    "no-recent": Variant("without recent_excitation", change_task=without("recent_excitation")),
    "less-noise": Variant("noise from 0.03", {"initial_std": 0.03}),
    "64-arms": Variant("64 arms", {"environments": 64, "minibatches": 8}),
    "narrow": Variant("layers of half the width", {"actor_layers": "half"}),
    "full": Variant("senses: full", change_task=lambda task: replace(task, senses=OBSERVATIONS["full"])),
    "soft-teacher": Variant("teacher of 400/s^2", {"imitation_stiffness": 400.0}),
    "more-noise": Variant("noise from 0.2", {"initial_std": 0.2}),
    "384-arms": Variant("384 arms, half the batches", {"environments": 384, "minibatches": 48, "batches": 50}),
}
QUICK = ("default", "imitation-alone", "squares", "no-force")


def settings_of(repertoire: Repertoire, variant: Variant, quick: bool) -> Any:
    """The settings of a training."""
    changes = SHORTER | variant.settings
    if changes.get("actor_layers") == "half":
        changes["actor_layers"] = [width // 2 for width in repertoire.training.actor_layers]
    if quick:
        changes |= {"batches": 1, "imitation_rounds": 1, "environments": 4, "steps": 20, "epochs": 1, "minibatches": 1}
    return replace(repertoire.training, **changes)


def measure(name: str, seed: int, library: Path, held_out: Path, quick: bool) -> tuple[dict[str, float], float]:
    """The errors of a variant in held-out movements, see `Errors.summary`, and the duration of its training, s."""
    torch.set_num_threads(1)
    repertoire, variant = load_repertoire("reaching"), VARIANTS[name]
    settings = settings_of(repertoire, variant, quick)
    tasks, unseen = (
        [variant.change_task(task) for task in repertoire.tasks(Library.load(file))] for file in (library, held_out)
    )
    began = time.perf_counter()
    policy: Policy = train(
        ArmVectorEnv(tasks, settings.environments, redraw=True),
        settings,
        seed=seed,
        metadata={},
        prepare=lambda actor: prepare(actor, tasks, settings, seed),
    )
    seconds = time.perf_counter() - began
    return held_out_errors(unseen, policy.act).summary(), seconds


def row(what: str, errors: Sequence[dict[str, float]], seconds: Sequence[float]) -> str:
    """A line of the table."""
    every = {name: np.array([each[name] for each in errors]) for name in errors[0]}
    median = {name: float(np.median(values)) for name, values in every.items()}
    cells = (
        what,
        f"{1e3 * median['mean_error_median_rad']:.1f}",
        f"{1e3 * median['mean_error_95_rad']:.1f}",
        f"{median['hand_end_median_cm']:.2f}",
        f"{median['hand_end_95_cm']:.2f}",
        f"{100 * median['share_within_1_cm']:.1f}",
        f"{1e3 * every['mean_error_median_rad'].max():.1f}",
        f"{1e3 * every['mean_error_95_rad'].max():.1f}",
        f"{np.median(seconds):.0f}",
    )
    return f"| {' | '.join(cells)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("variants", nargs="*", metavar="VARIANT", help=f"all, or some of: {', '.join(VARIANTS)}")
    parser.add_argument("--seeds", type=int, default=3, help="number of seeds, from 0")
    parser.add_argument("--jobs", type=int, default=2, help="number of trainings at the same time")
    parser.add_argument("--quick", action="store_true", help="some variants, one seed, and very short trainings")
    arguments = parser.parse_args()
    if unknown := set(arguments.variants) - set(VARIANTS):
        parser.error(f"there is no variant {', '.join(sorted(unknown))}: expected names from {', '.join(VARIANTS)}")
    seeds, counts = (1, (4, 3)) if arguments.quick else (arguments.seeds, (MOVEMENTS, HELD_OUT))
    repertoire = load_repertoire("reaching")
    arm, source = repertoire.loaded_arm, repertoire.movements.source
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder, name) for name in ("library.npz", "held_out.npz")]
        for file, count, seed in zip(files, counts, (100, HELD_OUT_SEED), strict=True):
            plan_library(arm, source, count, seed).save(file)
        print("| variant | median | 95 % | hand | hand, 95 % | within 1 cm | worst median | worst 95 % | s |")
        print(f"|{'---|' * 9}", flush=True)
        for name in arguments.variants or (QUICK if arguments.quick else VARIANTS):
            # Forked: another process could not read what this script defines.
            workers = Parallel(n_jobs=arguments.jobs, backend="multiprocessing")
            measured = workers(delayed(measure)(name, seed, *files, arguments.quick) for seed in range(seeds))
            print(row(VARIANTS[name].what, *zip(*measured, strict=True)), flush=True)


if __name__ == "__main__":
    main()
