"""A table of an inspected arm's muscles for the terminal."""

from collections.abc import Iterable, Iterator

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from drakearm.model.inspection import Inspection, Interval, MuscleInspection
from drakearm.model.musculature import RESTING_ACTIVATION
from drakearm.model.point_paths import described_posture

_COLUMNS = (
    "muscle",
    "model",
    "tendon",
    "force\nN",
    "opt.\nfiber\nmm",
    "slack\nmm",
    "penn.\n°",
    "mass\ng",
    "moment arm\nmm",
    "working\nrange",
)


def muscle_table(inspection: Inspection) -> Table:
    """One row per muscle; below the table what its columns mean, and where muscles have no equilibrium."""
    table = Table(
        title=Text(f"{inspection.arm.name}: {len(inspection.muscles)} muscles"),
        caption=Text(_caption(inspection)),
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        padding=0,
        show_edge=False,
    )
    for column in _COLUMNS:
        number = column not in ("muscle", "model", "tendon", "moment arm\nmm")
        table.add_column(column, justify="right" if number else "left", no_wrap=not column.startswith("moment"))
    for inspected in inspection.muscles:
        table.add_row(*map(Text, _row(inspected)))
    return table


def _row(inspected: MuscleInspection) -> tuple[str, ...]:
    m, working = inspected.muscle, inspected.working
    works = _range(working.fiber_length, "z.2f") if working.fiber_length else "none"
    return (
        m.name,
        m.model,
        m.tendon,
        f"{m.max_isometric_force:.4g}",
        f"{1e3 * m.optimal_fiber_length:.4g}",
        f"{1e3 * m.tendon_slack_length:.4g}",
        f"{np.rad2deg(m.pennation_angle):.1f}",
        f"{1e3 * m.mass:.0f}",
        "\n".join(f"{c.coordinate} {_range(c.moment_arm_range, 'z.0f', 1e3)}" for c in inspected.crossings),
        works + ("*" if working.slack else ""),
    )


def _caption(inspection: Inspection) -> str:
    ranges = ", ".join(f"{name} {_degrees(r)}" for name, r in inspection.ranges.items())
    lines = [
        f"Ranges are over the joint ranges: {ranges}. A positive moment arm raises the angle. Working range: fiber "
        f"length in equilibrium at activation {RESTING_ACTIVATION:g}, in optimal fiber lengths. Force: maximum "
        "isometric force. Fiber: optimal length. Slack: slack length of the tendon. Penn.: pennation at the optimal "
        "fiber length. Mass: of the fibers."
    ]
    lines += _computed(inspection)
    for inspected in inspection.muscles:
        working = inspected.working
        if working.fiber_length is None:
            lines.append(f"* {inspected.muscle.name} has no equilibrium: its tendon is slack everywhere.")
        elif working.slack:
            where = ", ".join(f"{name} {_degrees(r)}" for name, r in working.slack.items())
            lines.append(
                f"* {inspected.muscle.name} has no equilibrium where its path is shorter than "
                f"{1e3 * working.shortest_path:.1f} mm; this happens within {where}."
            )
    return "\n".join(lines)


def _computed(inspection: Inspection) -> Iterator[str]:
    """What is not in the file, but was computed from it."""
    fits = inspection.fitted
    if fits:
        length = max(fits, key=lambda name: fits[name].length_error)
        moment_arm = max(fits, key=lambda name: fits[name].moment_arm_share)
        yield (
            f"{_listed(fits)}: path functions that are fitted to the points, with errors of at most "
            f"{1e3 * fits[length].length_error:.2g} mm in length ({length}) and "
            f"{100 * fits[moment_arm].moment_arm_share:.2g}% of the largest moment arm ({moment_arm})."
        )
        for name, fit in fits.items():
            if not fit.is_good:
                yield f"* {name} has a poor fit: does its path change sides, or begin to touch a surface abruptly?"
    if inspection.optimal_posture:
        q = next(iter(inspection.optimal_posture.values()))
        yield (
            f"{_listed(inspection.optimal_posture)}: slack lengths with which the fibers are optimal at "
            f"{described_posture(inspection.arm.coordinates, q)}, because the file gives none."
        )


def _listed(names: Iterable[str]) -> str:
    first = list(names)
    return ", ".join(first) if len(first) <= 4 else f"{', '.join(first[:3])} and {len(first) - 3} more"


def _degrees(r: Interval) -> str:
    return _range(Interval(np.rad2deg(r.lower), np.rad2deg(r.upper)), "z.0f") + "°"


def _range(r: Interval, form: str, scale: float = 1.0) -> str:
    return f"{scale * r.lower:{form}}…{scale * r.upper:{form}}"
