"""How long the muscle arm takes: one derivative evaluation, and a 10 ms control step beside that of the plant alone.

Run it with `python tests/benchmarks/speed.py`. The cases take turns, so that their ratios hold on a noisy machine.
"""

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
ROUNDS, CALLS = 100, 5


def derivatives() -> Callable[[], None]:
    """One evaluation of the continuous muscles' time derivatives, from Drake's side."""
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
    kinds = ("plant", "muscles", "muscles and stops")
    cases = {f"control step: {kind}": control_step(kind) for kind in kinds}
    cases["derivatives of HillMuscles"] = derivatives()
    times: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(ROUNDS):
        for name, call in cases.items():
            start = time.perf_counter()
            for _ in range(CALLS):
                call()
            times[name].append((time.perf_counter() - start) / CALLS * 1e6)
    plant = np.array(times["control step: plant"])
    table = Table("what", "median (us)", "least (us)", "over the plant's control step")
    for name, values in times.items():
        ratio = np.median(np.array(values) / plant)
        table.add_row(name, f"{np.median(values):.1f}", f"{min(values):.1f}", f"{ratio:.2f}")
    Console().print(table)


if __name__ == "__main__":
    main()
