"""DiagramEnv: a Gymnasium environment around a Drake Diagram."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec
from pydrake.systems.analysis import InitializeParams, SimulatorStatus
from pydrake.systems.framework import Context, Diagram

from drakearm.diagrams import MakeSimulator
from drakearm.errors import ActionError, TrainingError, shown
from drakearm.learning.context_state import context_arrays, set_context_arrays
from drakearm.learning.generator_state import generator_state, restored_generator

Reset = Callable[[Context, np.random.Generator], object]
Info = dict[str, Any]


class DiagramEnv(gymnasium.Env[np.ndarray, np.ndarray]):
    """Steps a Diagram that has the ports of pydrake.gym: input `actions`, outputs `observations` and `reward` (1,).

    ============ ================================== ===========================================================
    space        shape                              range and unit
    ============ ================================== ===========================================================
    action       (size of the port `actions`,)      float32, 0 to 1: excitations
    observation  (size of the port `observations`,) float32, unbounded: see `drakearm.task.SENSES`
    ============ ================================== ===========================================================

    The values of all other output ports are in `info`, as float64 arrays under the names of the ports. An action is
    held for one control step; observation, reward and info are those at the end of the step. An episode is truncated
    when the simulated time reaches `episode_steps` control steps: a number, or a function of the root context. It is
    terminated when a system of the Diagram reports EventStatus::ReachedTermination. max_episode_steps: of the longest
    episode, for `spec.max_episode_steps`, if episode_steps is a function.

    reset: a function that sets the start state in a root context. It draws random numbers only from the generator that
    it is given, so that the seed given to the method `reset` determines the episode. It may also set the time to a
    whole number of control steps; the episode is then shorter. The Diagram is built once and only its context is reset,
    because every new Diagram leaks memory. render: makes the picture (height, width, 3), uint8, of an info, for the
    render mode "rgb_array". With the render mode "human" the Diagram draws itself, and the simulation keeps real time.
    """

    metadata = {"render_modes": ["human", "rgb_array"], "render_fps": 100}  # noqa: RUF012 (Gymnasium's own declaration)

    def __init__(
        self,
        diagram: Diagram,
        reset: Reset,
        *,
        control_step: float,
        episode_steps: int | Callable[[Context], int],
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
        render: Callable[[Info], np.ndarray] | None = None,
    ):
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise TrainingError(
                f"The render mode is {shown(render_mode)}: expected one of {', '.join(self.metadata['render_modes'])}."
            )
        self.render_mode, self._render = render_mode, render
        self._diagram = diagram
        self._reset = reset
        self._control_step = control_step
        self._episode_steps = episode_steps
        self._max_episode_steps = episode_steps if isinstance(episode_steps, int) else max_episode_steps
        self._spec: EnvSpec | None = None
        self._simulator = MakeSimulator(diagram)
        if render_mode == "human":
            self._simulator.set_target_realtime_rate(1.0)
        self._context = self._simulator.get_mutable_context()
        self._actions = diagram.GetInputPort("actions")
        self._observations = diagram.GetOutputPort("observations")
        self._reward = diagram.GetOutputPort("reward")
        outputs = [diagram.get_output_port(i) for i in range(diagram.num_output_ports())]
        self._info = {port.get_name(): port for port in outputs}
        del self._info["observations"], self._info["reward"]
        self._steps = 0
        self.action_space = gymnasium.spaces.Box(0.0, 1.0, (self._actions.size(),), np.float32)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (self._observations.size(),), np.float32)

    @property
    def spec(self) -> EnvSpec | None:  # type: ignore[override]
        """What `gymnasium.make` made this environment from, with the length of its episodes as `max_episode_steps`."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        if spec is not None and spec.max_episode_steps is None:
            spec = replace(spec, max_episode_steps=self._max_episode_steps)
        self._spec = spec

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Starts an episode; see gymnasium.Env.reset. There are no options."""
        super().reset(seed=seed)
        self._context.SetTime(0.0)
        self._diagram.SetDefaultContext(self._context)
        self._actions.FixValue(self._context, np.zeros(self._actions.size()))
        self._reset(self._context, self.np_random)
        self._steps = round(self._context.get_time() / self._control_step)  # counted from time 0, not from the start
        self._simulator.Initialize()
        return self._observe()

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Holds the action for one control step. Raises ActionError unless it is (n,) finite numbers."""
        values = np.asarray(action, dtype=np.float64)
        if values.shape != self.action_space.shape or not np.isfinite(values).all():
            raise ActionError(
                f"The action of step {self._steps} is {np.array2string(values, threshold=20)}: "
                f"expected {self._actions.size()} finite excitations."
            )
        self._steps += 1
        self._actions.FixValue(self._context, values)
        status = self._simulator.AdvanceTo(self._steps * self._control_step)
        terminated = status.reason() == SimulatorStatus.ReturnReason.kReachedTerminationCondition
        observation, info = self._observe()
        reward = float(self._reward.Eval(self._context)[0])
        return observation, reward, terminated, self._steps >= self._length(), info

    def render(self) -> np.ndarray | None:  # type: ignore[override]
        """The picture of the present state with the render mode "rgb_array", else None; see gymnasium.Env.render."""
        if self.render_mode != "rgb_array" or self._render is None:
            return None
        return self._render({name: port.Eval(self._context) for name, port in self._info.items()})

    def _length(self) -> int:
        """Of an episode, in control steps from time 0."""
        return self._episode_steps(self._context) if callable(self._episode_steps) else self._episode_steps

    @property
    def state(self) -> dict[str, np.ndarray]:
        """A copy of all that the next steps depend on, by name. To set it continues the episode where it was.

        It holds the state and the parameters of the Diagram: see `context_arrays`.
        """
        return context_arrays(self._context) | {
            "action": self._actions.Eval(self._context).copy(),
            "steps": np.array(self._steps),
            "generator": generator_state(self.np_random),
        }

    @state.setter
    def state(self, arrays: dict[str, np.ndarray]) -> None:
        self._steps = int(arrays["steps"].item())
        self._context.SetTime(self._steps * self._control_step)
        self._actions.FixValue(self._context, arrays["action"])
        set_context_arrays(self._context, arrays)
        self.np_random = restored_generator(arrays["generator"])
        self._simulator.Initialize(InitializeParams(suppress_initialization_events=True))

    def _observe(self) -> tuple[np.ndarray, dict[str, Any]]:
        observation = self._observations.Eval(self._context).astype(np.float32)
        return observation, {name: port.Eval(self._context) for name, port in self._info.items()}
