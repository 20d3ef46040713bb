"""The experiments of the paper, by name."""

from drakearm.reproduction.experiment import Experiment
from drakearm.reproduction.lifting import Lifting
from drakearm.reproduction.obstacle import ObstacleAvoidance
from drakearm.reproduction.reaching import Reaching
from drakearm.reproduction.timing import Timing

EXPERIMENTS: dict[str, Experiment] = {
    experiment.name: experiment for experiment in (Reaching(), Timing(), Lifting(), ObstacleAvoidance())
}
