"""The caption of a replay: what moves, its errors, and whether it succeeded."""

from collections.abc import Mapping
from typing import Any

from drakearm.replay import Caption


def caption(title: str, description: str, metrics: Mapping[str, Any], weakness: str = "") -> Caption:
    """metrics: of `run_metrics`. weakness: why the muscles cannot make the movement; empty if they can."""
    mean, end = max(metrics["tracking_error_mean"]), max(metrics["end_error"])
    errors = f"mean error {mean:.3f} rad, at the end {end:.3f} rad and {metrics['hand_end_error_cm']:.1f} cm"
    lines = [line for line in (description, errors) if line]
    missed = [name.replace("_", " ") for name, met in metrics["success"].items() if not met]
    if missed:
        verdict = weakness or f"failed: {', '.join(missed)}"
        return Caption(title, lines, verdict, failed=True)
    return Caption(title, lines, weakness or ("succeeded" if metrics["success"] else ""), failed=bool(weakness))
