"""The environments in which a scenario is learned, alone or many at once."""

from collections.abc import Sequence
from functools import lru_cache, partial
from pathlib import Path

from gymnasium.vector import AsyncVectorEnv, AutoresetMode, VectorEnv

from drakearm.diagrams import MakeTrackingTask
from drakearm.experiments.choices import EnvKind
from drakearm.experiments.scenario import load_scenario
from drakearm.learning import ArmVectorEnv, DiagramEnv
from drakearm.model import load_arm
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.planning import plan
from drakearm.task import TrackingTask


def make_env(scenario: str | Path, reference: Reference | None = None) -> DiagramEnv:
    """The environment of a scenario (name or file), with its own plan as reference unless one is given.

    This is what `gymnasium.make("drakearm/Track-v0", scenario=...)` makes.
    """
    return make_task_env(scenario_task(scenario, reference))


def make_vector_env(scenario: str | Path | Sequence[str | Path], num_envs: int) -> ArmVectorEnv:
    """Environments of one scenario (name or file) or, round-robin, of several; each follows its own plan.

    This is what `gymnasium.make_vec("drakearm/Track-v0", num_envs=..., scenario=...)` makes.
    """
    scenarios = [scenario] if isinstance(scenario, str | Path) else scenario
    return ArmVectorEnv([scenario_task(one) for one in scenarios], num_envs)


def scenario_task(scenario: str | Path, reference: Reference | None = None) -> TrackingTask:
    """The task of a scenario (name or file), with its own plan as reference unless one is given."""
    return load_scenario(scenario).task(reference or _planned(scenario))


def make_task_env(task: TrackingTask) -> DiagramEnv:
    """The environment of a task: one episode is the reference from start to end."""
    diagram, systems = MakeTrackingTask(task)
    episode_steps = len(task.reference.t) - 1
    return DiagramEnv(diagram, systems.Reset, control_step=CONTROL_STEP, episode_steps=episode_steps)


def make_training_envs(task: TrackingTask, count: int, kind: EnvKind) -> VectorEnv:
    """`count` environments of a task."""
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


@lru_cache(maxsize=32)
def _planned(scenario: str | Path) -> Reference:
    loaded = load_scenario(scenario)
    return plan(load_arm(loaded.arm), loaded.movement, loaded.load_mass, loaded.obstacle).reference
