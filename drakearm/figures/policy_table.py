"""A table for the terminal of how well a policy follows its reference."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rich.table import Table
from rich.text import Text

_PER_JOINT = {
    "tracking_error_mean": "mean error, {} (rad)",
    "tracking_error_max": "largest error, {} (rad)",
    "end_error": "end error, {} (rad)",
}
_PER_RUN = {
    "hand_end_error_cm": "end error, hand (cm)",
    "hand_end_speed": "end speed, hand (m/s)",
    "squared_activation": "squared activations (s)",
    "metabolic_energy": "metabolic energy (J)",
}
_ERRORS = {
    "tracking_error_mean": "mean error (rad)",
    "tracking_error_max": "largest error (rad)",
    "end_error": "end error (rad)",
}
_HAND = "hand_end_error_cm"
_CLEARANCE = "_clearance_cm"  # the end of the keys that belong to the parts of the arm


def metrics_table(metrics: Mapping[str, Any], plan: Mapping[str, Any]) -> Table:
    """What metrics.json and plan.json hold, for a person."""
    noisy, success = metrics["noisy"], metrics["noise_free"]["success"]
    steps, seconds = metrics["training_steps"], metrics["training_seconds"]
    table = Table(
        title=Text(f"{metrics['scenario']}, seed {metrics['seed']}"),
        caption=Text(
            f"planned: {plan['solver']}: {plan['status']}, {plan['seconds']:.2f} s without compilation\n"
            f"trained: {steps} steps, {steps / seconds:.0f} steps/s, {seconds:.0f} s"
        ),
        caption_justify="left",
    )
    for heading in ("", "without noise", f"{len(noisy['success'])} runs with noise: mean (least to largest)"):
        table.add_column(heading, no_wrap=not heading)
    for name, value, values in _quantities(metrics):
        spread = f"{_number(sum(values) / len(values))} ({_number(min(values))} to {_number(max(values))})"
        table.add_row(Text(name), _number(value), spread)
    for name, share in metrics["success_rate"].items():
        table.add_row(Text(f"success: {name}"), "yes" if success[name] else "no", f"{share:.0%}")
    return table


def evaluations_table(evaluations: Sequence[Mapping[str, Any]]) -> Table:
    """One row for each metrics.json: the errors of its run without noise, and the successes of all of its runs."""
    table = Table(caption=Text("errors without noise, of the joint with the larger one"), caption_justify="left")
    for heading in ("scenario", *_ERRORS.values(), _PER_RUN[_HAND], "success", "with noise"):
        table.add_column(heading, justify="left" if heading == "scenario" else "right")
    for metrics in evaluations:
        run, noisy = metrics["noise_free"], metrics["noisy"]["success"]
        errors = [*(max(run[key]) for key in _ERRORS), run[_HAND]]
        reached = "yes" if all(run["success"].values()) else "no"
        share = sum(all(success.values()) for success in noisy) / len(noisy)
        table.add_row(Text(metrics["scenario"]), *map(_number, errors), reached, f"{share:.0%}")
    return table


def _quantities(metrics: Mapping[str, Any]) -> Iterator[tuple[str, float, Sequence[float]]]:
    """Name, value without noise, and values with noise, of each number that runs have."""
    noise_free, noisy = metrics["noise_free"], metrics["noisy"]
    for key, name in _PER_JOINT.items():
        for j, joint in enumerate(metrics["joints"]):
            yield name.format(joint), noise_free[key][j], [run[j] for run in noisy[key]]
    parts = [key for key in noise_free if key.endswith(_CLEARANCE)]
    names = _PER_RUN | {key: f"clearance, {key.removesuffix(_CLEARANCE)} (cm)" for key in parts}
    for key, name in names.items():
        yield name, noise_free[key], noisy[key]


def _number(value: float) -> str:
    return f"{value:z.3g}"
