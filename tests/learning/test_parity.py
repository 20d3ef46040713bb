"""DiagramEnv and ArmVectorEnv compute the same in whole episodes of all shipped scenarios, alone and in one batch."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from drakearm.experiments import scenario_files
from drakearm.experiments.environments import scenario_task
from drakearm.learning import ArmVectorEnv
from drakearm.learning.compiled_arm import LANES
from drakearm.task import (
    OBSERVATIONS,
    SENSES,
    RandomDelay,
    Randomization,
    RandomLoad,
    RandomMotorNoise,
    RandomStart,
    RandomStrength,
    Reward,
    Sense,
    Start,
    StartState,
)
from tests.coupled_arm import with_tensor_paths
from tests.parity import assert_parity, diagrams
from tests.shipped import OTHER_LIMBS, PAPER

BEYOND = 5  # steps into the second episode
WEAK = 0.2  # times the excitations of light limbs: with more, time steps of 1 ms are unstable and rounding errors grow


def draw_actions(kind, steps, arms, seed=0, muscles=14):
    """Excitations (steps, arms, muscles): uniform in [0, 1], or distributed as those of an untrained policy."""
    rng = np.random.default_rng(seed)
    if kind == "uniform":
        return rng.random((steps, arms, muscles))
    return np.clip(0.15 + 0.2 * rng.standard_normal((steps, arms, muscles)), 0.0, 1.0)


@pytest.mark.parametrize("kind", ["uniform", "policy"])
@pytest.mark.parametrize("name", scenario_files())
def test_every_scenario(name, kind):
    task, arms = scenario_task(name), 2
    actions = draw_actions(kind, len(task.reference.t) - 1 + BEYOND, arms, muscles=len(task.arm.muscles))
    actions = WEAK * actions if name in OTHER_LIMBS else actions
    assert_parity([name] * arms, ArmVectorEnv(task, arms), diagrams([task] * arms), actions, seed=7)


@pytest.mark.parametrize("kind", ["uniform", "policy"])
def test_all_movements_of_one_arm_in_one_batch(kind):
    """Every scenario has seven arms. The fourth one is compared, so that arms from two blocks of lanes are compared."""
    tasks = [scenario_task(name) for name in PAPER]
    many = ArmVectorEnv(tasks, 7 * len(tasks))
    assert LANES < many.num_envs < 2 * LANES
    steps = max(len(task.reference.t) for task in tasks) + BEYOND
    actions = draw_actions(kind, steps, many.num_envs)
    assert_parity(PAPER, many, diagrams(tasks), actions, seed=7, first=3 * len(tasks))


def test_the_papers_observation(task):
    task = replace(task, senses=OBSERVATIONS["paper"], load_mass=5.0)
    actions = draw_actions("uniform", len(task.reference.t) - 1 + BEYOND, 2)
    assert_parity(["paper"] * 2, ArmVectorEnv(task, 2), diagrams([task] * 2), actions, seed=7)


def test_paths_that_depend_on_two_coordinates_together(task):
    task = replace(task, arm=with_tensor_paths(task.arm, 1e-3))
    actions = draw_actions("uniform", len(task.reference.t) - 1 + BEYOND, 2)
    assert_parity(["coupled"] * 2, ArmVectorEnv(task, 2), diagrams([task] * 2), actions, seed=7)


@dataclass(frozen=True)
class Effort(Reward):
    """A user's reward: minus squared excitations, squared error of the elbow and tendon forces, with weights."""

    type = "test_effort"
    reads = ("excitation", "tendon_force", "reference", "arm_state")
    weight: float

    def __call__(self, *signals):
        excitation, force, reference, arm_state = signals
        error = reference[..., 1] - arm_state[..., 1]
        return -self.weight * (excitation**2).sum(axis=-1) - error**2 - 1e-6 * force.sum(axis=-1)


@dataclass(frozen=True)
class StartAnywhere(Start):
    """A user's start: at a random sample of the reference, with its speed, and with active muscles."""

    def __call__(self, reference, rng):
        step = 0 if rng is None else int(rng.integers(len(reference.t) - 1))
        return StartState(reference.q[step], reference.v[step], np.linspace(0.02, 0.3, 14), step)


