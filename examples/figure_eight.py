"""The hand draws a figure of eight: one policy, a sequence of targets, no training.

Run: python examples/figure_eight.py [picture.png]
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from drakearm.diagrams import MakeReachingLoop, MakeSimulator
from drakearm.model import load_arm
from drakearm.model.skeleton import hand_motion
from drakearm.planning import ReachPlanner, posture_at
from drakearm.repertoire import load_repertoire
from drakearm.repertoire.shipped import shipped_policy

STEP = 0.01  # s
TIME = 0.4  # s, from a target to the next one

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
loop.diagram.GetInputPort("target").FixValue(context, postures[1])
loop.Reset(context)
simulator.Initialize()
states = []
for posture in [*postures[2:], postures[-1]]:
    loop.diagram.GetInputPort("target").FixValue(context, posture)
    for _ in range(round(0.75 * TIME / STEP)):
        simulator.AdvanceTo(context.get_time() + STEP)
        states.append(loop.diagram.GetOutputPort("arm_state").Eval(context))
q, v = np.split(np.array(states), 2, axis=1)
hand, _ = hand_motion(loop.systems.arm.plant, arm, q, v)

plt.plot(*hand[:, :2].T, label="path of the hand")
plt.plot(*targets.T, "o", label="targets")
plt.axis("equal")
plt.xlabel("x (m)")
plt.ylabel("y (m)")
plt.legend()
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "figure_eight.png")
miss = [np.linalg.norm(hand[:, :2] - target, axis=1).min() for target in targets]
print(f"The hand passes the targets at {100 * np.mean(miss):.1f} cm on average, at most {100 * max(miss):.1f} cm.")
