"""How long planning takes, next to do-mpc on the same problem: the same equations of motion, costs and limits.

Run it with `python tests/benchmarks/planning.py`; `--quick` only checks that it works. do-mpc is used where it is
installed. As the paper's authors did, it looks 40 steps of 0.04 s ahead, with Radau collocation of degree 3, and solves
the problem again at each of 40 steps.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # before NumPy, Drake and CasADi start their threads: times of one core

import argparse
import math
import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

from drakearm.diagrams import MakeMpcLoop
from drakearm.experiments.scenario import load_scenario
from drakearm.model import MakeTorqueArm, load_arm
from drakearm.model.dynamics import forward_dynamics
from drakearm.model.dynamics_table import read_dynamics
from drakearm.planning import HeldJoint, Movement, PlanningModel, Posture, RecedingHorizon, Torque, TorqueRate, plan

try:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about do-mpc's optional features
        import casadi
        import do_mpc
except ImportError as error:
    print(f"do-mpc is not used: {error}", file=sys.stderr)
    do_mpc = None

STEP, HORIZON = 0.04, 40  # s, steps ahead
STEPS, QUICK_STEPS = 40, 3  # of the closed loop
ROUNDS = 3  # in which the planners are measured round-robin, so that their ratios hold on a noisy machine
ROUNDING = 1e-12  # of the largest acceleration
ARM = load_arm("arm14")
DYNAMICS = read_dynamics(MakeTorqueArm(ARM))
TIMING = replace(load_scenario("timing-0.7s").movement, duration=STEP * HORIZON, knots=HORIZON + 1)
AUTHORS = [
    HeldJoint(joint="shoulder", angle_deg=0, weight=1000),
    Posture(running=(0, 1)),
    Torque(weight=(0, 1)),
    TorqueRate(weight=0.01),
]
MOVEMENTS = {"timing-0.7s": TIMING, "the authors' costs": replace(TIMING, costs=AUTHORS)}


class Stopwatch:
    """Notes the CPU time and the wall time (s) of every call that goes through it."""

    def __init__(self):
        self.times: list[tuple[float, float]] = []

    def __call__(self, function: Callable, *arguments):
        cpu, wall = time.process_time(), time.perf_counter()
        result = function(*arguments)
        self.times.append((time.process_time() - cpu, time.perf_counter() - wall))
        return result


def symbolic_acceleration(q, v, tau):
    """Joint accelerations as a CasADi expression, from the terms of DYNAMICS: M a = tau + gravity - Coriolis."""
    n_q = q.numel()
    functions = [[1.0, casadi.cos(x), casadi.sin(x), casadi.cos(2 * x), casadi.sin(2 * x)] for x in casadi.vertsplit(q)]

    def term(basis, coefficient):
        return math.prod((functions[j][b] for j, b in enumerate(basis)), start=float(coefficient))

    mass, gravity = casadi.SX(n_q, n_q), casadi.SX(n_q, 1)
    mass_terms = zip(DYNAMICS.mass_entry, DYNAMICS.mass_basis, DYNAMICS.mass_coefficient, strict=True)
    for (row, column), basis, coefficient in mass_terms:
        mass[row, column] += term(basis, coefficient)
        if row != column:
            mass[column, row] += term(basis, coefficient)
    gravity_terms = zip(DYNAMICS.gravity_entry, DYNAMICS.gravity_basis, DYNAMICS.gravity_coefficient, strict=True)
    for entry, basis, coefficient in gravity_terms:
        gravity[entry] += term(basis, coefficient)
    momentum = mass @ v
    coriolis = casadi.jacobian(momentum, q) @ v - casadi.jacobian(v.T @ momentum, q).T / 2
    return casadi.solve(mass, tau + gravity - coriolis)


def check_acceleration() -> float:
    """The largest difference between `symbolic_acceleration` and `forward_dynamics` in 100 random states, rad/s^2.

    Raises RuntimeError where it is more than rounding: the two planners would then solve different problems.
    """
    n_q, rng = len(ARM.coordinates), np.random.default_rng(0)
    variables = [casadi.SX.sym(name, n_q) for name in ("q", "v", "tau")]
    acceleration = casadi.Function("a", variables, [symbolic_acceleration(*variables)])
    states = rng.uniform(-3, 3, (100, 3, n_q))
    symbolic = np.array([acceleration(*state).full().ravel() for state in states])
    compiled = np.array([forward_dynamics(*state, DYNAMICS) for state in states])
    difference, largest = np.abs(symbolic - compiled).max(), np.abs(compiled).max()
    if not difference < ROUNDING * largest:
        raise RuntimeError(
            f"do-mpc's accelerations differ from drakearm's by up to {difference:.1e} rad/s^2: expected rounding, "
            f"at most {ROUNDING * largest:.1e}."
        )
    return difference


def make_do_mpc(movement: Movement):
    """do-mpc's controller of a movement, and the simulator of its arm; both are at the movement's start."""
    n_q = len(ARM.coordinates)
    model = do_mpc.model.Model("continuous")
    variables = {"q": "_x", "v": "_x", "tau": "_u"}
    q, v, tau = (model.set_variable(kind, name, (n_q, 1)) for name, kind in variables.items())
    model.set_rhs("q", v)
    model.set_rhs("v", symbolic_acceleration(q, v, tau))
    model.setup()

    controller = do_mpc.controller.MPC(model)
    controller.set_param(
        n_horizon=HORIZON,
        t_step=STEP,
        state_discretization="collocation",
        collocation_type="radau",
        collocation_deg=3,
        nlpsol_opts={"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": 0},
    )
    cost, rate = casadi.SX(0), np.zeros(n_q)  # summed over steps where drakearm integrates over time
    for piece in movement.costs:
        if isinstance(piece, HeldJoint):
            cost += piece.weight * (q[ARM.coordinates.index(piece.joint)] - np.deg2rad(piece.angle_deg)) ** 2
        elif isinstance(piece, Posture):
            cost += casadi.dot(np.broadcast_to(piece.running, n_q), (q - movement.target) ** 2)
        elif isinstance(piece, Torque):
            cost += casadi.dot(np.broadcast_to(piece.weight, n_q), tau**2)
        elif isinstance(piece, TorqueRate):
            rate += np.broadcast_to(piece.weight, n_q)
        else:
            raise TypeError(f"There is no cost {piece.type} for do-mpc here.")
    controller.set_objective(mterm=casadi.substitute(cost, tau, 0 * tau), lterm=cost)
    controller.set_rterm(tau=rate)
    plant = MakeTorqueArm(ARM)
    upper = {"v": movement.speed_limit, "tau": movement.torque_limit, "q": plant.GetPositionUpperLimits()}
    lower = {"v": -np.array(upper["v"]), "tau": -np.array(upper["tau"]), "q": plant.GetPositionLowerLimits()}
    for name, kind in variables.items():
        controller.bounds["lower", kind, name], controller.bounds["upper", kind, name] = lower[name], upper[name]
    controller.setup()

    simulator = do_mpc.simulator.Simulator(model)
    simulator.set_param(integration_tool="cvodes", t_step=STEP)
    simulator.setup()
    start = np.concatenate([movement.start, np.zeros(n_q)])[:, None]
    controller.x0 = simulator.x0 = start
    controller.set_initial_guess()
    return controller, simulator


def run_do_mpc(movement: Movement, steps: int) -> tuple[Stopwatch, np.ndarray]:
    """How long do-mpc takes to plan at each step of its closed loop, and the posture at the end."""
    controller, simulator = make_do_mpc(movement)
    watch, state = Stopwatch(), simulator.x0.cat.full()
    for _ in range(steps):
        state = simulator.make_step(watch(controller.make_step, state))
    return watch, state.ravel()[: len(movement.target)]


def run_receding_horizon(movement: Movement, steps: int) -> tuple[Stopwatch, np.ndarray]:
    """How long drakearm takes to plan at each step of its closed loop, and the posture at the end.

    The movement's end is free, because do-mpc's is.
    """
    watch = Stopwatch()
    planner = RecedingHorizon(PlanningModel(ARM), replace(movement, end="free", hold=0.0), HORIZON * STEP)
    loop = MakeMpcLoop(ARM, lambda *now: watch(planner, *now))
    return watch, loop.Run(movement.start, (steps - 0.5) * STEP).q[-1]


def run_plan(movement: Movement, steps: int) -> tuple[Stopwatch, np.ndarray]:
    """How long drakearm takes to plan the whole movement once, and the posture at its end."""
    watch = Stopwatch()
    return watch, watch(plan, ARM, movement).q[-1]


def describe(times: np.ndarray, unit: np.ndarray) -> list[str]:
    """Cells of a row: the first solve, the other solves and all of them, as CPU / wall time, and the ratio to a unit.

    times, unit: CPU and wall time of every solve in every round, (rounds, steps, 2), s.
    """
    totals = times.sum(axis=1)
    cold, total = np.median(times[:, 0], axis=0), np.median(totals, axis=0)
    cells = [f"{cold[0]:.3f} / {cold[1]:.3f}"]
    if times.shape[1] == 1:
        return [*cells, "-", "-", "-"]
    warm, ratio = np.median(times[:, 1:], axis=(0, 1)), np.median(totals[:, 0] / unit.sum(axis=1)[:, 0])
    return [*cells, f"{warm[0]:.3f} / {warm[1]:.3f}", f"{total[0]:.2f} / {total[1]:.2f}", f"{ratio:.2f}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few steps: the same table, but its times mean nothing")
    quick = parser.parse_args().quick
    rounds, steps = (1, QUICK_STEPS) if quick else (ROUNDS, STEPS)
    warnings.simplefilter("ignore", FutureWarning)  # do-mpc's, about CasADi and NumPy
    console = Console(width=140)
    planners = {"drakearm, receding horizon": run_receding_horizon, "drakearm, plan() once": run_plan}
    if do_mpc:
        console.print(f"Accelerations of do-mpc and drakearm agree to {check_acceleration():.0e} rad/s^2.")
        planners["do-mpc"] = run_do_mpc
    else:
        console.print("do-mpc is not installed: pip install do-mpc")
    plan(ARM, TIMING)  # compiles
    solves = ("cold solve (s)", "warm solve, median (s)", f"{steps} steps (s)")
    table = Table("costs", "planner", *solves, "ratio", "elbow at the end")
    for name, movement in MOVEMENTS.items():
        runs = [{planner: run(movement, steps) for planner, run in planners.items()} for _ in range(rounds)]
        times = {planner: np.array([run[planner][0].times for run in runs]) for planner in planners}
        for planner in planners:
            _, q = runs[0][planner]
            cells = describe(times[planner], times["drakearm, receding horizon"])
            table.add_row(name, planner, *cells, f"{np.rad2deg(q[1]):.1f} deg")
    console.print(table, "Times are CPU / wall time on one core; the ratio is of the CPU times of all steps.")
    console.print(
        "Comparable: drakearm's receding horizon and do-mpc with the same costs. plan() once solves another problem: "
        "its movement ends at rest."
    )


if __name__ == "__main__":
    main()
