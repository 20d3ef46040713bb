"""Plans for the terminal: the facts about one, and a table of many."""

from collections.abc import Mapping

import numpy as np
from rich import box
from rich.table import Table

from drakearm.errors import DrakearmError
from drakearm.experiments.plan_report import PlanReport
from drakearm.planning.feasibility import Feasibility

_COLUMNS = ("scenario", "status", "s", "iter.", "angle\n°", "torque\nNm", "clear.\ncm", "muscles")


def fact_table(report: PlanReport) -> Table:
    """How a plan was found, what it costs, how near it comes to its limits and whether the muscles can do it."""
    plan, found = report.plan, report.plan.verification
    costs = ", ".join(f"{name} {value:#.4g}" for name, value in plan.costs.items())
    table = Table(title=report.scenario.name, show_header=False)
    table.add_row("solver", f"{plan.solver}: {plan.status}, {plan.iterations} iterations, {plan.seconds:.2f} s")
    table.add_row("movement", f"{plan.t[-1]:.2f} s, {len(plan.t)} knots")
    table.add_row("costs", f"{costs}; in all {sum(plan.costs.values()):#.4g}")
    table.add_row(
        "margins",
        f"angle {_degrees(found.angle_margin)}°, speed {found.speed_margin:.3g} rad/s, "
        f"torque {found.torque_margin:.3g} Nm",
    )
    if found.clearance is not None:
        table.add_row(
            "clearance", f"{_clearance(report)} cm, of the {found.nearest_part} at {found.nearest_time:.2f} s"
        )
    table.add_row("defects", f"{found.speed_defect:.2g} rad/s, {found.acceleration_defect:.2g} rad/s²")
    table.add_row("muscles", report.feasibility.verdict)
    return table


def plans_table(results: Mapping[str, PlanReport | DrakearmError]) -> Table:
    """A row a scenario; below the table why some have no plan."""
    failures = [f"{name}: {error}" for name, error in results.items() if isinstance(error, DrakearmError)]
    table = Table(
        title=f"{len(results) - len(failures)} of {len(results)} movements planned",
        caption="\n".join([_CAPTION, *failures]),
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        padding=0,
        show_edge=False,
    )
    for column in _COLUMNS:
        words = column in ("scenario", "status", "muscles")
        table.add_column(column, justify="left" if words else "right", no_wrap=column != "scenario", overflow="fold")
    for name, result in results.items():
        table.add_row(*([name, "no plan"] if isinstance(result, DrakearmError) else _row(name, result)))
    return table


_CAPTION = (
    "iter.: the solver's iterations. Angle, torque, clear.: margins to the nearest limit of any joint and to the "
    "obstacle, between the knots too. Muscles: the largest activation, or the torque that they lack."
)


def _row(name: str, report: PlanReport) -> tuple[str, ...]:
    plan, found = report.plan, report.plan.verification
    return (
        name,
        plan.status,
        f"{plan.seconds:.2f}",
        f"{plan.iterations}",
        _degrees(found.angle_margin),
        f"{found.torque_margin:.1f}",
        _clearance(report),
        _ability(report.feasibility),
    )


def _degrees(angle: float) -> str:
    return f"{np.rad2deg(angle) + 0.0:.1f}"


def _clearance(report: PlanReport) -> str:
    clearance = report.plan.verification.clearance
    return "" if clearance is None else f"{100 * clearance:.2f}"


def _ability(feasibility: Feasibility) -> str:
    if feasibility.feasible:
        return f"can, up to {feasibility.activation.max():.2f}"
    _, joint = np.unravel_index(np.abs(feasibility.reserve).argmax(), feasibility.reserve.shape)
    return f"{feasibility.coordinates[joint]} -{np.abs(feasibility.reserve).max():.3g} Nm"
