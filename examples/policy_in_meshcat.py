"""Runs a trained policy in a Diagram of your own, here with noise on its observation, and shows it in Meshcat.

Usage: python examples/policy_in_meshcat.py runs/timing-0.7s
"""

import sys
from pathlib import Path

from pydrake.common import RandomDistribution
from pydrake.geometry import Meshcat, MeshcatParams
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import Adder, Gain, RandomSource

from drakearm.diagrams import AddMuscleVisualizer, AddTrackingTask, MakeSimulator
from drakearm.experiments.scenario import load_scenario
from drakearm.learning import Policy
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.systems import PolicyController


def main(run: Path, realtime_rate: float = 0.25) -> None:
    scenario = load_scenario(run / "scenario.yaml")
    task = scenario.task(Reference.load(run / "reference.npz"))
    policy = Policy.load(run / "policy.safetensors")
    meshcat = Meshcat(MeshcatParams(host="localhost"))

    builder = DiagramBuilder()
    systems = AddTrackingTask(builder, task)
    senses = systems.proprioception.get_output_port()
    noise = builder.AddSystem(RandomSource(RandomDistribution.kGaussian, senses.size(), CONTROL_STEP))
    scaled = builder.AddSystem(Gain(0.005, senses.size()))
    sensed = builder.AddSystem(Adder(2, senses.size()))
    controller = builder.AddSystem(PolicyController(policy.act, senses.size(), policy.n_actions, CONTROL_STEP))
    builder.Connect(noise.get_output_port(), scaled.get_input_port())
    builder.Connect(scaled.get_output_port(), sensed.get_input_port(0))
    builder.Connect(senses, sensed.get_input_port(1))
    builder.Connect(sensed.get_output_port(), controller.GetInputPort("observation"))
    builder.Connect(controller.GetOutputPort("excitation"), systems.excitation)
    AddMuscleVisualizer(builder, systems.arm, meshcat)
    diagram = builder.Build()

    simulator = MakeSimulator(diagram)
    simulator.set_target_realtime_rate(realtime_rate)
    systems.Reset(simulator.get_mutable_context())
    simulator.AdvanceTo(task.reference.duration)
    error = systems.reward.GetOutputPort("tracking_error")
    final = error.Eval(systems.reward.GetMyContextFromRoot(simulator.get_context()))
    print(f"shown at {meshcat.web_url()}; error at the end {final.round(4)} rad")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "runs/timing-0.7s"))
