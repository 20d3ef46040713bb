"""The rows of an experiment's table, and the values in them."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drakearm.reproduction.trial import Method


class Value(ABC):
    """What one method reached: text for people, and the same numbers as JSON."""

    @abstractmethod
    def __str__(self) -> str: ...

    @property
    @abstractmethod
    def content(self) -> dict[str, Any]: ...


@dataclass(frozen=True)
class Spread(Value):
    """A quantity that was measured in several runs of each of several seeds."""

    seeds: Sequence[Sequence[float]]  # for each seed the value of each run
    digits: int = 3  # behind the decimal point

    @property
    def mean(self) -> float:
        return float(np.mean(self._all))

    @property
    def standard_deviation(self) -> float:
        """Over all runs of all seeds."""
        return float(np.std(self._all))

    @property
    def between_seeds(self) -> float:
        """The standard deviation of the seeds' means."""
        return float(np.std([np.mean(runs) for runs in self.seeds]))

    @property
    def _all(self) -> np.ndarray:
        return np.concatenate([np.asarray(runs, float) for runs in self.seeds])

    def __str__(self) -> str:
        text = f"{self.mean:.{self.digits}f}"
        if len(self._all) > 1:
            text += f" ± {self.standard_deviation:.{self.digits}f}"
        if len(self.seeds) > 1 and len(self._all) > len(self.seeds):
            text += f" (seeds ± {self.between_seeds:.{self.digits}f})"
        return text

    @property
    def content(self) -> dict[str, Any]:
        return {
            "mean": self.mean,
            "standard_deviation": self.standard_deviation,
            "between_seeds": self.between_seeds,
            "minimum": float(self._all.min()),
            "maximum": float(self._all.max()),
            "runs": len(self._all),
            "seeds": len(self.seeds),
        }


@dataclass(frozen=True)
class Share(Value):
    """How many of several runs have a property."""

    seeds: Sequence[Sequence[bool]]  # for each seed whether each run has it

    @property
    def having(self) -> int:
        return sum(map(sum, self.seeds))

    @property
    def runs(self) -> int:
        return sum(map(len, self.seeds))

    def __str__(self) -> str:
        return f"{self.having} of {self.runs} ({self.having / self.runs:.0%})"

    @property
    def content(self) -> dict[str, Any]:
        return {"having": self.having, "runs": self.runs, "seeds": len(self.seeds)}


@dataclass(frozen=True)
class Row:
    """One quantity, as the paper reports it and as each method reached it."""

    quantity: str  # with its unit
    values: Mapping[Method, Value]  # of the methods that were measured
    paper: str = ""  # what the paper reports, if it does
    note: str = ""  # what to compare the values with, or how they were measured
    group: str = ""  # heading of consecutive rows that belong together
