"""Noise: normal random numbers, which come from the generator of a run."""

import numpy as np
from pydrake.common import RandomDistribution, RandomGenerator
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import LinearTransformDensity, RandomSource

_NORMAL = RandomDistribution.kGaussian


class Noise(Diagram):
    """Normal random numbers with mean 0 and standard deviation 1, new ones at every step: Drake's RandomSource.

    .. pydrake_system::

        name: Noise
        output_ports:
        - noise

    size: how many. step: s. Before `Begin`, and after one without a generator, the output is 0.
    """

    def __init__(self, size: int, step: float):
        super().__init__()
        builder = DiagramBuilder()
        self._source = builder.AddNamedSystem("source", RandomSource(_NORMAL, size, step))
        self._switch = builder.AddNamedSystem("switch", LinearTransformDensity(_NORMAL, size, size))
        builder.Connect(self._source.get_output_port(), self._switch.get_input_port_w_in())
        builder.ExportOutput(self._switch.get_output_port_w_out(), "noise")
        builder.BuildInto(self)

    def Begin(self, root_context: Context, rng: np.random.Generator | None = None) -> None:
        """Seeds the source from rng. Without one, the output becomes 0."""
        size = self._switch.get_output_port_w_out().size()
        context = self._switch.GetMyMutableContextFromRoot(root_context)
        self._switch.FixConstantA(context, np.zeros((size, size)) if rng is None else np.eye(size))
        if rng is not None:
            source_context = self._source.GetMyMutableContextFromRoot(root_context)
            self._source.SetRandomContext(source_context, RandomGenerator(int(rng.integers(2**32))))
