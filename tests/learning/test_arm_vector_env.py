"""ArmVectorEnv: Gymnasium's contract for vector environments, and batches that mix several tasks."""

import re
from dataclasses import replace
from functools import partial

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.wrappers.vector import NormalizeObservation

from drakearm.errors import ActionError, TrainingError
from drakearm.experiments import make_task_env
from drakearm.learning import ArmVectorEnv
from drakearm.model.reference import Reference
from drakearm.task import OBSERVATIONS, RandomMotorNoise, ReferenceStart, RewardWeights, Sense
from drakearm.task.signals import MEMORY
from tests.small_environments import NEXT_STEP, SAME_STEP


def shortened(reference, steps):
    """The first steps of a reference."""
    return Reference(*(getattr(reference, name)[: steps + 1] for name in ("t", "q", "v", "a", "tau")))


def test_an_environment_is_reset_in_the_step_that_ends_its_episode(task):
    envs = ArmVectorEnv(task, 3)
    assert envs.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP
    envs.reset(seed=0)
    for _ in range(74):
        *_, truncated, _ = envs.step(np.full((3, 14), 0.1))
        assert not truncated.any()
    observation, _, terminated, truncated, info = envs.step(np.full((3, 14), 0.1))
    assert truncated.all() and not terminated.any()
    assert np.abs(info["final_obs"] - observation).max() > 0.5  # the end of one episode, the start of the next
    assert np.abs(info["tracking_error"]).max() > 0.3  # of the transition, not of the new start
    np.testing.assert_allclose(observation[:, 28:42], 0.05)  # resting activations


def test_the_episode_of_an_arm_ends_with_its_own_reference(task):
    """Arms 0, 2, 4 follow 75 steps, arms 1 and 3 follow 30: each is reset when its own reference ends."""
    envs = ArmVectorEnv([task, replace(task, reference=shortened(task.reference, 30))], 5)
    envs.reset(seed=0)
    ends = []
    for k in range(1, 151):
        observation, _, _, truncated, info = envs.step(np.full((5, 14), 0.1))
        ends += [(k, int(arm)) for arm in np.flatnonzero(truncated)]
        assert ("final_obs" in info) == truncated.any()
        if truncated.any():
            np.testing.assert_array_equal(info["_final_obs"], truncated)
            np.testing.assert_allclose(observation[truncated, 28:42], 0.05)  # resting activations
            assert (np.abs(observation[~truncated, 28:42] - 0.05) > 0.04).all()  # the others go on
    expected = [(k, arm) for k, arms in ((30, (1, 3)), (60, (1, 3)), (75, (0, 2, 4)), (90, (1, 3))) for arm in arms]
    assert ends == [*expected, (120, 1), (120, 3), *((150, arm) for arm in range(5))]


def test_an_arm_is_independent_of_the_others(task):
    """In a mixed batch it has the same states, observations and rewards as in a batch with only its task."""
    other = replace(
        task,
        reference=shortened(task.reference, 40),
        load_mass=5.0,
        start=ReferenceStart(noise=0.2),
        reward=RewardWeights(position=(1.0, 2.0), velocity=(0.0, 0.3), acceleration=(1e-5, 0.0)),
    )
    actions = np.random.default_rng(0).random((50, 4, 14))
    mixed = ArmVectorEnv([task, other], 4)
    first, _ = mixed.reset(seed=[1, 2, 3, 4])
    mixed_steps = [mixed.step(action) for action in actions]
    for k, alone in enumerate([ArmVectorEnv(task, 2), ArmVectorEnv(other, 2)]):
        np.testing.assert_array_equal(alone.reset(seed=[1 + k, 3 + k])[0], first[k::2])
        for action, (observation, reward, _, truncated, info) in zip(actions, mixed_steps, strict=True):
            expected = alone.step(action[k::2])
            np.testing.assert_allclose(info["arm_state"][k::2], expected[4]["arm_state"], rtol=1e-8, atol=1e-8)
            np.testing.assert_allclose(reward[k::2], expected[1], rtol=1e-8, atol=1e-8)
            np.testing.assert_allclose(observation[k::2], expected[0], rtol=1e-6, atol=1e-7)
            np.testing.assert_array_equal(truncated[k::2], expected[3])


