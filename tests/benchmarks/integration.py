"""How accurate the integration of the muscle arm is: prints two tables and draws docs/integration.png.

Run it with `python tests/benchmarks/integration.py`. With `--quick` it simulates fewer and shorter movements and draws
nothing.

Table 1, "error against cost", compares the ways to integrate. The error is the largest of a joint angle over 0.5 s,
against continuous muscles at accuracy 1e-9. The cost is the CPU time of the whole Diagram, relative to discrete muscles
at 1 ms.

Table 2, "discrete muscles on random movements", tells what the error is while the joints stay inside their range, and
what it is after a joint leaves the range. The 60 movements are those of tests/data/simulations.npz. The first reference
is OpenSim's simulation of them, on polynomial paths and without joint stops. The second reference is drakearm's arm
with continuous muscles at accuracy 1e-8, on the spline paths and with joint stops, as users run it.
"""

import argparse
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))  # for the arm that the tests share

import numpy as np
from matplotlib.figure import Figure
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource
from pydrake.trajectories import PiecewisePolynomial
from rich.console import Console
from rich.table import Table

from drakearm.diagrams import MakeSimulator, muscle_arm
from drakearm.model import Arm, load_arm
from drakearm.model.musculature import muscle_force, muscle_geometry
from drakearm.muscle.activation import activation_rate
from drakearm.muscle.compiled import compiled
from drakearm.muscle.contraction import solve_fiber
from drakearm.systems import HillMuscles
from tests.oracle_arm import on_polynomial_paths

STEP = 0.01  # s: excitations are held this long, and errors are taken this often
ROOT = Path(__file__).parents[2]
FAST = 15.0  # rad/s
ARM = load_arm("arm14")
DATA = ROOT / "tests" / "data"
PICTURE = ROOT / "docs" / "integration.png"


@compiled
def first_order_step(state, tau, excitation, arm_state, time_step, muscles, paths):
    """A first-order step, to compare: backward Euler for the fibers, the force of the step's start held."""
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
        first_order_step(*held, excitation, arm_state, self.time_step, *self._tables(context))


@dataclass(frozen=True)
class Movement:
    """Joint angles (2,), rad, to start from at rest, and excitations (steps, 14), held for STEP each."""

    start: np.ndarray
    excitation: np.ndarray


@dataclass(frozen=True)
class Way:
    """A way to integrate: discrete muscles with a time step (s), or continuous ones with an integrator of Drake."""

    time_step: float = 0.0
    integrator: str = "runge_kutta3"
    accuracy: float = 1e-9
    muscles: type = HillMuscles

    @property
    def setting(self) -> str:
        return f"{1e3 * self.time_step:g} ms" if self.time_step else f"{self.accuracy:g}"


def simulate(movement: Movement, way: Way, arm: Arm = ARM, stops: bool = False) -> tuple[np.ndarray, float]:
    """Joint angles (steps + 1, 2) every STEP, and the CPU time (s) that the simulation took."""
    steps = len(movement.excitation)
    muscle_arm.HillMuscles = way.muscles
    builder = DiagramBuilder()
    parts = muscle_arm.AddMuscleArm(builder, arm, time_step=way.time_step, stops=stops)
    held = np.vstack([movement.excitation, movement.excitation[-1:]]).T
    trajectory = PiecewisePolynomial.ZeroOrderHold(STEP * np.arange(steps + 1), held)
    source = builder.AddSystem(TrajectorySource(trajectory))
    builder.Connect(source.get_output_port(), parts.muscles.GetInputPort("excitation"))
    diagram = builder.Build()
    if way.time_step:
        simulator = MakeSimulator(diagram, way.time_step)
    else:
        simulator = Simulator(diagram)
        ResetIntegratorFromFlags(simulator, way.integrator, STEP).set_target_accuracy(way.accuracy)
    context = simulator.get_mutable_context()
    parts.SetState(context, movement.start)
    plant_context = parts.plant.GetMyContextFromRoot(context)
    simulator.Initialize()
    start, q = time.process_time(), []
    for k in range(steps + 1):
        simulator.AdvanceTo(STEP * k)
        q.append(parts.plant.GetPositions(plant_context))
    return np.array(q), time.process_time() - start


def weak_movement(seed: int, steps: int) -> Movement:
    """Random excitations below 0.3, new ones every STEP."""
    rng = np.random.default_rng(seed)
    return Movement(np.array([-0.2, 1.2]), 0.3 * rng.random((steps, 14)) ** 2)


def ways_to_compare(quick: bool) -> dict[str, list[Way]]:
    """The ways of table 1 by name."""
    if quick:
        steps, accuracies, implicit, euler = [2e-3, 1e-3], [1e-3], [1e-2], [1e-1]
    else:
        steps, accuracies = [4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4], [1e-1, 1e-2, 1e-3, 1e-5, 1e-7]
        implicit, euler = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5], [1e-1, 1e-2]
    return {
        "discrete, second order (drakearm)": [Way(h) for h in steps],
        "discrete, first order": [Way(h, muscles=FirstOrderMuscles) for h in steps],
        "continuous, runge_kutta3": [Way(accuracy=a) for a in accuracies],
        "continuous, bogacki_shampine3": [Way(integrator="bogacki_shampine3", accuracy=a) for a in accuracies],
        "continuous, radau3": [Way(integrator="radau3", accuracy=a) for a in implicit],
        "continuous, implicit_euler": [Way(integrator="implicit_euler", accuracy=a) for a in euler],
    }


