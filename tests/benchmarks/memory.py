"""How much memory each construction leaves behind, next to Diagrams that hold nothing of drakearm.

`python tests/benchmarks/memory.py` builds each thing many times, drops it, and prints by how much the process has
grown. pydrake keeps Diagrams with Python systems alive: what grows without drakearm is Drake's. `--quick` builds fewer.
"""

import argparse
import gc
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import BasicVector, Context, Diagram, DiagramBuilder, LeafSystem

from drakearm.experiments import load_scenario, make_task_env, scenario_task
from drakearm.model import load_arm
from drakearm.planning import plan
from drakearm.task import TrackingTask

ARM = load_arm("arm14")
SYSTEMS, PORTS = 4, 7  # Python systems of a task's Diagram, and output ports of each on average


class Plain(LeafSystem):
    """A Python system with ports, that computes nothing."""

    def __init__(self) -> None:
        super().__init__()
        self.DeclareVectorInputPort("u", 14)
        for k in range(PORTS):
            self.DeclareVectorOutputPort(f"y{k}", 14, self._calc)

    def _calc(self, context: Context, output: BasicVector) -> None:
        pass


def plain_diagram() -> Diagram:
    """A plant and as many Python systems as a task has, and nothing of drakearm."""
    builder = DiagramBuilder()
    plant = builder.AddSystem(MultibodyPlant(time_step=0.0))
    Parser(plant).AddModels(str(ARM.skeleton))
    plant.Finalize()
    for _ in range(SYSTEMS):
        builder.AddSystem(Plain())
    diagram = builder.Build()
    Simulator(diagram).Initialize()
    return diagram


def constructions() -> dict[str, Callable[[TrackingTask], object]]:
    movement = load_scenario("timing-0.7s").movement
    return {
        "plain Diagram, without drakearm": lambda task: plain_diagram(),
        "DiagramEnv": lambda task: make_task_env(task).reset(seed=0),
        "plan": lambda task: plan(ARM, movement),
    }


def growth(name: str, count: int) -> float:
    """MB that remain of each construction, in this process."""
    construct, task = constructions()[name], scenario_task("timing-0.7s")
    for _ in range(3):  # what the first ones leave is caches
        construct(task)
    gc.collect()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # kB on Linux: the most so far
    for _ in range(count):
        construct(task)
    gc.collect()
    return (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / count / 2**10


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="10 constructions instead of 200")
    parser.add_argument("--one", help=argparse.SUPPRESS)  # measures one construction, in a process of its own
    arguments = parser.parse_args()
    count = 10 if arguments.quick else 200
    if arguments.one:
        print(growth(arguments.one, count))
        return
    print("| construction | MB left behind by each |")
    print("|---|---|")
    for name in constructions():
        command = [sys.executable, str(Path(__file__)), "--one", name, *["--quick"] * arguments.quick]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        print(f"| {name} | {float(done.stdout.split()[-1]):.3f} |", flush=True)


if __name__ == "__main__":
    main()
