"""Forward and backward passes of a multilayer perceptron by hand, in memory that is kept.

Minibatches of a few hundred rows through layers of 64 are so quick that autograd's bookkeeping would cost more than the
arithmetic; and without it two networks can learn in two threads.
"""

from itertools import pairwise

import torch
from torch import Tensor, nn


class Backprop:
    """The passes of an MLP of `nn.Linear` with `nn.Tanh` or one-weight `nn.PReLU` in between, for up to `rows` rows."""

    def __init__(self, mlp: nn.Sequential, rows: int) -> None:
        layers = list(mlp)
        self._linears = [layer for layer in layers if isinstance(layer, nn.Linear)]
        self._activations = [layer for layer in layers if not isinstance(layer, nn.Linear)]
        assert all(isinstance(layer, nn.Tanh | nn.PReLU) for layer in self._activations)
        device = self._linears[0].weight.device

        def rows_of(sizes: list[int]) -> list[Tensor]:
            return [torch.empty(rows, size, device=device) for size in sizes]

        widths = [linear.out_features for linear in self._linears]
        self._sums = rows_of(widths)  # what each linear layer puts out
        self._hidden = rows_of(widths[:-1])  # what each activation puts out
        self._gradients = rows_of(widths[:-1])  # of the loss by the sums of the hidden layers
        self._spare = rows_of(widths[:-1])

    @torch.no_grad()
    def forward(self, inputs: Tensor) -> Tensor:
        """The outputs (n, n_out) of inputs (n, n_in), valid until the next call; n is at most `rows`."""
        n = len(inputs)
        self._inputs, x = inputs, inputs
        for i, linear in enumerate(self._linears):
            sums = self._sums[i][:n]
            torch.addmm(linear.bias, x, linear.weight.t(), out=sums)
            if i == len(self._activations):
                return sums
            activation, x = self._activations[i], self._hidden[i][:n]
            if isinstance(activation, nn.PReLU):
                torch.ops.aten.leaky_relu(sums, activation.weight.item(), out=x)
            else:
                torch.tanh(sums, out=x)
        raise AssertionError("an MLP ends with a linear layer")

    @torch.no_grad()
    def backward(self, by_outputs: Tensor) -> None:
        """Writes the gradients of all weights; by_outputs (n, n_out): that of the loss by the latest outputs."""
        n = len(by_outputs)
        inputs = [self._inputs, *(hidden[:n] for hidden in self._hidden)]
        by_sums = by_outputs
        for i in reversed(range(len(self._linears))):
            linear = self._linears[i]
            torch.mm(by_sums.t(), inputs[i], out=gradient(linear.weight))
            torch.sum(by_sums, 0, out=gradient(linear.bias))
            if i == 0:
                return
            before = self._gradients[i - 1][:n]
            torch.mm(by_sums, linear.weight, out=before)
            activation = self._activations[i - 1]
            if isinstance(activation, nn.PReLU):
                sums, negative = self._sums[i - 1][:n], self._spare[i - 1][:n]
                torch.clamp(sums, max=0.0, out=negative)
                gradient(activation.weight).fill_(torch.dot(before.view(-1), negative.view(-1)))
                slope = activation.weight.item()
                torch.ops.aten.leaky_relu_backward(before, sums, slope, False, grad_input=before)
            else:
                torch.ops.aten.tanh_backward(before, inputs[i], grad_input=before)
            by_sums = before


def gradient(parameter: Tensor) -> Tensor:
    """The gradient of a parameter, to be written into."""
    assert parameter.grad is not None
    return parameter.grad


def flat_weights(module: nn.Module) -> nn.Parameter:
    """All weights of a module as one vector, of which its parameters and their gradients become views.

    Clipping and Adam then cost one operation each, not one for each of two dozen small tensors.
    """
    parameters = list(module.parameters())
    flat = nn.Parameter(nn.utils.parameters_to_vector(parameters).detach())
    flat.grad = torch.zeros_like(flat)
    ends = [0]
    for parameter in parameters:
        ends.append(ends[-1] + parameter.numel())
    for parameter, (start, end) in zip(parameters, pairwise(ends), strict=True):
        parameter.data = flat.data[start:end].view_as(parameter)
        parameter.grad = flat.grad[start:end].view_as(parameter)
    return flat
