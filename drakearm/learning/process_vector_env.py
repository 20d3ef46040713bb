"""ProcessVectorEnv: environments in as many processes as there are cores."""

import multiprocessing
import os
import signal
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import pairwise
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from drakearm.errors import ActionError, TrainingError


class ProcessVectorEnv(VectorEnv):
    """Many environments in a few processes. Each process steps its share of them, one after the other.

    Gymnasium's AsyncVectorEnv has a process for each environment. With more environments than cores, it spends much of
    the time on changes between processes. What this class returns is what AsyncVectorEnv returns with
    AutoresetMode.SAME_STEP, and does not depend on the number of processes: environment i is seeded with `seed + i`.

    make_envs: functions that make the environments, one for each, with spaces of type Box. They are called in forked
    processes, so they need not be picklable. processes: how many; as many as the cores that this process may use if
    None, and at most one for each environment.

    If an environment raises an error, the same error is raised here, with a note that says where it came from. If a
    process ends too early, a TrainingError is raised. Both end all processes.
    """

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": []}  # noqa: RUF012

    def __init__(self, make_envs: Sequence[Callable[[], gymnasium.Env]], processes: int | None = None):
        self._pipes: list[Connection] = []
        self._processes: list[BaseProcess] = []
        first = make_envs[0]()
        self.num_envs = len(make_envs)
        self.single_action_space, self.single_observation_space = first.action_space, first.observation_space
        self.action_space = batch_space(first.action_space, self.num_envs)
        self.observation_space = batch_space(first.observation_space, self.num_envs)
        first.reset()
        first.step(first.action_space.sample())  # so what it compiles is compiled once, before the processes fork
        first.close()

        count = min(processes or len(os.sched_getaffinity(0)), self.num_envs)
        bounds = [self.num_envs * i // count for i in range(count + 1)]
        self._shares = [slice(*pair) for pair in pairwise(bounds)]
        fork = multiprocessing.get_context("fork")
        for share in self._shares:
            pipe, its_pipe = fork.Pipe()
            self._pipes.append(pipe)
            arguments = (make_envs[share], its_pipe, list(self._pipes))
            self._processes.append(fork.Process(target=_serve, args=arguments, daemon=True))
            self._processes[-1].start()
            its_pipe.close()

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Starts an episode in every environment; see gymnasium.vector.VectorEnv.reset."""
        if seed is None or isinstance(seed, int):
            seed = [None if seed is None else seed + i for i in range(self.num_envs)]
        results = self._ask(_reset, [(env_seed, options) for env_seed in seed])
        observation, infos = zip(*results, strict=True)
        return np.stack(observation), self._gathered(infos)

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Steps every environment. Raises ActionError unless there is one action for each."""
        if len(actions) != self.num_envs:
            raise ActionError(f"There are {len(actions)} actions: expected {self.num_envs}, one for each environment.")
        results = self._ask(_step, actions)
        observation, reward, terminated, truncated, infos = zip(*results, strict=True)
        ends = np.array(terminated, dtype=bool), np.array(truncated, dtype=bool)
        return np.stack(observation), np.array(reward, dtype=np.float64), *ends, self._gathered(infos)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """The attribute of this name of every environment."""
        return tuple(self._ask(_get, [name] * self.num_envs))

    def set_attr(self, name: str, values: Sequence[Any]) -> None:
        """Sets the attribute of this name of every environment, each to its own value."""
        self._ask(_set, [(name, value) for value in values])

    def close_extras(self, **kwargs: Any) -> None:
        """Ends all processes at once."""
        for pipe in self._pipes:
            pipe.close()
        for process in self._processes:
            process.kill()
            process.join()

    def _ask(self, function: Callable[[gymnasium.Env, Any], Any], arguments: Sequence[Any] | np.ndarray) -> list[Any]:
        """What `function` returns for every environment and its argument."""
        if self.closed:
            raise TrainingError("The processes of these environments have ended: expected environments that are open.")
        try:
            for pipe, share in zip(self._pipes, self._shares, strict=True):
                with suppress(ConnectionError):  # of a process that has ended: _answer reports it
                    pipe.send((function, arguments[share]))
            answers = [_answer(*both) for both in zip(self._processes, self._pipes, strict=True)]
        except BaseException:  # also of Ctrl-C: the answers that are still to come would be those to a later question
            self.close()
            raise
        return [result for answer in answers for result in answer]

    def _gathered(self, infos: Sequence[dict[str, Any]]) -> dict[str, Any]:
        gathered: dict[str, Any] = {}
        for i, info in enumerate(infos):
            gathered = self._add_info(gathered, info, i)
        return gathered


def _answer(process: BaseProcess, pipe: Connection) -> list[Any]:
    try:
        answer = pipe.recv()
    except (EOFError, ConnectionError) as error:
        process.join()
        raise TrainingError(
            f"A process that steps environments ended with exit code {process.exitcode}: "
            "expected it to work until the training ends. Perhaps there was too little memory."
        ) from error
    if isinstance(answer, Exception):
        raise answer
    return answer


def _serve(
    make_envs: Sequence[Callable[[], gymnasium.Env]], pipe: Connection, ends_of_parent: list[Connection]
) -> None:
    """What a process does: it answers pairs of a function and arguments, one for each environment, or with an error."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches all processes, and the parent ends this one
    for end in ends_of_parent:  # forking copied them: as long as one is open, recv would wait for a parent that is gone
        end.close()
    envs: list[gymnasium.Env] = []
    with suppress(EOFError, ConnectionError):
        while True:
            function, arguments = pipe.recv()
            try:
                envs = envs or [make() for make in make_envs]
                answer: Any = [function(*pair) for pair in zip(envs, arguments, strict=True)]
            except Exception as error:
                error.add_note(f"This is where it was raised, in a process of its own:\n{traceback.format_exc()}")
                answer = error
            pipe.send(answer)


def _reset(env: gymnasium.Env, argument: tuple[int | None, dict[str, Any] | None]) -> tuple[Any, dict[str, Any]]:
    seed, options = argument
    return env.reset(seed=seed, options=options)


def _step(env: gymnasium.Env, action: np.ndarray) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
    observation, reward, terminated, truncated, info = env.step(action)
    if terminated or truncated:
        info = {"final_obs": observation, "final_info": info}
        observation, first_info = env.reset()
        info |= first_info
    return observation, reward, terminated, truncated, info


def _get(env: gymnasium.Env, name: str) -> Any:
    return env.get_wrapper_attr(name)


def _set(env: gymnasium.Env, argument: tuple[str, Any]) -> None:
    env.set_wrapper_attr(*argument)
