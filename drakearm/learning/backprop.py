"""Forward and backward passes of a multilayer perceptron by hand, in memory that is kept.

Minibatches of a few hundred rows through layers of 64 are so quick that autograd's bookkeeping would cost more than the
arithmetic; and without it two networks can learn in two threads.
"""

import torch
from torch import Tensor, nn

_ALIGNMENT = 16  # floats: 64 bytes, the alignment of torch's own tensors


class Backprop:
    """The passes of an MLP of `nn.Linear` with `nn.Tanh` or one-weight `nn.PReLU` in between.

    Made after `flat_weights`, whose views it keeps.
    """

    def __init__(self, mlp: nn.Sequential) -> None:
        layers = list(mlp)
        linears = [layer for layer in layers if isinstance(layer, nn.Linear)]
        self._weights = [linear.weight for linear in linears]
        self._biases = [linear.bias for linear in linears]
        self._transposed = [weight.t() for weight in self._weights]
        self._activations = [layer for layer in layers if not isinstance(layer, nn.Linear)]
        assert all(isinstance(layer, nn.Tanh | nn.PReLU) for layer in self._activations)
        self._allocate(0)

    def _allocate(self, rows: int) -> None:
        self._rows = rows
        self._sums = [bias.new_empty(rows, len(bias)) for bias in self._biases]  # what each linear layer puts out
        self._hidden = [torch.empty_like(sums) for sums in self._sums[:-1]]  # what each activation puts out
        self._gradients = [torch.empty_like(sums) for sums in self._sums[:-1]]  # of the loss by the hidden sums
        self._spare = [torch.empty_like(sums) for sums in self._sums[:-1]]

    @torch.no_grad()
    def forward(self, inputs: Tensor) -> Tensor:
        """The outputs (n, n_out) of inputs (n, n_in), valid until the next call; quickest with the same n again."""
        if len(inputs) != self._rows:
            self._allocate(len(inputs))
        self._inputs = x = inputs
        for i, sums in enumerate(self._sums):
            torch.addmm(self._biases[i], x, self._transposed[i], out=sums)
            if i == len(self._activations):
                return sums
            activation, x = self._activations[i], self._hidden[i]
            if isinstance(activation, nn.PReLU):
                torch.ops.aten.leaky_relu(sums, activation.weight.item(), out=x)
            else:
                torch.tanh(sums, out=x)
        raise AssertionError("an MLP ends with a linear layer")

    @torch.no_grad()
    def backward(self, by_outputs: Tensor) -> None:
        """Writes the gradients of all weights; by_outputs (n, n_out): that of the loss by the latest outputs."""
        inputs = [self._inputs, *self._hidden]
        by_sums = by_outputs
        for i in reversed(range(len(inputs))):
            torch.mm(by_sums.t(), inputs[i], out=gradient(self._weights[i]))
            torch.sum(by_sums, 0, out=gradient(self._biases[i]))
            if i == 0:
                return
            before = self._gradients[i - 1]
            torch.mm(by_sums, self._weights[i], out=before)
            activation = self._activations[i - 1]
            if isinstance(activation, nn.PReLU):
                sums, negative = self._sums[i - 1], self._spare[i - 1]
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

    Clipping and Adam then cost one operation each, not one for each of two dozen small tensors. Each view starts at a
    multiple of _ALIGNMENT, as memory of its own would: matrix products round differently elsewhere. The numbers between
    the views are 0, and so are their gradients.
    """
    parameters = list(module.parameters())
    lengths = [-(-parameter.numel() // _ALIGNMENT) * _ALIGNMENT for parameter in parameters]
    flat = nn.Parameter(parameters[0].new_zeros(sum(lengths)))
    flat.grad = torch.zeros_like(flat)
    for parameter, values, gradients in zip(
        parameters, flat.data.split(lengths), flat.grad.split(lengths), strict=True
    ):
        view = values[: parameter.numel()].view_as(parameter)
        view.copy_(parameter.data)
        parameter.data = view
        parameter.grad = gradients[: parameter.numel()].view_as(parameter)
    return flat


def separate_weights(module: nn.Module) -> None:
    """Undoes `flat_weights`: gives each parameter memory of its own, without a gradient."""
    for parameter in module.parameters():
        parameter.data, parameter.grad = parameter.data.clone(), None
