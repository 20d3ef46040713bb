"""What comes before PPO: an actor imitates static optimization, or the arms move at random."""

from collections.abc import Callable, Sequence

from gymnasium.vector import VectorEnv

from drakearm.errors import TrainingError
from drakearm.learning.arm_vector_env import ArmVectorEnv
from drakearm.learning.imitation import imitate
from drakearm.learning.input_scaling import InputScaling
from drakearm.learning.networks import Actor
from drakearm.learning.ppo_settings import PpoSettings
from drakearm.learning.survey import survey
from drakearm.task import TrackingTask


def prepare(
    actor: Actor,
    tasks: Sequence[TrackingTask],
    settings: PpoSettings,
    seed: int,
    on_round: Callable[[int], None] | None = None,
) -> InputScaling:
    """Trains an actor by as many rounds of imitation as the settings say. Returns the scaling of its inputs.

    If the settings have no rounds of imitation, the actor stays as it is, and a survey gives the scaling. on_round:
    called after each round with its number, from 1.
    """
    if settings.imitation_rounds:
        return imitate(
            actor,
            tasks,
            settings.imitation_rounds,
            seed,
            on_round,
            settings.environments,
            settings.imitation_stiffness,
        )
    return survey(tasks, settings.initial_action, settings.initial_std, seed)


def default_preparation(actor: Actor, envs: VectorEnv, settings: PpoSettings, seed: int) -> InputScaling:
    """What `train` does before PPO if it is told nothing else: `prepare` with the tasks of an ArmVectorEnv.

    Other environments have no tasks: the actor and the inputs stay as they are. Raises TrainingError if the settings
    ask for imitation there.
    """
    if isinstance(envs, ArmVectorEnv):
        return prepare(actor, envs.tasks, settings, seed)
    if settings.imitation_rounds:
        raise TrainingError(
            f"The settings ask for {settings.imitation_rounds} rounds of imitation, but {type(envs).__name__} has no "
            "tasks to imitate: expected an ArmVectorEnv without wrappers, the argument prepare, or imitation_rounds=0."
        )
    assert envs.single_observation_space.shape
    return InputScaling.none(envs.single_observation_space.shape[0])
