"""The table of the errors with one perturbation at a time, of which no method knows."""

from collections.abc import Sequence

from drakearm.experiments.robustness import SINGLE
from drakearm.reproduction.page import Table
from drakearm.reproduction.trial import Method
from drakearm.reproduction.trial_folder import TrialFolder


def perturbation_table(folders: Sequence[TrialFolder]) -> Table | None:
    """The mean errors of those trials that ran with one perturbation at a time; None if there are none."""
    found = {
        folder.trial.method: folder.run.read_json("single", "reproduce")
        for folder in folders
        if folder.run.path("single").exists()
    }
    if not found:
        return None
    scenario = next(iter(found.values()))["scenario"]
    errors = {method: content["tracking_error_mean"] for method, content in found.items()}
    rows = [
        ("", [name, *(_text(errors[method][name]) if method in errors else "" for method in Method)]) for name in SINGLE
    ]
    title = f"One perturbation at a time: mean error per joint in {scenario} (rad)"
    return Table(title, ("perturbation", *Method), rows)


def _text(errors: Sequence[float]) -> str:
    return " / ".join(f"{error:.3f}" for error in errors)
