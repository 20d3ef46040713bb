"""The muscles of many arms, one arm per lane, move like those of each arm alone, for every kind of muscle."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.model import load_arm
from drakearm.model.muscle_lanes import make_muscle_lanes, muscle_kinds, step_muscle_lanes
from drakearm.model.musculature import muscle_step, resting_states
from tests.coupled_arm import with_tensor_paths

ARM = load_arm("arm14")
KINDS = [("thelen2003", "compliant"), ("degroote2016", "compliant"), ("thelen2003", "rigid"), ("degroote2016", "rigid")]


def mixed_arm():
    """The arm with muscles of all kinds. Rigid tendons are made shorter, because they must not exceed their paths."""
    muscles = []
    for i, muscle in enumerate(ARM.muscles):
        model, tendon = KINDS[i % len(KINDS)]
        slack = muscle.tendon_slack_length * (0.97 if tendon == "rigid" else 1.0)
        muscles.append(replace(muscle, model=model, tendon=tendon, tendon_slack_length=slack))
    return replace(ARM, muscles=tuple(muscles))


@pytest.mark.parametrize("arm", [mixed_arm(), with_tensor_paths(mixed_arm(), 1e-3)], ids=["one", "coupled"])
def test_many_arms_with_mixed_muscles_step_like_each_arm_alone(arm):
    """They agree over many steps from rest, while the joints move and the excitations jump."""
    lanes, time_step = 5, 1e-3
    rng = np.random.default_rng(0)
    muscles, paths, kinds = arm.muscle_table, arm.path_table, muscle_kinds(arm.muscle_table)
    q = rng.uniform([-0.5, 0.3], [0.5, 1.5], (lanes, 2))
    alone = resting_states(arm, q, 0.05)
    together, tau, tau_alone = alone.T.copy(), np.zeros((2, lanes)), np.zeros(2)
    work = make_muscle_lanes(len(muscles), paths, 2, lanes)
    for step in range(60):
        if step % 10 == 0:
            v, excitation = rng.normal(0.0, 2.0, (lanes, 2)), rng.random((lanes, len(muscles)))
        x = np.hstack([q, v])
        step_muscle_lanes(
            together,
            tau,
            excitation.T.copy(),
            x.T.copy(),
            time_step,
            muscles,
            np.ones((len(muscles), len(excitation))),
            paths,
            work,
            *kinds,
        )
        for k in range(lanes):
            muscle_step(alone[k], tau_alone, excitation[k], x[k], time_step, muscles, paths)
            np.testing.assert_allclose(together[:, k], alone[k], rtol=1e-9, atol=1e-9)
            np.testing.assert_allclose(tau[:, k], tau_alone, rtol=1e-8, atol=1e-8)
        q = q + time_step * v


def test_kinds_that_an_arm_lacks_are_none():
    kinds = muscle_kinds(ARM.muscle_table)
    assert kinds.degroote2016 is None and kinds.rigid is None
    np.testing.assert_array_equal(kinds.thelen2003, np.arange(14))
    kinds = muscle_kinds(mixed_arm().muscle_table)
    assert sorted(np.concatenate(kinds)) == list(range(14))
