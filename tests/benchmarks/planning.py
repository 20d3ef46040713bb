"""How long planning takes, next to do-mpc on the same problem: the arm's own equations of motion, costs and limits.

Run it with `python tests/benchmarks/planning.py`; the extra `bench` installs do-mpc. As the paper's authors did, it
looks 40 steps of 0.04 s ahead, with Radau collocation of degree 3, and solves anew at each of 40 steps.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # before NumPy, Drake and CasADi start their threads: figures of one core

import math
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from rich.console import Console
from rich.table import Table

from drakearm.diagrams import MakeMpcLoop
from drakearm.experiments.scenario import load_scenario
from drakearm.model import MakeTorqueArm, load_arm
from drakearm.model.dynamics import forward_dynamics
from drakearm.model.dynamics_table import DynamicsTable, read_dynamics
from drakearm.planning import HeldJoint, Movement, PlanningModel, Posture, RecedingHorizon, Torque, TorqueRate, plan

try:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about do-mpc's optional features
        import casadi
        import do_mpc
except ImportError:
    do_mpc = None

STEP, HORIZON, STEPS = 0.04, 40, 40  # s, steps ahead, steps of the closed loop
ARM = load_arm("arm14")
TIMING = replace(load_scenario("timing-0.7s").movement, duration=STEP * HORIZON, knots=HORIZON + 1)
AUTHORS = [
    HeldJoint(joint="shoulder", angle_deg=0, weight=1000),
    Posture(running=(0, 1)),
    Torque(weight=(0, 1)),
    TorqueRate(weight=0.01),
]
MOVEMENTS = {"timing-0.7s": TIMING, "the authors' costs": replace(TIMING, costs=AUTHORS)}


@dataclass
class Stopwatch:
    """CPU time and wall time (s) of what it called."""

    cpu: list[float]
    wall: list[float]

    def __call__(self, function: Callable, *arguments):
        cpu, wall = time.process_time(), time.perf_counter()
        result = function(*arguments)
        self.cpu.append(time.process_time() - cpu)
        self.wall.append(time.perf_counter() - wall)
        return result

    def row(self) -> list[str]:
        """The first call, the median of the others, and all together, each as CPU / wall time."""
        rest = [np.median(times[1:]) if times[1:] else np.nan for times in (self.cpu, self.wall)]
        figures = ((self.cpu[0], self.wall[0]), rest, (sum(self.cpu), sum(self.wall)))
        return ["-" if np.isnan(cpu) else f"{cpu:.3f} / {wall:.3f}" for cpu, wall in figures]


def symbolic_acceleration(dynamics: DynamicsTable, q, v, tau):
    """Joint accelerations as a CasADi expression of the same terms as drakearm's: M a = tau + gravity - Coriolis."""
    n_q = q.numel()
    functions = [[1.0, casadi.cos(x), casadi.sin(x), casadi.cos(2 * x), casadi.sin(2 * x)] for x in casadi.vertsplit(q)]

    def term(basis, coefficient):
        return math.prod((functions[j][b] for j, b in enumerate(basis)), start=float(coefficient))

    mass, gravity = casadi.SX(n_q, n_q), casadi.SX(n_q, 1)
    for (row, column), basis, coefficient in zip(*dynamics[:3], strict=True):
        mass[row, column] += term(basis, coefficient)
        if row != column:
            mass[column, row] += term(basis, coefficient)
    for entry, basis, coefficient in zip(*dynamics[3:], strict=True):
        gravity[entry] += term(basis, coefficient)
    momentum = mass @ v
    coriolis = casadi.jacobian(momentum, q) @ v - casadi.jacobian(v.T @ momentum, q).T / 2
    return casadi.solve(mass, tau + gravity - coriolis)


def check_motion(dynamics: DynamicsTable) -> float:
    """The largest difference between CasADi's accelerations and drakearm's in 100 random states, rad/s^2."""
    n_q, rng = len(ARM.coordinates), np.random.default_rng(0)
    variables = [casadi.SX.sym(name, n_q) for name in ("q", "v", "tau")]
    acceleration = casadi.Function("a", variables, [symbolic_acceleration(dynamics, *variables)])
    states = rng.uniform(-3, 3, (100, 3, n_q))
    return max(np.abs(acceleration(*s).full().ravel() - forward_dynamics(*s, dynamics)).max() for s in states)


def make_do_mpc(movement: Movement, dynamics: DynamicsTable):
    """do-mpc's controller of a movement, and the simulator of its arm; both are at the movement's start."""
    n_q = len(ARM.coordinates)
    model = do_mpc.model.Model("continuous")
    variables = {"q": "_x", "v": "_x", "tau": "_u"}
    q, v, tau = (model.set_variable(kind, name, (n_q, 1)) for name, kind in variables.items())
    model.set_rhs("q", v)
    model.set_rhs("v", symbolic_acceleration(dynamics, q, v, tau))
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


def run_do_mpc(movement: Movement, dynamics: DynamicsTable) -> tuple[Stopwatch, np.ndarray]:
    """How long each step of the closed loop takes to plan, and the posture at the end."""
    controller, simulator = make_do_mpc(movement, dynamics)
    watch, state = Stopwatch([], []), simulator.x0.cat.full()
    for _ in range(STEPS):
        state = simulator.make_step(watch(controller.make_step, state))
    return watch, state.ravel()[: len(movement.target)]


def run_plan(movement: Movement) -> tuple[Stopwatch, np.ndarray]:
    """How long the whole movement takes to plan, once and from a cold start, and the posture at its end."""
    watch = Stopwatch([], [])
    return watch, watch(plan, ARM, movement).q[-1]


def run_receding_horizon(movement: Movement) -> tuple[Stopwatch, np.ndarray]:
    """How long each step of the closed loop takes to plan, and the posture at the end, which is free as do-mpc's is."""
    watch = Stopwatch([], [])
    planner = RecedingHorizon(PlanningModel(ARM), replace(movement, end="free", hold=0.0), HORIZON * STEP)
    loop = MakeMpcLoop(ARM, lambda *now: watch(planner, *now))
    return watch, loop.Run(movement.start, (STEPS - 0.5) * STEP).q[-1]


def main() -> None:
    warnings.simplefilter("ignore", FutureWarning)  # do-mpc's, about CasADi and NumPy
    dynamics = read_dynamics(MakeTorqueArm(ARM))
    plan(ARM, TIMING)  # compiles
    table = Table(
        "costs", "planner", "cold solve (s)", "warm solve, median (s)", f"{STEPS} steps (s)", "elbow at the end"
    )
    for name, movement in MOVEMENTS.items():
        rows = {"drakearm, plan() once": run_plan(movement)}
        rows["drakearm, receding horizon"] = run_receding_horizon(movement)
        if do_mpc:
            rows["do-mpc"] = run_do_mpc(movement, dynamics)
        for planner, (watch, q) in rows.items():
            table.add_row(name, planner, *watch.row(), f"{np.rad2deg(q[1]):.1f} deg")
    console = Console(width=120)
    console.print(table, "CPU / wall time on one core.")
    if do_mpc:
        console.print(f"Accelerations agree to {check_motion(dynamics):.0e} rad/s^2.")
    else:
        console.print("do-mpc is not installed: pip install do-mpc")


if __name__ == "__main__":
    main()
