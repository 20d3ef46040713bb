"""DiagramEnv: Gymnasium's contract, repeatable seeds, clear errors, and the same arm as in the closed loop."""

from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from pydrake.systems.framework import DiagramBuilder, EventStatus, LeafSystem
from pydrake.systems.primitives import Integrator

from drakearm.diagrams import MakePolicyLoop, MakeTrackingTask
from drakearm.errors import ActionError
from drakearm.experiments import make_task_env
from drakearm.learning import DiagramEnv
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.task import RandomDelay, RandomLoad, RandomMotorNoise, RandomStrength, ReferenceStart


def make(task):
    diagram, systems = MakeTrackingTask(task)
    return DiagramEnv(diagram, systems.Reset, control_step=CONTROL_STEP, episode_steps=len(task.reference.t) - 1)


@pytest.fixture
def env(task):
    return make(task)


@pytest.mark.filterwarnings("ignore:.*Box observation space.*infinity")
def test_gymnasium_accepts_it(env):
    check_env(env, skip_render_check=True)


def test_it_is_registered_with_gymnasium():
    env = gymnasium.make("drakearm/Track-v0", scenario="timing-0.7s")
    observation, info = env.reset(seed=0)
    assert observation.dtype == np.float32
    assert env.observation_space.contains(observation)
    assert set(info) == {"arm_state", "tracking_error", "activation"}


def test_the_specification_says_how_long_episodes_are(task):
    env = gymnasium.make("drakearm/Track-v0", scenario="timing-0.7s", reference=task.reference)
    assert env.spec.max_episode_steps == len(task.reference.t) - 1
    again = gymnasium.make(env.spec)  # the limit that Gymnasium adds then is that of the episode
    again.reset(seed=0)
    truncated = [again.step(np.zeros(14))[3] for _ in range(env.spec.max_episode_steps)]
    assert not any(truncated[:-1]) and truncated[-1]


def test_same_seed_gives_the_same_episode_and_another_seed_another(env):
    def episode(seed):
        rng = np.random.default_rng(1)
        first, _ = env.reset(seed=seed)
        return np.array([first] + [env.step(rng.random(14))[0] for _ in range(5)])

    np.testing.assert_array_equal(episode(3), episode(3))
    assert (episode(3) != episode(4)).any()


def test_time_limit_truncates_and_does_not_terminate(env):
    env.reset(seed=0)
    ends = [env.step(np.zeros(14))[2:4] for _ in range(75)]
    assert not any(terminated for terminated, _ in ends)
    assert [truncated for _, truncated in ends] == [False] * 74 + [True]


@pytest.mark.parametrize("action", [np.full(14, np.nan), np.full(14, np.inf), np.zeros(13), 0.5])
def test_an_unusable_action_is_refused_and_the_episode_continues(env, action):
    env.reset(seed=0)
    env.step(np.zeros(14))
    with pytest.raises(ActionError, match=r"step 1 .*14 finite"):
        env.step(action)
    assert np.isfinite(env.step(np.zeros(14))[0]).all()


def test_actions_are_excitations(env):
    """Only the muscle with excitation 1 becomes active."""
    env.reset(seed=0)
    action = np.zeros(14)
    action[5] = 1.0
    *_, info = env.step(action)
    assert info["activation"][5] > 0.3
    assert (np.delete(info["activation"], 5) < 0.06).all()


def test_environment_and_closed_loop_are_the_same_arm(task):
    """A policy moves the arm of the environment and the arm of the closed-loop Diagram identically, bit for bit."""

    def policy(observation):
        return np.clip(0.1 + 0.3 * np.sin(np.arange(14) + 20.0 * observation[:14]), 0.0, 1.0)

    recording = MakePolicyLoop(task, policy).Run()
    env = make(replace(task, start=ReferenceStart()))
    env.reset(seed=0)
    observation = env._observations.Eval(env._context)  # in double precision, as the closed loop sees it
    for k in range(1, len(recording.t)):
        _, reward, _, _, info = env.step(policy(observation))
        observation = env._observations.Eval(env._context)
        np.testing.assert_array_equal(info["arm_state"][:2], recording.q[k])
        np.testing.assert_array_equal(info["activation"], recording.activation[k])
        assert reward == recording.reward[k]


def test_the_state_is_a_copy_that_restores_all_that_was_drawn(task):
    """Load, strength, delay, motor noise and the reference of an episode come back with it, also in another object."""
    drawn = (RandomLoad(0.0, 5.0), RandomStrength(0.5, 1.5), RandomDelay(0.0, 0.05), RandomMotorNoise(0.5))
    short = Reference(*(getattr(task.reference, name)[:60] for name in ("t", "q", "v", "a", "tau")))
    tasks = [replace(task, randomization=drawn), replace(task, randomization=drawn, reference=short)]
    env, other = make_task_env(tasks), make_task_env(tasks)
    actions = np.random.default_rng(0).random((100, 14))

    def run(env):
        steps = []
        for action in actions:
            observation, reward, _, truncated, _ = env.step(action)
            steps.append(np.append(observation, (reward, truncated)))
            if truncated:
                steps.append(np.append(env.reset()[0], (0.0, 0.0)))
        return np.array(steps)

    for seed in range(3):
        env.reset(seed=seed)
        for action in actions[:20]:
            env.step(action)
        state = env.state
        first = run(env)
        other.reset(seed=77)
        for again in (env, other):
            again.state = state
            np.testing.assert_array_equal(run(again), first)


class _EndsAbove(LeafSystem):
    """Reports the end of an episode when its input exceeds 0.5."""

    def __init__(self):
        super().__init__()
        self._input = self.DeclareVectorInputPort("x", 1)
        self.DeclareVectorOutputPort("reward", 1, self._calc)
        self.DeclarePerStepPublishEvent(self._check)

    def _calc(self, context, output):
        output[0] = self._input.Eval(context)[0]

    def _check(self, context):
        if self._input.Eval(context)[0] > 0.5:
            return EventStatus.ReachedTermination(self, "above")
        return EventStatus.Succeeded()


def test_any_diagram_with_the_ports_works_and_its_termination_is_not_a_truncation():
    builder = DiagramBuilder()
    integrator, judge = builder.AddSystem(Integrator(1)), builder.AddSystem(_EndsAbove())
    builder.Connect(integrator.get_output_port(), judge.GetInputPort("x"))
    builder.ExportInput(integrator.get_input_port(), "actions")
    builder.ExportOutput(integrator.get_output_port(), "observations")
    builder.ExportOutput(judge.GetOutputPort("reward"), "reward")
    env = DiagramEnv(builder.Build(), lambda context, rng: None, control_step=0.1, episode_steps=100)
    env.reset(seed=0)
    steps = [env.step(np.ones(1)) for _ in range(7)]
    assert [terminated for _, _, terminated, _, _ in steps] == [False] * 5 + [True] * 2
    assert not any(truncated for *_, truncated, _ in steps)
