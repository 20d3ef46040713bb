"""A table for the terminal of how well a policy follows its reference."""

from collections.abc import Mapping, Sequence
from typing import Any

from rich.table import Table

from drakearm.figures.fact_table import fact_table


def metrics_table(metrics: Mapping[str, Any], plan: Mapping[str, Any], joints: Sequence[str]) -> Table:
    """What metrics.json and plan.json hold, for a person. joints: names of the arm's coordinates."""

    def per_joint(values: list[float]) -> str:
        return ", ".join(f"{joint} {value:.4f}" for joint, value in zip(joints, values, strict=True))

    steps, seconds = metrics["training_steps"], metrics["training_seconds"]
    return fact_table(
        f"{metrics['scenario']}, seed {metrics['seed']}",
        {
            "plan": f"{plan['solver']}: {plan['status']}, {plan['seconds']:.2f} s",
            "training": f"{steps} steps, {steps / seconds:.0f} steps/s, {seconds:.0f} s",
            "mean error (rad)": per_joint(metrics["tracking_error_mean"]),
            "largest error (rad)": per_joint(metrics["tracking_error_max"]),
            "end error (rad)": per_joint(metrics["end_error"]),
            "noisy runs that succeed": f"{metrics['success_rate']:.0%}",
        },
    )
