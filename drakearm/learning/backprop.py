"""Forward and backward passes of a multilayer perceptron (MLP), written by hand, in memory that is reused.

For minibatches of a few hundred rows and layers of 64 units, autograd's bookkeeping would take longer than the
arithmetic. Without autograd, two networks can also learn in two threads at the same time.
"""

from typing import TypeGuard

import torch
from torch import Tensor, nn

_ALIGNMENT = 16  # floats: 64 bytes, the alignment of torch's own tensors


def is_mlp(network: nn.Module) -> TypeGuard[nn.Sequential]:
    """Whether `Backprop` can compute a network: linear layers with tanh or one-weight PReLU between them."""
    if type(network) is not nn.Sequential or len(network) % 2 == 0:
        return False
    layers = list(network.children())
    linear = all(type(layer) is nn.Linear and layer.bias is not None for layer in layers[::2])
    return linear and all(
        type(layer) is nn.Tanh or (type(layer) is nn.PReLU and layer.num_parameters == 1) for layer in layers[1::2]
    )


class Backprop:
    """Forward and backward pass of an MLP: `nn.Linear` layers with `nn.Tanh` or one-weight `nn.PReLU` between them.

    If `flat_weights` is used, call it before this constructor, which keeps references to the weights.
    """

    def __init__(self, mlp: nn.Sequential) -> None:
        layers = list(mlp)
        linears = [layer for layer in layers if isinstance(layer, nn.Linear)]
        self._weights = [linear.weight for linear in linears]
        self._biases = [linear.bias for linear in linears]
        self._transposed = [weight.t() for weight in self._weights]
        self._activations = [layer for layer in layers if not isinstance(layer, nn.Linear)]
        assert is_mlp(mlp)
        self._allocate(0)

    def _allocate(self, rows: int) -> None:
        self._rows = rows
        self._sums = [bias.new_empty(rows, len(bias)) for bias in self._biases]  # outputs of the linear layers
        self._hidden = [torch.empty_like(sums) for sums in self._sums[:-1]]  # outputs of the activations
        self._gradients = [torch.empty_like(sums) for sums in self._sums[:-1]]  # of the loss by these outputs
        self._negative = [torch.empty_like(sums) for sums in self._sums[:-1]]  # working memory for min(sums, 0)

    @torch.no_grad()
    def forward(self, inputs: Tensor) -> Tensor:
        """The outputs (n, n_out) of inputs (n, n_in), valid until the next call. Memory is reused for equal n."""
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
        """Writes the gradient of the loss into all weights.

        by_outputs: (n, n_out), the gradient with respect to the outputs of the latest forward pass.
        """
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
                sums, negative = self._sums[i - 1], self._negative[i - 1]
                torch.clamp(sums, max=0.0, out=negative)
                gradient(activation.weight).fill_(torch.dot(before.view(-1), negative.view(-1)))
                slope = activation.weight.item()
                torch.ops.aten.leaky_relu_backward(before, sums, slope, False, grad_input=before)
            else:
                torch.ops.aten.tanh_backward(before, inputs[i], grad_input=before)
            by_sums = before


def gradient(parameter: Tensor) -> Tensor:
    """The gradient of a parameter, as memory to write into."""
    assert parameter.grad is not None
    return parameter.grad


def flat_weights(module: nn.Module) -> nn.Parameter:
    """All weights of a module as one vector. The parameters of the module and their gradients become views of it.

    Clipping and Adam then take one operation each, instead of one for each of about two dozen small tensors. Each view
    starts at a multiple of _ALIGNMENT, as a tensor with its own memory does: at other addresses, matrix products round
    differently. The numbers between the views are 0, and so are their gradients.
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
