"""ArmVectorEnv: tracking tasks for many arms at once, stepped by one compiled call."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from drakearm.diagrams.muscle_arm import TIME_STEP
from drakearm.errors import ActionError, TrainingError, shown
from drakearm.learning.alike import check_alike, require_tasks
from drakearm.learning.arm_rewards import ArmRewards
from drakearm.learning.compiled_arm import CompiledArms
from drakearm.learning.generator_state import generator_state, restored_generator
from drakearm.learning.past_signals import PastSignals
from drakearm.learning.reset_mask import reset_mask
from drakearm.model.dynamics_table import DynamicsTable
from drakearm.model.loaded_dynamics import LoadedDynamics
from drakearm.model.musculature import metabolic_powers_of_arms, require_state, resting_states, tendon_forces_of_arms
from drakearm.model.reference import CONTROL_STEP, sample_ranges
from drakearm.task import TrackingTask, signal_size
from drakearm.task.episode import LONGEST_STEPS, Episode
from drakearm.task.signals import OF_BODY, RECENT, REMEMBERED


class ArmVectorEnv(VectorEnv):
    """Many environments in one object. Each computes the same as a `DiagramEnv` of its task, up to rounding errors.

    tasks: one task, or several. Muscles, coordinates, joint ranges, senses and lookahead must be the same in all tasks;
    if they are not, a TrainingError names what differs. The tasks are assigned round-robin: arm i has task
    i % len(tasks), with the reference, load, start, reward and randomization of this task. With redraw, each arm draws
    another one of the tasks at every reset, with equal chances.

    Spaces, rewards and info are those of `DiagramEnv`. autoreset_mode: when an environment is reset after the end of
    its episode. With AutoresetMode.SAME_STEP it is reset in the step that ends the episode. This step returns the first
    observation of the next episode. The last observation of the old episode is in `info["final_obs"]`, and the rest of
    info belongs to the last transition. With AutoresetMode.NEXT_STEP, which the vector wrappers of Gymnasium expect,
    it is reset in the next step. This step ignores its action, and its reward is 0. max_episode_steps: episodes are
    truncated after so many control steps, even if the reference goes on. Environment i is seeded with `seed + i`.
    """

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": []}  # noqa: RUF012

    def __init__(
        self,
        tasks: TrackingTask | Sequence[TrackingTask],
        num_envs: int,
        *,
        redraw: bool = False,
        autoreset_mode: AutoresetMode = AutoresetMode.SAME_STEP,
        max_episode_steps: int | None = None,
    ):
        tasks = require_tasks(tasks)
        if autoreset_mode not in (AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP):
            raise TrainingError(f"The autoreset mode is {shown(autoreset_mode)}: expected SAME_STEP or NEXT_STEP.")
        if max_episode_steps is not None and max_episode_steps < 1:
            raise TrainingError(f"max_episode_steps is {shown(max_episode_steps)}: expected at least 1.")
        self.metadata = self.metadata | {"autoreset_mode": autoreset_mode}
        if not tasks or not (redraw or len(tasks) <= num_envs):
            raise TrainingError(
                f"There are {len(tasks)} tasks for {num_envs} arms: expected at least one arm for each task."
            )
        bodies = list(dict.fromkeys(task.arm for task in tasks))
        self._lower, self._upper = check_alike(tasks, bodies)
        arm = tasks[0].arm
        self._arm, self._observation = arm, tasks[0].observation

        self.tasks, self.num_envs, self._redraw = tasks, num_envs, redraw
        self.task_of_arm = np.arange(num_envs) % len(tasks)
        self._body = np.array([bodies.index(task.arm) for task in tasks])
        self._dynamics = LoadedDynamics(bodies)
        self._load_mass = np.array([tasks[k].load_mass for k in self.task_of_arm])
        self._arms = CompiledArms(arm, self.skeletons, num_envs, self._lower, self._upper)
        self._arm_state, self._muscle_state = self._arms.arm_state, self._arms.muscle_state
        self._rewards = ArmRewards([task.reward for task in tasks])
        # The samples of all references, one reference after the other. Task i has rows _first[i] to _last[i].
        self._reference = np.concatenate([task.reference.preview() for task in tasks])
        previews = [task.reference.preview(task.lookahead) for task in tasks]
        halves = np.hsplit(np.concatenate(previews), 2)
        self._preview_q, self._preview_v = (np.ascontiguousarray(half) for half in halves)
        self._first, self._last = sample_ranges(np.array([len(preview) for preview in previews]))
        self._row, self._end = self._first[self.task_of_arm], self._last[self.task_of_arm]
        self._longest = max_episode_steps or len(self._reference)
        self._ended = np.zeros(num_envs, dtype=bool)  # the arms that the next step resets

        n, n_q = len(arm.muscles), len(arm.coordinates)
        self._n, self._n_q = n, n_q
        self._acceleration = np.zeros((num_envs, n_q))
        self._accumulated = np.zeros((num_envs, n_q))
        self._recent = np.zeros((num_envs, RECENT, n))  # excitations, the latest first
        self._strength, self._delay = np.ones((num_envs, n)), np.zeros(num_envs, dtype=int)
        self._motor_noise, self._noise_seed = np.zeros(num_envs), np.zeros(num_envs, dtype=np.int64)
        self._noise_factor = np.ones((num_envs, max(len(task.reference.t) for task in tasks), n))
        self._signals: dict[str, Callable[[], np.ndarray]] = {
            "arm_state": lambda: self._arm_state,
            "arm_acceleration": lambda: self._acceleration,
            "reference": lambda: self._reference.take(self._row, axis=0),
            "tracking_error": lambda: self._reference.take(self._row, axis=0) - self._arm_state,
            "accumulated_error": lambda: self._accumulated,
            "preview_q": lambda: self._preview_q.take(self._row, axis=0),
            "preview_v": lambda: self._preview_v.take(self._row, axis=0),
            "excitation": lambda: self._recent[:, 0],
            "recent_excitation": lambda: self._recent.reshape(num_envs, -1),
            "activation": lambda: self._muscle_state[:, :n],
            "fiber_length": lambda: self._muscle_state[:, n : 2 * n],
            "fiber_velocity": lambda: self._muscle_state[:, 3 * n :],
            "tendon_force": self._tendon_force,
            "metabolic_power": self._metabolic_power,
            "load_mass": lambda: self._load_mass[:, None],
            "strength": lambda: self._strength,
        }
        self._accumulates = "accumulated_error" in (*self._observation.reads, *self._rewards.reads)
        late = any(task.senses_delay > 0.0 or task.randomization for task in tasks)
        sizes = {name: signal_size(name, arm, tasks[0].lookahead) for name in self._observation.reads}
        self._past = PastSignals(
            {name: size for name, size in sizes.items() if name in OF_BODY}, num_envs, LONGEST_STEPS if late else 0
        )
        self._generators = [np.random.default_rng() for _ in range(num_envs)]
        self.single_action_space = Box(0.0, 1.0, (n,), np.float32)
        self.single_observation_space = Box(-np.inf, np.inf, (self._observation.size,), np.float32)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Starts an episode in every environment; see gymnasium.vector.VectorEnv.reset.

        options: may have a `reset_mask` (N,), bool. Then only the environments that it selects start an episode. Raises
        TrainingError for another mask.
        """
        which = reset_mask(options or {}, self.num_envs)
        if seed is not None:
            seeds = range(seed, seed + self.num_envs) if isinstance(seed, int) else seed
            self._generators = [
                np.random.default_rng(env_seed) if resets and env_seed is not None else generator
                for generator, env_seed, resets in zip(self._generators, seeds, which, strict=True)
            ]
        self._restart(which)
        self._ended = self._ended & ~which
        return self._observe(), self._info()

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Advances every environment by a control step. Raises ActionError unless actions are (N, n) finite numbers."""
        values = np.array(actions, dtype=np.float64, order="C")  # a copy, which is kept
        if values.shape != self.action_space.shape or not np.isfinite(values).all():
            raise ActionError(
                f"The actions have the shape {values.shape} and {np.sum(~np.isfinite(values))} values that are not "
                f"finite: expected {self.num_envs} times {self._n} finite excitations."
            )
        noisy = self._noisy(values)
        if self._accumulates:
            error = self._signals["tracking_error"]()[:, : self._n_q]
            self._accumulated = REMEMBERED * self._accumulated + CONTROL_STEP * error
        self._acceleration = self._arms.step(noisy, round(CONTROL_STEP / TIME_STEP), TIME_STEP)
        self._arm_state, self._muscle_state = self._arms.arm_state, self._arms.muscle_state
        self._recent = np.concatenate([values[:, None], self._recent[:, :-1]], axis=1)
        self._row += 1
        resets = self._ended
        if resets.any():
            self._restart(resets)
        self._past.append(self._signals)
        reward = self._rewards(self._signals, self.task_of_arm)
        truncated = self._row == self._end
        info = self._info()
        observation = self._observe()
        if self.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP:
            reward, self._ended = np.where(resets, 0.0, reward), truncated
        elif truncated.any():
            info["final_obs"], info["_final_obs"] = observation, truncated
            self._restart(truncated)
            observation = self._observe()
        return observation, reward, np.zeros_like(truncated), truncated, info

    @property
    def state(self) -> dict[str, np.ndarray]:
        """A copy of all that the next steps depend on, by name. To set it continues all episodes where they were."""
        arrays = {
            "arm_state": self._arm_state,
            "muscle_state": self._muscle_state,
            "acceleration": self._acceleration,
            "accumulated_error": self._accumulated,
            "recent_excitation": self._recent,
            "row": self._row,
            "end": self._end,
            "ended": self._ended,
            "task_of_arm": self.task_of_arm,
            "load_mass": self._load_mass,
            "strength": self._strength,
            "delay": self._delay,
            "motor_noise": self._motor_noise,
            "noise_seed": self._noise_seed,
            **self._past.state,
            "generators": np.array([generator_state(generator) for generator in self._generators]),
        }
        return {name: array.copy() for name, array in arrays.items()}

    @state.setter
    def state(self, arrays: dict[str, np.ndarray]) -> None:
        self._arms.set_state(np.ones(self.num_envs, bool), arrays["arm_state"], arrays["muscle_state"])
        self._arm_state, self._muscle_state = self._arms.arm_state, self._arms.muscle_state
        self._acceleration, self._recent = arrays["acceleration"].copy(), arrays["recent_excitation"].copy()
        self._accumulated = arrays["accumulated_error"].copy()
        self._row, self.task_of_arm = arrays["row"].copy(), arrays["task_of_arm"].copy()
        self._end, self._ended = arrays["end"].copy(), arrays["ended"].copy()
        self._load_mass, self._strength = arrays["load_mass"].copy(), arrays["strength"].copy()
        self._delay = arrays["delay"].copy()
        had_noise = self._motor_noise != 0.0
        self._motor_noise, self._noise_seed = arrays["motor_noise"].copy(), arrays["noise_seed"].copy()
        for k in np.flatnonzero(had_noise | (self._motor_noise != 0.0)).tolist():
            noise = {"motor_noise": float(self._motor_noise[k]), "noise_seed": int(self._noise_seed[k])}
            self._draw_noise(k, self.tasks[self.task_of_arm[k]].episode(None)._replace(**noise))
        self._past.state = arrays
        self._arms.set_body(np.ones(self.num_envs, bool), self.skeletons, self._strength)
        self._generators = [restored_generator(state) for state in arrays["generators"]]

    @property
    def reference_step(self) -> np.ndarray:
        """The control step that each arm has reached on its reference, (N,), from 0."""
        return self._row - self._first[self.task_of_arm]

    @property
    def acceleration(self) -> np.ndarray:
        """Joint accelerations (N, n_q), rad/s^2, due to muscles and stops in the latest time step; 0 at the start."""
        return self._acceleration

    @property
    def skeletons(self) -> DynamicsTable:
        """The equations of motion of all arms with their present loads, stacked, see `stack_dynamics`."""
        return self._dynamics.stacked(self._body[self.task_of_arm], self._load_mass)

    def _restart(self, which: np.ndarray) -> None:
        arms, n_q = np.flatnonzero(which), self._n_q
        arm_state, activation = np.empty((len(arms), 2 * n_q)), np.empty((len(arms), self._n))
        for i, k in enumerate(arms.tolist()):
            if self._redraw:
                self.task_of_arm[k] = self._generators[k].integers(len(self.tasks))
            task = self.task_of_arm[k]
            episode = self.tasks[task].episode(self._generators[k])
            start = episode.start
            arm_state[i, :n_q], arm_state[i, n_q:], activation[i] = start.q, start.v, start.activation
            self._row[k] = self._first[task] + start.step
            self._end[k] = min(self._last[task], self._row[k] + self._longest)
            self._load_mass[k], self._strength[k] = episode.load_mass, episode.strength
            self._delay[k] = episode.delay_steps
            self._draw_noise(k, episode)
        require_state("joint speeds", arm_state[:, n_q:], (len(arms), n_q))
        q = arm_state[:, :n_q].clip(self._lower, self._upper)
        arm_state[:, :n_q] = q
        self._recent[which] = self._acceleration[which] = self._accumulated[which] = 0.0
        skeletons = self._dynamics.stacked(self._body[self.task_of_arm[arms]], self._load_mass[arms])
        self._arms.set_body(which, skeletons, self._strength[arms])
        self._arms.set_state(which, arm_state, resting_states(self._arm, q, activation))
        self._arm_state, self._muscle_state = self._arms.arm_state, self._arms.muscle_state
        self._past.begin(which, self._signals)

    def _draw_noise(self, arm: int, episode: Episode) -> None:
        self._motor_noise[arm], self._noise_seed[arm] = episode.motor_noise, episode.noise_seed
        steps = len(self.tasks[self.task_of_arm[arm]].reference.t)
        self._noise_factor[arm, :steps] = episode.noise_factors(steps, self._n)

    def _observe(self) -> np.ndarray:
        late = self._past.delayed(self._delay)
        present = {name: self._signals[name]() for name in self._observation.reads if name not in late}
        return self._observation(present | late).astype(np.float32)

    def _tendon_force(self) -> np.ndarray:
        fibers = np.ascontiguousarray(self._muscle_state[:, : 2 * self._n])
        force = tendon_forces_of_arms(fibers, self._arm_state, self._arm.muscle_table, self._arm.path_table)
        return self._strength * force

    def _metabolic_power(self) -> np.ndarray:
        n, state = self._n, self._muscle_state
        fibers, velocity = np.ascontiguousarray(state[:, : 2 * n]), np.ascontiguousarray(state[:, 3 * n :])
        excitation, muscles = np.ascontiguousarray(self._noisy(self._recent[:, 0])), self._arm.muscle_table
        return metabolic_powers_of_arms(
            fibers, velocity, excitation, self._arm_state, self._strength, muscles, self._arm.path_table
        )

    def _noisy(self, excitation: np.ndarray) -> np.ndarray:
        """The excitations (N, n) that muscles get: with the motor noise of the present control step."""
        if not self._motor_noise.any():
            return excitation
        return excitation.clip(0.0, 1.0) * self._noise_factor[np.arange(self.num_envs), self.reference_step]

    def _info(self) -> dict[str, Any]:
        info = {
            "arm_state": self._arm_state,
            "tracking_error": (self._arm_state - self._reference.take(self._row, axis=0))[:, : self._n_q],
            "activation": self._muscle_state[:, : self._n],
        }
        everywhere = np.ones(self.num_envs, dtype=bool)
        return info | {f"_{name}": everywhere for name in info}
