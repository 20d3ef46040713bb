"""Runs every shipped scenario, lifting with both of the paper's reward weightings, and writes docs/results.md.

`python docs/make_results.py` takes about ten minutes on two quiet cores and keeps the runs in runs/results. What is
there already is not run again: remove that folder to begin anew.
"""

import logging
from pathlib import Path
from typing import Any

import yaml
from rich.progress import track

from drakearm.experiments import RunFolder, evaluate_step, plan_step, replay_step, scenario_files, train_step

RUNS = Path("runs/results")
PAGE = Path(__file__).parent / "results.md"
WEAK_SHOULDER = 0.2  # the paper's second weighting of the lifts: elbow 1, shoulder 0.2
SEED = 0

_HEAD = f"""# Every shipped movement, planned and learned
Made by `python docs/make_results.py`: each scenario with its default settings, seed {SEED}, evaluated without noise on
the Drake Diagram. Errors are of shoulder / elbow, in rad: mean and largest over the movement, and at its end. Seconds
are of the training, imitation included, on two cores. What the muscles can do is static optimization's verdict on the
plan: where they lack torque no excitations follow the reference, and the error tells by how much.

| scenario | plan | the muscles | mean error | largest error | end error | noisy runs that succeed | training (s) |
|---|---|---|---|---|---|---|---|
"""


def main() -> None:
    logging.getLogger("drake").setLevel(logging.WARNING)  # Meshcat announces itself when a replay is written
    rows = [row(name, file) for name, file in track(list(scenarios().items()), "running")]
    PAGE.write_text(_HEAD + "\n".join(rows) + "\n", encoding="utf-8")
    print(f"wrote {PAGE}")


def scenarios() -> dict[str, Path]:
    """The shipped scenarios, and each lift once more with a weak reward for the shoulder."""
    files = dict(scenario_files())
    for name in [name for name in files if name.startswith("lift-")]:
        fields = yaml.safe_load(files[name].read_text())
        reward = fields["tracking"]["reward"]
        fields["tracking"]["reward"] = {term: [WEAK_SHOULDER * w[0], w[1]] for term, w in reward.items()}
        fields["name"] = f"{name}, shoulder {WEAK_SHOULDER}"
        file = RUNS / "scenarios" / f"{name}-weak-shoulder.yaml"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(yaml.safe_dump(fields, sort_keys=False))
        files[fields["name"]] = file
    return files


def row(name: str, file: Path) -> str:
    """A row of the table, from a run that is made if there is none."""
    run = RunFolder(RUNS / file.stem)
    if not run.path("replay").exists():
        run.claim(tuple(RunFolder.FILES), overwrite=True)
        plan_step(run, file)
        train_step(run, seed=SEED)
        evaluate_step(run)
        replay_step(run)
    plan, metrics = run.read_json("plan", "plan"), run.read_json("metrics", "evaluate")
    cells = [
        name,
        plan["status"],
        muscles(plan["feasibility"]),
        *(per_joint(metrics[key]) for key in ("tracking_error_mean", "tracking_error_max", "end_error")),
        f"{metrics['success_rate']:.0%}",
        f"{metrics['training_seconds']:.0f}",
    ]
    return f"| {' | '.join(cells)} |"


def muscles(feasibility: dict[str, Any]) -> str:
    if feasibility["feasible"]:
        return f"can, up to {feasibility['largest_activation']:.2f}"
    lacking = {joint: torque for joint, torque in feasibility["largest_reserve"].items() if torque > 0.01}
    return "lack " + ", ".join(f"{joint} {torque:.3g} Nm" for joint, torque in lacking.items())


def per_joint(values: list[float]) -> str:
    return " / ".join(f"{value:.4f}" for value in values)


if __name__ == "__main__":
    main()
