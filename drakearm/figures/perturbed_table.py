"""A table for the terminal of how well a policy follows its reference on a perturbed arm."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rich.table import Table

from drakearm.figures.fact_table import fact_table


def perturbed_table(metrics: Mapping[str, Any], joints: Sequence[str]) -> Table:
    """What perturbed.json holds, for a person. joints: names of the arm's coordinates."""
    runs = metrics["perturbed"]
    means, ends = np.array(runs["tracking_error_mean"]), np.array(runs["end_error"])

    def per_joint(values: np.ndarray) -> str:
        return ", ".join(f"{joint} {value:z.4f}" for joint, value in zip(joints, values, strict=True))

    perturbations = [
        ", ".join(f"{name} {value}" for name, value in one.items() if name != "type")
        for one in metrics["perturbations"]
    ]
    kinds = [one["type"].replace("_", " ") for one in metrics["perturbations"]]
    return fact_table(
        f"{metrics['scenario']}, perturbed, {len(means)} runs",
        {
            **dict(zip(kinds, perturbations, strict=True)),
            "mean error (rad)": per_joint(means.mean(axis=0)),
            "mean error of the worst run (rad)": per_joint(means.max(axis=0)),
            "end error (rad)": per_joint(ends.mean(axis=0)),
            **{f"success: {name}": f"{share:.0%}" for name, share in metrics["success_rate"].items()},
        },
    )
