"""Forward and backward passes of any network: by hand for the MLPs of drakearm, with autograd for all others."""

from typing import Protocol

import torch
from torch import Tensor, nn

from drakearm.learning.backprop import Backprop, is_mlp


class Passes(Protocol):
    """The passes of a network whose weights `flat_weights` has put into one vector."""

    def forward(self, inputs: Tensor) -> Tensor:
        """The outputs (n, n_out) of inputs (n, n_in), valid until the next call."""

    def backward(self, by_outputs: Tensor) -> None:
        """Writes the gradient of the loss into all weights.

        by_outputs: (n, n_out), the gradient with respect to the outputs of the latest forward pass.
        """


def passes(network: nn.Module) -> Passes:
    """The fastest passes there are for a network."""
    return Backprop(network) if is_mlp(network) else Autograd(network)


class Autograd:
    """The passes of any module, by PyTorch's automatic differentiation."""

    def __init__(self, network: nn.Module) -> None:
        self._network = network

    def forward(self, inputs: Tensor) -> Tensor:
        with torch.enable_grad():
            self._outputs: Tensor = self._network(inputs)
        return self._outputs.detach()

    def backward(self, by_outputs: Tensor) -> None:
        for parameter in self._network.parameters():
            if parameter.grad is not None:
                parameter.grad.zero_()  # autograd adds to it
        self._outputs.backward(by_outputs)
