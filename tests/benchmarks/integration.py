"""Error against cost of every way to integrate the muscle arm: prints a table and draws docs/integration.png.

Run it with `python tests/benchmarks/integration.py`. The cost is that of the whole Diagram, relative to discrete
muscles at 1 ms; the error is the largest in a joint angle over 0.5 s against continuous muscles at accuracy 1e-9.
"""

import time
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource
from pydrake.trajectories import PiecewisePolynomial
from rich.console import Console
from rich.table import Table

from drakearm.diagrams import MakeSimulator, muscle_arm
from drakearm.model import load_arm
from drakearm.model.musculature import muscle_force, muscle_geometry
from drakearm.muscle.activation import activation_rate
from drakearm.muscle.compiled import compiled
from drakearm.muscle.contraction import solve_fiber
from drakearm.systems import HillMuscles

DURATION = 0.5
ARM = load_arm("arm14")
PICTURE = Path(__file__).parents[2] / "docs" / "integration.png"


@compiled
def first_order_step(state, tau, excitation, arm_state, time_step, muscles, paths):
    """What `muscle_step` replaced: backward Euler for the fibers, the force of the step's start held."""
    n, n_q = len(muscles), len(tau)
    q, v = arm_state[:n_q], arm_state[n_q:]
    length, moment_arm = muscle_geometry(q, muscles, paths)
    next_length, _ = muscle_geometry(q + time_step * v, muscles, paths)
    tau[:] = 0.0
    for i in range(n):
        m = muscles[i]
        for j in range(n_q):
            tau[j] += moment_arm[i, j] * muscle_force(state[i], state[n + i], length[i], 0.0, m)
        state[i] += time_step * activation_rate(state[i], excitation[i], m)[0]
        state[n + i] = solve_fiber(1.0 / time_step, state[n + i], state[i], next_length[i], state[n + i], m)


class FirstOrderMuscles(HillMuscles):
    """HillMuscles with the first-order step."""

    def _step(self, context, state):
        excitation, arm_state = self._excitation.Eval(context), self._arm_state.Eval(context)
        held = (state.get_mutable_value(0), state.get_mutable_value(1))
        first_order_step(*held, excitation, arm_state, self.time_step, *self._tables)


def excitations(seed: int) -> PiecewisePolynomial:
    """Smooth or jumping excitations, held for 10 ms each."""
    rng = np.random.default_rng(seed)
    values = 0.3 * rng.random((1 + int(DURATION / 0.01), 14)) ** 2
    return PiecewisePolynomial.ZeroOrderHold(0.01 * np.arange(len(values)), values.T)


def simulate(seed, time_step=0.0, integrator=None, accuracy=None, muscles=HillMuscles):
    """Joint angles every 10 ms and the seconds that it took."""
    muscle_arm.HillMuscles = muscles
    builder = DiagramBuilder()
    arm = muscle_arm.AddMuscleArm(builder, ARM, time_step=time_step, stops=False)
    source = builder.AddSystem(TrajectorySource(excitations(seed)))
    builder.Connect(source.get_output_port(), arm.muscles.GetInputPort("excitation"))
    diagram = builder.Build()
    if time_step:
        simulator = MakeSimulator(diagram, time_step)
    else:
        simulator = Simulator(diagram)
        ResetIntegratorFromFlags(simulator, integrator, 0.01).set_target_accuracy(accuracy)
    context = simulator.get_mutable_context()
    arm.SetState(context, np.array([-0.2, 1.2]))
    plant_context = arm.plant.GetMyContextFromRoot(context)
    simulator.Initialize()
    start, q = time.process_time(), []
    for k in range(int(DURATION / 0.01) + 1):
        simulator.AdvanceTo(0.01 * k)
        q.append(arm.plant.GetPositions(plant_context))
    return np.array(q), time.process_time() - start


def main() -> None:
    seeds = range(3)
    ways: dict[str, list[dict]] = {
        "discrete, second order (drakearm)": [{"time_step": h} for h in (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)],
        "discrete, first order": [
            {"time_step": h, "muscles": FirstOrderMuscles} for h in (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
        ],
        "continuous, runge_kutta3": [
            {"integrator": "runge_kutta3", "accuracy": a} for a in (1e-1, 1e-2, 1e-3, 1e-5, 1e-7)
        ],
        "continuous, bogacki_shampine3": [
            {"integrator": "bogacki_shampine3", "accuracy": a} for a in (1e-1, 1e-2, 1e-3, 1e-5, 1e-7)
        ],
        "continuous, radau3": [{"integrator": "radau3", "accuracy": a} for a in (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)],
        "continuous, implicit_euler": [{"integrator": "implicit_euler", "accuracy": a} for a in (1e-1, 1e-2)],
    }
    simulate(0, 1e-3)
    simulate(0, 1e-3, muscles=FirstOrderMuscles)
    exact = [simulate(seed, integrator="runge_kutta3", accuracy=1e-9)[0] for seed in seeds]
    unit = np.median([simulate(0, 1e-3)[1] for _ in range(5)])

    table = Table("way", "setting", "error (rad)", "cost")
    figure = Figure(figsize=(7, 5), layout="constrained")
    axes = figure.subplots()
    for name, settings in ways.items():
        points = []
        for setting in settings:
            value = f"{1e3 * setting['time_step']:g} ms" if "time_step" in setting else f"{setting['accuracy']:g}"
            try:
                runs = [simulate(seed, **setting) for seed in seeds]
            except RuntimeError:  # Drake stops at the first NaN
                table.add_row(name, value, "diverges", "")
                continue
            error = np.median([np.abs(q - e).max() for (q, _), e in zip(runs, exact, strict=True)])
            points.append((np.median([seconds for _, seconds in runs]) / unit, error))
            table.add_row(name, value, f"{error:.1e}", f"{points[-1][0]:.2f}")
        axes.loglog(*np.array(points).T, "o-", label=name)
    axes.set(xlabel="cost over that of discrete muscles at 1 ms", ylabel="error after up to 0.5 s (rad)")
    axes.grid(which="major", alpha=0.3)
    axes.legend(fontsize="small")
    figure.savefig(PICTURE, dpi=120)
    Console().print(table, f"drawn in {PICTURE}")


if __name__ == "__main__":
    main()