def test_the_accumulated_error_is_the_integral_that_is_forgotten(task):
    """It adds up the errors of all earlier control steps. A memory of 0.25 s keeps 1/e of an error for so long."""
    envs = ArmVectorEnv(replace(task, senses=(Sense("accumulated_error"),)), 2)
    observation, info = envs.reset(seed=0)
    errors = []
    for _ in range(40):
        np.testing.assert_allclose(observation, expected_integral(errors), rtol=1e-6, atol=1e-9)
        errors.append(-info["tracking_error"])
        observation, _, _, _, info = envs.step(np.full((2, 14), 0.2))
    assert (np.abs(observation) > 1e-3).any()


def expected_integral(errors):
    """The sum of errors times 10 ms; one that is MEMORY old counts exp(-1) times as much as a new one."""
    age = 0.01 * np.arange(len(errors))[::-1]
    return np.einsum("k,kij->ij", 0.01 * np.exp(-age / MEMORY), errors) if errors else np.zeros((2, 2))


def test_tasks_for_different_arms_are_refused(task):
    first, *others = task.arm.muscles
    weaker = replace(task.arm, muscles=(replace(first, max_isometric_force=10.0), *others))
    with pytest.raises(TrainingError, match="Task 1 differs from task 0 in its muscles: expected the same"):
        ArmVectorEnv([task, replace(task, arm=weaker)], 2)
    with pytest.raises(TrainingError, match="Task 2 differs from task 0 in its senses"):
        ArmVectorEnv([task, task, replace(task, senses=OBSERVATIONS["paper"])], 4)


def test_joints_with_other_ranges_are_refused(task, tmp_path):
    skeleton = tmp_path / "skeleton.urdf"
    skeleton.write_text(re.sub(r'upper="[^"]*"', 'upper="1.0"', task.arm.skeleton.read_text()))
    stiff = replace(task, arm=replace(task.arm, skeleton=skeleton))
    with pytest.raises(TrainingError, match="Task 1 differs from task 0 in its joint ranges"):
        ArmVectorEnv([task, stiff], 2)


@pytest.mark.parametrize(("tasks", "arms"), [(0, 4), (3, 2)])
def test_every_task_needs_an_arm(task, tasks, arms):
    with pytest.raises(TrainingError, match=f"{tasks} tasks for {arms} arms"):
        ArmVectorEnv([task] * tasks, arms)


def test_seeds_repeat_and_differ_between_environments(task):
    envs = ArmVectorEnv(task, 2)
    first, _ = envs.reset(seed=7)
    again, _ = envs.reset(seed=7)
    np.testing.assert_array_equal(first, again)
    assert (first[0] != first[1]).any()


@pytest.mark.parametrize("actions", [np.full((2, 14), np.nan), np.zeros((3, 14)), np.zeros(14)])
def test_unusable_actions_are_refused(task, actions):
    envs = ArmVectorEnv(task, 2)
    envs.reset(seed=0)
    with pytest.raises(ActionError, match="2 times 14 finite"):
        envs.step(actions)


def test_the_state_is_a_copy_that_restores(task):
    task = replace(task, senses_delay=0.02, randomization=(RandomMotorNoise(0.2),))
    quiet = replace(task, load_mass=1.0, randomization=())
    envs = ArmVectorEnv([task, quiet], 4, redraw=True)
    envs.reset(seed=0)
    actions = np.random.default_rng(0).random((100, 4, 14))
    for action in actions[:20]:
        envs.step(action)
    state = envs.state
    first = [envs.step(action)[:2] for action in actions]
    envs.state = state
    for action, expected in zip(actions, first, strict=True):
        for ours, theirs in zip(envs.step(action)[:2], expected, strict=True):
            np.testing.assert_array_equal(ours, theirs)


def test_next_step_resets_one_step_later(task):
    """The transitions are those of SAME_STEP, with a step in between that only resets."""
    tasks = [task, replace(task, reference=shortened(task.reference, 30))]
    same, later = (ArmVectorEnv(tasks, 2, autoreset_mode=mode) for mode in (SAME_STEP, NEXT_STEP))
    assert later.metadata["autoreset_mode"] == NEXT_STEP
    np.testing.assert_array_equal(same.reset(seed=0)[0], later.reset(seed=0)[0])
    action = np.full((2, 14), 0.1)
    for _ in range(30):
        observation, *_, truncated, info = same.step(action)
        kept, reward, _, ended, _ = later.step(action)
    np.testing.assert_array_equal(truncated, [False, True])
    np.testing.assert_array_equal(ended, truncated)
    np.testing.assert_array_equal(kept, info["final_obs"])
    started, reward, _, ended, _ = later.step(action)
    assert reward[1] == 0.0 and reward[0] < 0.0 and not ended.any()
    np.testing.assert_array_equal(started[1], observation[1])
    np.testing.assert_array_equal(started[0], same.step(action)[0][0])
    for _ in range(29):
        same.step(action)
    later_steps = [later.step(action) for _ in range(30)]
    assert [list(step[3]) for step in later_steps[-2:]] == [[False, False], [False, True]]


