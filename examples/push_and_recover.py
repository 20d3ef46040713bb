"""Pushes the arm during a movement: model predictive control still brings it to its target."""

import numpy as np
from pydrake.trajectories import PiecewisePolynomial

from drakearm.diagrams import MakeMpcLoop
from drakearm.experiments.scenario import load_scenario
from drakearm.model import load_arm
from drakearm.planning import PlanningModel, RecedingHorizon

PUSH_AT = 0.35  # s


def main() -> np.ndarray:
    """Prints where the arm is at some times; returns how far it is from the target at the end (n_q,), rad."""
    arm, movement = load_arm("arm14"), load_scenario("timing-0.7s").movement
    planner = RecedingHorizon(PlanningModel(arm), movement, horizon=1.6)
    torques = np.array([[0.0, 0.0], [-2.0, 2.0], [0.0, 0.0], [0.0, 0.0]])  # Nm, on shoulder and elbow, for 50 ms
    push = PiecewisePolynomial.ZeroOrderHold([0.0, PUSH_AT, PUSH_AT + 0.05, 2.0], torques.T)
    pushed = MakeMpcLoop(arm, planner, disturbance=push).Run(movement.start, 1.2)
    for time in (PUSH_AT, PUSH_AT + 0.05, 0.7, 1.2):
        q = np.rad2deg(pushed.q[round(time / 0.01)])
        print(f"{time:.2f} s: shoulder {q[0]:6.2f}, elbow {q[1]:6.2f} deg")
    return pushed.q[-1] - movement.target


if __name__ == "__main__":
    main()
