"""What an arm's senses reported in the latest control steps, for many arms with different delays."""

from collections.abc import Callable, Mapping

import numpy as np

_Signals = Mapping[str, Callable[[], np.ndarray]]


class PastSignals:
    """Keeps signals of N arms, each for as many control steps as the longest delay has."""

    def __init__(self, sizes: Mapping[str, int], num_envs: int, longest: int):
        """sizes: of the signals, by name. longest: delay in control steps; with 0, nothing is kept or delayed."""
        self._names = tuple(sizes) if longest else ()
        self._places, self._arms = longest + 1, np.arange(num_envs)
        self._values = {name: np.zeros((self._places, num_envs, sizes[name])) for name in self._names}
        self._now = 0

    def begin(self, which: np.ndarray, signals: _Signals) -> None:
        """Some arms start: their past is what they sense now. which: (N,), bool."""
        for name in self._names:
            self._values[name][:, which] = signals[name]()[which]

    def append(self, signals: _Signals) -> None:
        """A control step has passed."""
        if self._names:
            self._now = (self._now + 1) % self._places
        for name in self._names:
            self._values[name][self._now] = signals[name]()

    def delayed(self, steps: np.ndarray) -> dict[str, np.ndarray]:
        """The signals (N, size) of so many control steps (N,) ago, by name."""
        place = (self._now - steps) % self._places
        return {name: self._values[name][place, self._arms] for name in self._names}

    @property
    def state(self) -> dict[str, np.ndarray]:
        """All values, the latest first."""
        return {f"past_{name}": np.roll(self._values[name][::-1], self._now + 1, axis=0) for name in self._names}

    @state.setter
    def state(self, arrays: Mapping[str, np.ndarray]) -> None:
        self._now = self._places - 1
        for name in self._names:
            self._values[name] = arrays[f"past_{name}"][::-1].copy()