@pytest.mark.parametrize("mode", [SAME_STEP, NEXT_STEP])
def test_gymnasium_s_own_vector_environment_resets_alike(task, mode):
    task = replace(task, reference=shortened(task.reference, 12))
    ones = SyncVectorEnv([partial(make_task_env, task)] * 2, autoreset_mode=mode)
    many = ArmVectorEnv(task, 2, autoreset_mode=mode)
    np.testing.assert_allclose(many.reset(seed=3)[0], ones.reset(seed=3)[0], rtol=1e-6, atol=1e-7)
    for action in np.random.default_rng(0).random((30, 2, 14)):
        for ours, theirs in zip(many.step(action)[:4], ones.step(action)[:4], strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-7)


def test_gymnasium_s_vector_wrappers_work_with_next_step():
    envs = gymnasium.make_vec("drakearm/Track-v0", num_envs=2, scenario="timing-0.7s", autoreset_mode=NEXT_STEP)
    normalized = NormalizeObservation(envs)
    normalized.reset(seed=0)
    assert np.isfinite(normalized.step(np.zeros((2, 14)))[0]).all()


def test_episodes_end_after_max_episode_steps():
    envs = gymnasium.make_vec("drakearm/Track-v0", num_envs=2, scenario="timing-0.7s", max_episode_steps=20)
    envs.reset(seed=0)
    ends = [envs.step(np.zeros((2, 14)))[3].all() for _ in range(40)]
    assert np.flatnonzero(ends).tolist() == [19, 39]


@pytest.mark.parametrize("mode", [SAME_STEP, NEXT_STEP])
def test_a_mask_selects_the_arms_that_start(task, mode):
    task = replace(task, reference=shortened(task.reference, 10))
    envs = ArmVectorEnv(task, 3, autoreset_mode=mode)
    first, _ = envs.reset(seed=0)
    for _ in range(10):
        before, *_ = envs.step(np.full((3, 14), 0.3))
    mask = np.array([False, True, True])
    observation, _ = envs.reset(seed=0, options={"reset_mask": mask})
    np.testing.assert_array_equal(observation[mask], first[mask])
    np.testing.assert_array_equal(observation[~mask], before[~mask])
    ended = [envs.step(np.full((3, 14), 0.3))[3] for _ in range(11)]
    np.testing.assert_array_equal(ended[9], [mode is SAME_STEP, True, True])
    for bad in (np.zeros(3, bool), np.ones(2, bool), [True] * 3, np.ones(3)):
        with pytest.raises(TrainingError, match=r"reset_mask is .*: expected an array \(3,\) of bool"):
            envs.reset(options={"reset_mask": bad})


def test_other_things_than_tasks_are_refused(task):
    with pytest.raises(TrainingError, match="Found the task 'reach-000': expected a TrackingTask"):
        ArmVectorEnv("reach-000", 4)
    with pytest.raises(TrainingError, match="Found the task 3: expected a TrackingTask"):
        ArmVectorEnv([task, 3], 4)
    with pytest.raises(TrainingError, match="expected SAME_STEP or NEXT_STEP"):
        ArmVectorEnv(task, 4, autoreset_mode=AutoresetMode.DISABLED)
    with pytest.raises(TrainingError, match="expected at least 1"):
        ArmVectorEnv(task, 4, max_episode_steps=0)


@pytest.mark.slow
@pytest.mark.parametrize("load", [0.0, 20.0])
def test_random_episodes_stay_finite(task, load):
    """1000 episodes of 75 random actions, from noisy starts: no NaN, no exception."""
    envs = ArmVectorEnv(replace(task, load_mass=load, start=ReferenceStart(noise=0.2)), 500)
    rng = np.random.default_rng(0)
    envs.reset(seed=0)
    for _ in range(2 * 75):
        observation, reward, *_, info = envs.step(rng.random((500, 14)))
        assert np.isfinite(observation).all() and np.isfinite(reward).all()
        assert np.abs(info["arm_state"]).max() < 100.0
