"""ReferenceSource: what it refuses, because a reference of another size would end the simulation in C++."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import TaskError
from drakearm.model import Reference
from drakearm.systems import ReferenceSource


def test_a_reference_that_no_arm_can_follow_is_refused(reference):
    with pytest.raises(TaskError, match=r"An arm cannot follow the reference: t\[1\]: found 0.005, expected 0.01"):
        ReferenceSource(replace(reference, t=0.5 * reference.t), (0,))
    source = ReferenceSource(reference, (0,))
    context = source.CreateDefaultContext()
    one = Reference(reference.t, *(x[:, :1] for x in (reference.q, reference.v, reference.a, reference.tau)))
    with pytest.raises(TaskError, match="The reference has 1 joints: expected 2"):
        source.SetReference(context, one)
    assert source.Reference(context) is not one
    moved = replace(reference, q=reference.q + 0.1)
    source.SetReference(context, moved)
    np.testing.assert_allclose(source.GetOutputPort("reference").Eval(context)[:2], moved.q[0])
