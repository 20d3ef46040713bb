"""How long a control step of the muscle arm takes, next to that of its plant alone, and a derivative evaluation.

Run it with `python tests/benchmarks/speed.py`; `--quick` only checks that it works. The cases are measured round-robin,
so that their ratios hold on a noisy machine.
"""

import argparse
import time
from collections.abc import Callable

import numpy as np
from pydrake.systems.framework import DiagramBuilder
from rich.console import Console
from rich.table import Table

from drakearm.diagrams import AddMuscleArm, MakeSimulator
from drakearm.model import MakeTorqueArm, load_arm
from drakearm.systems import HillMuscles

ARM = load_arm("arm14")
ROUNDS, QUICK_ROUNDS = 100, 3
CALLS = 5  # of every case in each round


def derivatives() -> Callable[[], None]:
    """One evaluation of the continuous muscles' time derivatives, called from Drake."""
    muscles = HillMuscles(ARM, 0.0)
    context, rates = muscles.CreateDefaultContext(), muscles.AllocateTimeDerivatives()
    muscles.GetInputPort("excitation").FixValue(context, np.full(14, 0.1))
    muscles.GetInputPort("arm_state").FixValue(context, np.array([0.0, 0.5, 0.1, 0.2]))
    return lambda: muscles.CalcTimeDerivatives(context, rates)


def control_step(kind: str) -> Callable[[], None]:
    """A control step of 10 ms, at 1 ms steps: of the "plant" alone, with "muscles", with "muscles and stops"."""
    builder = DiagramBuilder()
    if kind == "plant":
        builder.AddSystem(MakeTorqueArm(ARM))
        diagram = builder.Build()
        simulator = MakeSimulator(diagram)
    else:
        arm = AddMuscleArm(builder, ARM, stops=kind == "muscles and stops")
        builder.ExportInput(arm.muscles.GetInputPort("excitation"), "excitation")
        diagram = builder.Build()
        simulator = MakeSimulator(diagram)
        diagram.GetInputPort("excitation").FixValue(simulator.get_mutable_context(), np.full(14, 0.05))
        arm.SetState(simulator.get_mutable_context(), np.array([0.0, 0.5]))
    simulator.Initialize()
    context = simulator.get_context()
    return lambda: simulator.AdvanceTo(context.get_time() + 0.01)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few rounds: the same table, but its times mean nothing")
    rounds = QUICK_ROUNDS if parser.parse_args().quick else ROUNDS
    kinds = ("plant", "muscles", "muscles and stops")
    cases = {f"control step: {kind}": control_step(kind) for kind in kinds}
    cases["derivatives of HillMuscles"] = derivatives()
    times: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(rounds):
        for name, call in cases.items():
            start = time.perf_counter()
            for _ in range(CALLS):
                call()
            times[name].append((time.perf_counter() - start) / CALLS * 1e6)
    plant = np.array(times["control step: plant"])
    table = Table("what", "median (us)", "minimum (us)", "ratio to the plant's control step")
    for name, values in times.items():
        ratio = np.median(np.array(values) / plant)
        table.add_row(name, f"{np.median(values):.1f}", f"{min(values):.1f}", f"{ratio:.2f}")
    console = Console(width=120)
    console.print(table)
    console.print(
        "Comparable: the control steps, which all advance the same arm by 10 ms in Drake. An evaluation of derivatives "
        "is a part of a step of the continuous muscles."
    )


if __name__ == "__main__":
    main()
