"""Helpers for tests that fix the inputs of a system and evaluate its outputs."""

import pytest


@pytest.fixture
def outputs():
    """Evaluates the named output ports of a system with the given inputs; `context` may be prepared before."""

    def evaluate(system, inputs, names, context=None):
        context = context or system.CreateDefaultContext()
        for name, value in inputs.items():
            system.GetInputPort(name).FixValue(context, value)
        return [system.GetOutputPort(name).Eval(context) for name in names]

    return evaluate
