"""Runs every shipped scenario, lifting with both of the paper's reward weightings, and writes docs/results.md.

`python docs/make_results.py` takes about ten minutes on two cores without other work and keeps the runs in
runs/results. It uses the runs that are there already: remove that folder to start again. `--quick` only checks that it
works: it trains one scenario briefly in a temporary folder and prints the page.
"""

import argparse
import logging
import tempfile
from pathlib import Path
from typing import Any

import yaml
from rich.progress import track

from drakearm.experiments import RunFolder, evaluate_step, plan_step, replay_step, scenario_files, train_step

RUNS = Path("runs/results")
PAGE = Path(__file__).parent / "results.md"
WEAK_SHOULDER = 0.2  # the paper's second weighting of the lifts: elbow 1, shoulder 0.2
SEED = 0
QUICK_SCENARIO, QUICK_BATCHES = "lift-5kg, shoulder 0.2", 2

_HEAD = f"""# Every shipped movement, planned and learned
Made by `python docs/make_results.py`: each scenario with its default settings and seed {SEED}, evaluated on the Drake
Diagram. The errors, in rad, are those of shoulder / elbow without noise on the excitations: the mean and the largest
error over the movement, and the error at its end. The training time, in seconds, includes imitation; training uses two
cores. The column "muscles" says whether static optimization finds activations that follow the plan, and up to which
activation, or how much torque the muscles lack. If they lack torque, no excitations can follow the plan, and the errors
show how far the movement is from it. The success rate is the share of the runs with noise that meet a criterion of the
scenario; its file says what the criterion asks for.

| scenario | plan | muscles | mean error | largest error | end error | success rate with noise | training (s) |
|---|---|---|---|---|---|---|---|
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="prints a page of one scenario, trained briefly")
    logging.getLogger("drake").setLevel(logging.WARNING)  # Meshcat announces itself when a replay is written
    if parser.parse_args().quick:
        with tempfile.TemporaryDirectory() as folder:
            runs = Path(folder)
            print(_HEAD + row(QUICK_SCENARIO, find_scenarios(runs)[QUICK_SCENARIO], runs, QUICK_BATCHES))
    else:
        rows = [row(name, file, RUNS) for name, file in track(list(find_scenarios(RUNS).items()), "running")]
        PAGE.write_text(_HEAD + "\n".join(rows) + "\n", encoding="utf-8")
        print(f"wrote {PAGE}")


def find_scenarios(runs: Path) -> dict[str, Path]:
    """The shipped scenarios, and each lift once more with a weak reward for the shoulder, in a file of the runs."""
    files = dict(scenario_files())
    for name in [name for name in files if name.startswith("lift-")]:
        fields = yaml.safe_load(files[name].read_text())
        reward = fields["tracking"]["reward"]
        fields["tracking"]["reward"] = {term: [WEAK_SHOULDER * w[0], w[1]] for term, w in reward.items()}
        fields["name"] = f"{name}, shoulder {WEAK_SHOULDER}"
        file = runs / "scenarios" / f"{name}-weak-shoulder.yaml"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(yaml.safe_dump(fields, sort_keys=False))
        files[fields["name"]] = file
    return files


def row(name: str, file: Path, runs: Path, batches: int | None = None) -> str:
    """A row of the table. It comes from the scenario's run, which is made if there is none yet.

    batches: of training, in place of the scenario's number.
    """
    run = RunFolder(runs / file.stem)
    if not run.path("replay").exists():
        plan_step(run, file)
        train_step(run, seed=SEED, batches=batches)
        evaluate_step(run)
        replay_step(run)
    plan, metrics = run.read_json("plan", "plan"), run.read_json("metrics", "evaluate")
    cells = [
        name,
        plan["status"],
        muscle_verdict(plan["feasibility"]),
        *(per_joint(metrics["noise_free"][key]) for key in ("tracking_error_mean", "tracking_error_max", "end_error")),
        ", ".join(f"{name} {share:.0%}" for name, share in metrics["success_rate"].items()),
        f"{metrics['training_seconds']:.0f}",
    ]
    return f"| {' | '.join(cells)} |"


def muscle_verdict(feasibility: dict[str, Any]) -> str:
    if feasibility["feasible"]:
        return f"can, up to {feasibility['largest_activation']:.2f}"
    lacking = {joint: torque for joint, torque in feasibility["largest_reserve"].items() if torque > 0.01}
    return "lack " + ", ".join(f"{joint} {torque:.3g} Nm" for joint, torque in lacking.items())


def per_joint(values: list[float]) -> str:
    return " / ".join(f"{value:.4f}" for value in values)


if __name__ == "__main__":
    main()
