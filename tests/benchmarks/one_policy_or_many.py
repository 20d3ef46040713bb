"""The shipped policy for all movements beside the shipped policy of each single movement, and static optimization.

`python tests/benchmarks/one_policy_or_many.py` prints a table with the mean error of the worse joint (mrad) in each
shipped movement with up to 2 kg, without noise. The policy for all movements is not told the load. `--quick` takes two
movements.
"""

import argparse
from collections.abc import Callable

import numpy as np

from drakearm.experiments import load_scenario, scenario_files, scenario_task
from drakearm.experiments.catalog import POLICIES
from drakearm.learning import Policy
from drakearm.repertoire import held_out_errors, load_repertoire
from drakearm.repertoire.shipped import shipped_policy
from drakearm.task import TrackingTask

HEAVY = ("lift-5kg", "lift-10kg", "lift-20kg")
PAPER = [name for name in scenario_files() if load_scenario(name).arm == "arm14"]
LIGHT = [name for name in PAPER if not name.startswith(HEAVY)]


def milliradians(task: TrackingTask, act: Callable[[np.ndarray], np.ndarray] | None) -> str:
    """The mean error of the worse joint."""
    return f"{1e3 * held_out_errors([task], act).mean[0]:.1f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two movements")
    names = LIGHT[:2] if parser.parse_args().quick else LIGHT
    repertoire, general = load_repertoire("reaching"), shipped_policy("reaching")
    print("| movement | policy for all movements | policy of this movement | static optimization, told the load |")
    print("|---|---|---|---|")
    for name in names:
        task = scenario_task(name)
        own = Policy.load(POLICIES / name / "policy.safetensors")
        of_all = milliradians(repertoire.task(task.reference, task.load_mass), general.act)
        print(f"| {name} | {of_all} | {milliradians(task, own.act)} | {milliradians(task, None)} |")


if __name__ == "__main__":
    main()
