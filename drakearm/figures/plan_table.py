"""Tables of plans for the terminal: the facts about one plan, and an overview of many."""

from collections.abc import Mapping

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from drakearm.errors import DrakearmError
from drakearm.figures.fact_table import fact_table
from drakearm.planning.feasibility import Feasibility
from drakearm.planning.plan_report import PlanReport

_COLUMNS = ("scenario", "status", "s", "iter.", "angle\n°", "torque\nNm", "clear.\ncm", "muscles")


def plan_facts(report: PlanReport) -> Table:
    """How a plan was found, what it costs, how close it comes to its limits and whether the muscles can do it."""
    plan, found = report.plan, report.plan.verification
    costs = ", ".join(f"{name} {value:z#.4g}" for name, value in plan.costs.items())
    facts = {
        "solver": f"{plan.solver}: {plan.status}, {plan.iterations} iterations, "
        f"{plan.seconds:.2f} s without compilation",
        "movement": f"{plan.t[-1]:.2f} s, {len(plan.t)} knots",
        "costs": f"{costs}; sum {sum(plan.costs.values()):z#.4g}",
        "margins": f"angle {_degrees(found.angle_margin)}°, speed {found.speed_margin:z.2f} rad/s, "
        f"torque {found.torque_margin:z.2f} Nm",
    }
    if found.clearance is not None:
        facts["clearance"] = f"{_clearance(report)} cm, of the {found.nearest_part} at {found.nearest_time:.2f} s"
    facts["defects"] = f"{found.speed_defect:.2g} rad/s, {found.acceleration_defect:.2g} rad/s²"
    facts["muscles"] = report.feasibility.verdict
    return fact_table(report.name, facts)


def plans_table(results: Mapping[str, PlanReport | DrakearmError]) -> Table:
    """One row per scenario; below the table why some have no plan."""
    failures = [f"{name}: {error}" for name, error in results.items() if isinstance(error, DrakearmError)]
    table = Table(
        title=Text(f"{len(results) - len(failures)} of {len(results)} movements planned"),
        caption=Text("\n".join([_CAPTION, *failures])),
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        padding=0,
        show_edge=False,
    )
    for column in _COLUMNS:
        words = column in ("scenario", "status", "muscles")
        table.add_column(column, justify="left" if words else "right", no_wrap=column != "scenario", overflow="fold")
    for name, result in results.items():
        cells = (name, "no plan") if isinstance(result, DrakearmError) else _row(name, result)
        table.add_row(*map(Text, cells))
    return table


_CAPTION = (
    "s: seconds of planning, without the compilation of functions. iter.: iterations of the solver. Angle, torque: the "
    "smallest margin of any joint to its limit. Clear.: the smallest distance to the obstacle. Margins and distances "
    "are also checked between the knots. Muscles: the largest activation, or the torque that they lack."
)


def _row(name: str, report: PlanReport) -> tuple[str, ...]:
    plan, found = report.plan, report.plan.verification
    return (
        name,
        plan.status,
        f"{plan.seconds:.2f}",
        f"{plan.iterations}",
        _degrees(found.angle_margin),
        f"{found.torque_margin:z.1f}",
        _clearance(report),
        _ability(report.feasibility),
    )


def _degrees(angle: float) -> str:
    return f"{np.rad2deg(angle):z.1f}"


def _clearance(report: PlanReport) -> str:
    clearance = report.plan.verification.clearance
    return "" if clearance is None else f"{100 * clearance:z.2f}"


def _ability(feasibility: Feasibility) -> str:
    if feasibility.feasible:
        return f"can, up to {feasibility.activation.max():.2f}"
    _, joint = np.unravel_index(np.abs(feasibility.reserve).argmax(), feasibility.reserve.shape)
    return f"{feasibility.coordinates[joint]} -{np.abs(feasibility.reserve).max():.3g} Nm"
