"""Ships the policies of a reproduction: copies those of the default method and the first seed into the package.

First `drakearm reproduce all --out FOLDER`, then `python docs/make_policies.py FOLDER`. With the folder of `drakearm
learn --out FOLDER` or `drakearm run rat-swing --out FOLDER` it ships that policy. `--quick` only checks that it
works: it trains one movement briefly and copies its policy into a temporary folder.
"""

import argparse
import tempfile
from pathlib import Path

from drakearm.experiments import RunFolder, evaluate_step, plan_step, scenario_files, train_step
from drakearm.experiments.catalog import POLICIES
from drakearm.experiments.shipped import ship
from drakearm.repertoire.folder import FILES
from drakearm.repertoire.shipped import ship as ship_repertoire
from drakearm.reproduction.trial import Method

QUICK = "timing-0.4s"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", help="the folder of a reproduction, or of what was learned")
    parser.add_argument(
        "--quick", action="store_true", help="ships one movement, trained briefly, into a temporary folder"
    )
    options = parser.parse_args()
    if options.quick:
        with tempfile.TemporaryDirectory() as folder:
            run = RunFolder(Path(folder) / "run")
            plan_step(run, QUICK)
            train_step(run, seed=0, batches=1)
            evaluate_step(run)
            show([ship(run, Path(folder))])
    elif options.folder is None:
        parser.error("expected the folder of a reproduction, or --quick")
    elif (options.folder / FILES["errors"]).exists():
        show([ship_repertoire(options.folder, POLICIES)])
    elif RunFolder(options.folder).path("policy").exists():
        show([ship(RunFolder(options.folder), POLICIES)])
    else:
        reproduced = [name for name in scenario_files() if (options.folder / "trials" / name).is_dir()]
        trials = [options.folder / "trials" / name / Method.default.name / "seed-0" for name in reproduced]
        show([ship(RunFolder(trial), POLICIES) for trial in trials])


def show(folders: list[Path]) -> None:
    print("| policy | kB |\n|---|---|")
    for folder in folders:
        print(f"| {folder.name} | {sum(file.stat().st_size for file in folder.iterdir()) // 1000} |")


if __name__ == "__main__":
    main()
