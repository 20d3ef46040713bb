"""The environments of scenarios: a single one, or many in one vector environment."""

import logging
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, VectorEnv
from pydrake.geometry import Meshcat, MeshcatParams
from pydrake.systems.framework import Context

from drakearm.diagrams import MakeTrackingTask
from drakearm.experiments.choices import EnvKind
from drakearm.experiments.scenario import load_scenario
from drakearm.learning import ArmVectorEnv, DiagramEnv
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.planning import plan
from drakearm.task import TrackingTask, check_interchangeable


def make_env(scenario: str | Path, reference: Reference | None = None, render_mode: str | None = None) -> DiagramEnv:
    """The environment of a scenario (name or file): a Drake Diagram in which the muscles follow a planned movement.

    `gymnasium.make("drakearm/Track-v0", scenario=...)` makes it. reference: the movement to follow; without one, the
    scenario is planned. The tables are for the scenarios of the paper, whose arm is `arm14`. Another limb has its own
    muscles and joints in their place. The muscles are, in this order: TRIlong, TRIlat, TRImed, BIClong, BICshort, BRA,
    ANC, BRD, ECRL, ECRB, ECU, FCR, FCU, PL.

    Action: `Box(0, 1, (14,), float32)`, held for one control step of 0.01 s.

    | index | action                 | min | max | unit |
    |-------|------------------------|-----|-----|------|
    | 0-13  | excitation, per muscle | 0   | 1   | 1    |

    Observation: `Box(-inf, inf, (58,), float32)` with the set `full`, which all shipped scenarios have. With the set
    `paper`, as in `preset: paper`, it is `Box(-inf, inf, (28,), float32)` and has only the first two rows.

    | index | sense            | observation                                               | min    | max   | unit |
    |-------|------------------|-----------------------------------------------------------|--------|-------|------|
    | 0-13  | `fiber_length`   | fiber length / optimal fiber length, per muscle           | 0.01   | inf   | 1    |
    | 14-27 | `fiber_velocity` | fiber velocity / maximum contraction velocity, per muscle | -inf   | inf   | 1    |
    | 28-41 | `activation`     | activation, per muscle                                    | 0.01   | 1     | 1    |
    | 42    | `arm_state`      | q of the shoulder                                         | -1.571 | 3.142 | rad  |
    | 43    | `arm_state`      | q of the elbow                                            | 0      | 2.269 | rad  |
    | 44    | `arm_state`      | 0.1 s/rad times v of the shoulder                         | -inf   | inf   | 1    |
    | 45    | `arm_state`      | 0.1 s/rad times v of the elbow                            | -inf   | inf   | 1    |
    | 46    | `preview_q`      | desired q of the shoulder now                             | -1.571 | 3.142 | rad  |
    | 47    | `preview_q`      | desired q of the elbow now                                | 0      | 2.269 | rad  |
    | 48    | `preview_q`      | desired q of the shoulder in 0.03 s                       | -1.571 | 3.142 | rad  |
    | 49    | `preview_q`      | desired q of the elbow in 0.03 s                          | 0      | 2.269 | rad  |
    | 50    | `preview_q`      | desired q of the shoulder in 0.08 s                       | -1.571 | 3.142 | rad  |
    | 51    | `preview_q`      | desired q of the elbow in 0.08 s                          | 0      | 2.269 | rad  |
    | 52    | `preview_v`      | 0.1 s/rad times desired v of the shoulder now             | -1.5   | 1.5   | 1    |
    | 53    | `preview_v`      | 0.1 s/rad times desired v of the elbow now                | -1.5   | 1.5   | 1    |
    | 54    | `preview_v`      | 0.1 s/rad times desired v of the shoulder in 0.03 s       | -1.5   | 1.5   | 1    |
    | 55    | `preview_v`      | 0.1 s/rad times desired v of the elbow in 0.03 s          | -1.5   | 1.5   | 1    |
    | 56    | `preview_v`      | 0.1 s/rad times desired v of the shoulder in 0.08 s       | -1.5   | 1.5   | 1    |
    | 57    | `preview_v`      | 0.1 s/rad times desired v of the elbow in 0.08 s          | -1.5   | 1.5   | 1    |

    Fiber velocities are positive if the fiber lengthens. The limits of q are the joint ranges; the stops there are
    elastic, so q can exceed them slightly. The limits of desired q and v are those of the plan: the joint ranges, and
    the `speed_limit` of these scenarios, 15 rad/s.

    Reward: a number, at most 0, computed from the angles q, speeds v and accelerations a of all joints j at the end of
    the step, with the weights of `tracking.reward` in the scenario (Denizdurduran et al. 2022, eq. 6):

        reward = -sum_j (position_j (q_d,j - q_j)^2 + velocity_j (v_d,j - v_j)^2 + acceleration_j a_j^2)

    | weight       | these scenarios   | unit      |
    |--------------|-------------------|-----------|
    | position     | 10                | 1/rad^2   |
    | velocity     | 0.1               | s^2/rad^2 |
    | acceleration | 1e-6              | s^4/rad^2 |

    An episode starts at rest at the first posture of the reference, with noise of `start_noise_deg` on the angles and
    with activations of 0.05. It is truncated at the end of the reference and never terminated. `info` has `arm_state`
    (q and v, not scaled), `tracking_error` (q minus desired q, rad) and `activation`.

    render_mode: "rgb_array" for pictures from `render`, which need no display, or "human" to see the arm in Meshcat, in
    real time; the logger `drakearm` says the address of the page.
    """
    return make_task_env(scenario_task(scenario, reference), render_mode)


