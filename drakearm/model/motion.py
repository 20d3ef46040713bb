"""A motion of the skeleton as trajectories over time: collocation finds it, model predictive control follows it."""

from dataclasses import dataclass

from pydrake.trajectories import PiecewisePolynomial


@dataclass(frozen=True)
class Motion:
    """q and v (2 n_q,), and the joint torques (n_q,), over time; SI."""

    states: PiecewisePolynomial
    inputs: PiecewisePolynomial

    def later(self, seconds: float) -> "Motion":
        """The same motion, this many seconds later."""
        motion = Motion(self.states.Clone(), self.inputs.Clone())
        motion.states.shiftRight(seconds)
        motion.inputs.shiftRight(seconds)
        return motion
