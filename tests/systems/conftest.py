"""A fixture for tests that fix the inputs of a system and evaluate its outputs."""

import pytest


@pytest.fixture
def outputs():
    """A function that evaluates named output ports of a system with given inputs, by default in a new context."""

    def evaluate(system, inputs, names, context=None):
        context = context or system.CreateDefaultContext()
        for name, value in inputs.items():
            system.GetInputPort(name).FixValue(context, value)
        return [system.GetOutputPort(name).Eval(context) for name in names]

    return evaluate