def make_vector_env(
    scenario: str | Path | Sequence[str | Path],
    num_envs: int,
    *,
    autoreset_mode: AutoresetMode = AutoresetMode.SAME_STEP,
    max_episode_steps: int | None = None,
) -> ArmVectorEnv:
    """Environments of one scenario (name or file), or of several that are assigned round-robin.

    Each environment follows the plan of its scenario. `gymnasium.make_vec("drakearm/Track-v0", num_envs=...,
    scenario=...)` makes them. Spaces and rewards are those of `make_env`. autoreset_mode, max_episode_steps: see
    `ArmVectorEnv`.
    """
    scenarios = [scenario] if isinstance(scenario, str | Path) else scenario
    tasks = [scenario_task(one) for one in scenarios]
    return ArmVectorEnv(tasks, num_envs, autoreset_mode=autoreset_mode, max_episode_steps=max_episode_steps)


def scenario_task(scenario: str | Path, reference: Reference | None = None) -> TrackingTask:
    """The task of a scenario (name or file). Without a reference, the scenario is planned."""
    loaded = load_scenario(scenario)
    return loaded.task(
        reference or plan(loaded.loaded_arm, loaded.movement, loaded.load_mass, loaded.obstacle).reference
    )


def make_task_env(task: TrackingTask | Sequence[TrackingTask], render_mode: str | None = None) -> DiagramEnv:
    """The environment of a task, or of several, of which each reset draws one. An episode lasts as long as its plan.

    Several tasks must have the same arm, senses, lookahead and reward. Raises TaskError if they do not. render_mode:
    see `make_env`.
    """
    tasks = [task] if isinstance(task, TrackingTask) else list(task)
    check_interchangeable(tasks)
    several = len(tasks) > 1
    meshcat = Meshcat(MeshcatParams(host="localhost")) if render_mode == "human" else None
    if meshcat is not None:
        logging.getLogger("drakearm").info("The arm moves at %s", meshcat.web_url())
    diagram, systems = MakeTrackingTask(tasks[0], varies=True if several else None, meshcat=meshcat)
    render = _picture_of(tasks[0]) if render_mode == "rgb_array" else None

    def reset(context: Context, rng: np.random.Generator) -> None:
        systems.Reset(context, rng, tasks[rng.integers(len(tasks))] if several else None)

    def episode_steps(context: Context) -> int:
        return len(systems.reference.Reference(context).t) - 1

    return DiagramEnv(
        diagram,
        reset,
        control_step=CONTROL_STEP,
        episode_steps=episode_steps,
        max_episode_steps=max(len(one.reference.t) - 1 for one in tasks),
        render_mode=render_mode,
        render=render,
    )


def _picture_of(task: TrackingTask) -> Callable[[dict[str, Any]], np.ndarray]:
    """A function from the info of a step to a picture."""
    from drakearm.figures.arm_frame import ArmFrame  # matplotlib, which most environments do not need

    frame, n_q = ArmFrame(task.arm, task.obstacle), len(task.arm.coordinates)

    def picture(info: dict[str, Any]) -> np.ndarray:
        q = info["arm_state"][:n_q]
        return frame.draw(q, info["activation"], q - info["tracking_error"])

    return picture


def make_training_envs(task: TrackingTask, count: int, kind: EnvKind) -> VectorEnv:
    """A vector environment with `count` environments of a task."""
    if kind is EnvKind.compiled:
        return ArmVectorEnv(task, count)
    warm_up = make_task_env(task)  # compiles the muscles once, before the processes fork
    warm_up.reset()
    warm_up.step(warm_up.action_space.sample())
    return AsyncVectorEnv(
        [partial(make_task_env, task)] * count,
        context="fork",
        autoreset_mode=AutoresetMode.SAME_STEP,
    )