def test_a_users_own_senses_reward_and_start(task):
    """The package knows none of them. Both environments compute the same."""
    power = Sense(
        "power",
        reads=("tendon_force", "fiber_velocity"),
        calc=lambda force, velocity: (force * velocity).sum(axis=-1, keepdims=True),
        size=1,
        scale=lambda arm: 1.0 / arm.muscle_table["max_isometric_force"].sum(),
    )
    forces = [sense for sense in SENSES if sense.name in ("tendon_force", "excitation", "preview_q")]
    own = replace(
        task,
        senses=(power, *forces),
        reward=Effort(0.5),
        start=StartAnywhere(),
        lookahead=(0, 5),
    )
    other = replace(own, reward=Effort(0.1))
    steps = len(task.reference.t) - 1 + BEYOND
    for tasks in ([own, own], [own, other, own, other, own]):
        actions = draw_actions("uniform", steps, len(tasks))
        envs = ArmVectorEnv(tasks, len(tasks))
        assert envs.single_observation_space.shape == (1 + 4 + 14 + 14,)
        assert_parity(["own"] * len(tasks), envs, diagrams(tasks), actions, seed=7)


@dataclass(frozen=True)
class WeakFlexors(Randomization):
    """A user's randomization: every muscle has another strength, and some start active."""

    type = "test_weak_flexors"

    def __call__(self, episode, rng):
        start = episode.start._replace(activation=rng.uniform(0.01, 0.3, 14))
        return episode._replace(strength=rng.uniform(0.6, 1.1, 14), start=start)


VARIED = (
    RandomLoad(0.0, 2.0),
    RandomStrength(0.8, 1.2),
    RandomStart(3.0, 0.2),
    RandomMotorNoise(0.2),
    RandomDelay(0.0, 0.06),
    WeakFlexors(),
)


def test_a_library_of_tasks_that_each_reset_draws_from():
    """Every reset draws another movement, load, strength, start, noise and delay. Several episodes are compared."""
    task = replace(scenario_task("reach-000"), senses=OBSERVATIONS["general"], randomization=VARIED)
    other = replace(
        scenario_task("timing-0.4s"), senses=OBSERVATIONS["general"], randomization=VARIED[:4], load_mass=1.0
    )
    short = [replace(each, reference=beginning(each.reference, steps)) for each, steps in ((task, 12), (other, 17))]
    many, arms = ArmVectorEnv(short, 3, redraw=True), 3
    assert_parity(["library"] * arms, many, diagrams([short] * arms), draw_actions("policy", 60, arms), seed=3)


def test_senses_that_are_always_late(task):
    task = replace(task, senses=(*OBSERVATIONS["general"],), senses_delay=0.04)
    assert_parity(["late"] * 2, ArmVectorEnv(task, 2), diagrams([task] * 2), draw_actions("policy", 20, 2), seed=3)


def beginning(reference, steps):
    """The first control steps of a reference."""
    return replace(reference, **{name: getattr(reference, name)[: steps + 1] for name in ("t", "q", "v", "a", "tau")})


@dataclass(frozen=True)
class LittleMetabolism(Reward):
    """A user's reward: minus the metabolic power, and more of it for weak muscles and heavy loads."""

    type = "test_little_metabolism"
    reads = ("metabolic_power", "strength", "load_mass")

    def __call__(self, *signals):
        power, strength, load_mass = signals
        return -(power / strength).sum(axis=-1) * (1.0 + load_mass[..., 0])


def test_senses_and_rewards_can_be_told_the_episode_and_the_metabolic_power(task):
    drawn = (RandomLoad(0.0, 3.0), WeakFlexors(), RandomMotorNoise(0.3))
    told = tuple(Sense(name, scale=lambda arm: 0.1) for name in ("metabolic_power", "strength", "load_mass"))
    own = replace(task, senses=told, reward=LittleMetabolism())
    for tasks in ([own, replace(own, load_mass=1.0)], [replace(own, randomization=drawn)] * 2):
        envs = ArmVectorEnv(tasks, 2)
        assert envs.single_observation_space.shape == (14 + 14 + 1,)
        actions = draw_actions("uniform", len(task.reference.t) - 1 + BEYOND, 2)
        assert_parity(["told"] * 2, envs, diagrams(tasks), actions, seed=7)