def compare_ways(quick: bool) -> tuple[Table, Figure]:
    """Table 1, and its picture."""
    movements = [weak_movement(seed, 10 if quick else 50) for seed in range(1 if quick else 3)]
    for muscles in (HillMuscles, FirstOrderMuscles):
        simulate(movements[0], Way(1e-3, muscles=muscles))  # compiles
    exact = [simulate(movement, Way())[0] for movement in movements]
    unit = np.median([simulate(movements[0], Way(1e-3))[1] for _ in range(5)])

    table = Table("way", "setting", "error (rad)", "cost", title="1. Error against cost")
    figure = Figure(figsize=(7, 5), layout="constrained")
    axes = figure.subplots()
    for name, ways in ways_to_compare(quick).items():
        points = []
        for way in ways:
            try:
                runs = [simulate(movement, way) for movement in movements]
            except RuntimeError:  # Drake stops at the first NaN
                table.add_row(name, way.setting, "diverges", "")
                continue
            error = np.median([np.abs(q - e).max() for (q, _), e in zip(runs, exact, strict=True)])
            points.append((np.median([seconds for _, seconds in runs]) / unit, error))
            table.add_row(name, way.setting, f"{error:.1e}", f"{points[-1][0]:.2f}")
        axes.loglog(*np.array(points).T, "o-", label=name)
    axes.set(xlabel="cost, relative to discrete muscles at 1 ms", ylabel="largest error over 0.5 s (rad)")
    axes.grid(which="major", alpha=0.3)
    axes.legend(fontsize="small")
    return table, figure


def errors_by_part(runs: Iterable[tuple[np.ndarray, np.ndarray]], lower: np.ndarray, upper: np.ndarray) -> dict:
    """Largest errors (rad) of runs in each of three parts: inside the joint range, slow or fast, and after leaving it.

    runs: joint angles (steps, 2) and their reference, which is NaN after its end. A run is inside until its reference
    leaves the range [lower, upper] for the first time. Fast runs are those that reach FAST before that.
    """
    errors: dict[str, list[float]] = {f"inside, below {FAST:g} rad/s": [], "inside, faster": [], "after leaving": []}
    slow, fast, after = errors.values()
    for q, reference in runs:
        error = np.abs(q - reference).max(axis=1)[~np.isnan(reference[:, 0])]
        outside = ((reference < lower) | (reference > upper)).any(axis=1)
        first = int(outside.argmax()) if outside.any() else len(error)
        speed = np.abs(np.diff(reference[:first], axis=0)).max(initial=0.0) / STEP
        (slow if speed < FAST else fast).append(error[:first].max())
        if first < len(error):
            after.append(error[first:].max())
    return errors


def random_movements(quick: bool) -> Table:
    """Table 2."""
    stored = np.load(DATA / "simulations.npz")
    chosen = range(3 if quick else len(stored["q"]))
    movements = [Movement(stored["q"][k, 0], stored["thousandths"][k] / 1000.0) for k in chosen]
    lower, upper = joint_range()
    on_polynomials = on_polynomial_paths(ARM, DATA / "polynomial_paths.json")
    references = {"OpenSim 4.6, no stops": (on_polynomials, False, [stored["q"][k] for k in chosen])}
    if not quick:
        exact = [simulate(movement, Way(accuracy=1e-8), stops=True)[0] for movement in movements]
        references["continuous, with stops"] = (ARM, True, exact)

    table = Table("reference", "time step", "part", "runs", "median", "95 %", "worst (rad)")
    table.title = "2. Discrete muscles on random movements: largest error of each run"
    for name, (arm, stops, exact) in references.items():
        for way in (Way(2e-3), Way(1e-3), Way(5e-4)):
            results = [simulate(movement, way, arm, stops)[0] for movement in movements]
            errors = errors_by_part(zip(results, exact, strict=True), lower, upper)
            for part, error in errors.items():
                if error:
                    quantiles = [f"{x:.1e}" for x in np.quantile(error, [0.5, 0.95, 1.0])]
                    table.add_row(name, way.setting, part, str(len(error)), *quantiles)
    return table


def joint_range() -> tuple[np.ndarray, np.ndarray]:
    """The ends (2,) of the joints' range, rad."""
    plant = muscle_arm.AddMuscleArm(DiagramBuilder(), ARM).plant
    return plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few and short movements, no picture")
    quick = parser.parse_args().quick
    table, figure = compare_ways(quick)
    console = Console(width=110)
    console.print(table)
    if not quick:
        figure.savefig(PICTURE, dpi=120)
        console.print(f"drawn in {PICTURE}")
    console.print(random_movements(quick))


if __name__ == "__main__":
    main()
