"""The hand draws a figure of eight: one policy and a sequence of targets. Writes a picture."""

import sys

import numpy as np
from matplotlib.figure import Figure

from drakearm.diagrams import MakeReachingLoop, MakeSimulator
from drakearm.model import load_arm
from drakearm.model.skeleton import hand_motion
from drakearm.planning import ReachPlanner, posture_at
from drakearm.repertoire import load_repertoire, shipped_policy

STEP = 0.01  # s
TIME = 0.4  # s, from a target to the next one


def main(file: str = "figure_eight.png") -> None:
    arm, repertoire, policy = load_arm(), load_repertoire("reaching"), shipped_policy("reaching")
    planner = ReachPlanner(arm)
    # The figure of eight as targets of the hand (m), and the postures (rad) that bring the hand there.
    phase = np.linspace(0.0, 2.0 * np.pi, 17)
    targets = np.column_stack([0.30 + 0.10 * np.sin(2.0 * phase), 0.45 + 0.15 * np.sin(phase)])
    postures = [np.deg2rad([0.0, 80.0])]
    for x, y in targets:
        postures.append(posture_at(planner.model, x, y, near=postures[-1]))
    # The arm rests at the first target. Each new target is set before the hand is at the one before.
    task = repertoire.task(planner.rest(postures[1]))
    loop = MakeReachingLoop(task, policy.act, lambda q, v, target, a: planner(q, v, target, TIME, a), postures[1])
    simulator = MakeSimulator(loop.diagram)
    context = simulator.get_mutable_context()
    port = loop.diagram.GetInputPort("target")
    port.FixValue(context, postures[1])
    loop.Reset(context)
    simulator.Initialize()
    states = []
    for posture in [*postures[2:], postures[-1]]:
        port.FixValue(context, posture)
        for _ in range(round(0.75 * TIME / STEP)):
            simulator.AdvanceTo(context.get_time() + STEP)
            states.append(loop.diagram.GetOutputPort("arm_state").Eval(context))
    q, v = np.split(np.array(states), 2, axis=1)
    hand = hand_motion(loop.systems.arm.plant, arm, q, v)[0][:, :2]
    figure = Figure()
    panel = figure.subplots()
    panel.plot(*hand.T, label="path of the hand")
    panel.plot(*targets.T, "o", label="targets")
    panel.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
    panel.legend()
    figure.savefig(file)
    miss = [100.0 * np.linalg.norm(hand - target, axis=1).min() for target in targets]
    print(f"The hand passes the targets at {np.mean(miss):.1f} cm on average, and {max(miss):.1f} cm at most.")


if __name__ == "__main__":
    main(*sys.argv[1:])
