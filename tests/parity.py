"""Compares compiled environments with those of Diagrams, step by step."""

from functools import partial

import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from drakearm.experiments.environments import make_task_env

TOLERANCE = {"first observation": 2.0**-23, "observation": 2.0**-23, "final_obs": 2.0**-23}  # float32; all else: 1e-8


def diagrams(tasks):
    """Gymnasium's own vector environment of DiagramEnvs, one for each task or list of tasks."""
    return SyncVectorEnv([partial(make_task_env, task) for task in tasks], autoreset_mode=AutoresetMode.SAME_STEP)


def assert_same(names, step, actual, expected):
    """Compares a step. The message names the quantity and the scenario that differ.

    actual, expected: arrays (N, ...) by quantity.
    """
    for quantity, values in actual.items():
        tolerance = TOLERANCE.get(quantity, 1e-8)
        desired = np.asarray(expected[quantity], dtype=float)
        excess = np.abs(values - desired) - tolerance * np.abs(desired) - 1e-8
        arms = excess.reshape(len(names), -1).max(axis=1)
        worst = int(arms.argmax())
        assert arms[worst] <= 0.0, (
            f"{names[worst]} differs at step {step} in {quantity}: {values[worst]}, on the Diagram {desired[worst]}"
        )


def transition(step, names):
    """What a step returned, by quantity. After a reset, the info is that of the transition and not of the reset."""
    observation, reward, terminated, truncated, info = step
    reported = {name: info[name].copy() for name in ("arm_state", "activation", "tracking_error")}
    final = np.zeros_like(observation)
    for i in np.flatnonzero(truncated):
        final[i] = info["final_obs"][i]
        for name, values in reported.items():
            values[i] = info.get("final_info", info)[name][i]
    ends = {"terminated": terminated.astype(float), "truncated": truncated.astype(float)}
    return reported | {"reward": reward} | ends | {"final_obs": final, "observation": observation}


def assert_parity(names, many, ones, actions, seed, first=0):
    """Compares the arms of `many`, from arm `first`, with the environments `ones`.

    actions: (steps, arms of many, muscles).
    """
    arms = slice(first, first + len(names))
    observation, _ = many.reset(seed=seed)
    desired, _ = ones.reset(seed=seed + first)
    assert_same(names, 0, {"first observation": observation[arms]}, {"first observation": desired})
    for k, action in enumerate(actions):
        *result, info = many.step(action)
        info = {name: values[arms] for name, values in info.items()}
        actual = transition((*(values[arms] for values in result), info), names)
        assert_same(names, k, actual, transition(ones.step(action[arms]), names))
