"""The errors that a user of drakearm can cause. Each message says what is wrong, where, and what was expected."""

from collections.abc import Iterable
from difflib import get_close_matches


class DrakearmError(Exception):
    """Base of every error that drakearm raises on purpose."""


class ArmError(DrakearmError):
    """An arm folder that cannot be read or does not describe a valid arm."""


class EquilibriumError(DrakearmError):
    """A muscle whose fiber and tendon cannot be in equilibrium, or a posture that the muscles are too weak to hold."""


class DerivativeError(DrakearmError):
    """A quantity that cannot be computed with automatic differentiation, or not in this mode of its system."""


class ScenarioError(DrakearmError):
    """An unknown scenario or a scenario file with a wrong, missing or unknown field."""


class PlanningError(DrakearmError):
    """An optimal-control problem without a solution, or one for which the solver found no solution."""


class TaskError(DrakearmError, ValueError):
    """A task, sense, reward or start that environments cannot use."""


class StateError(DrakearmError, ValueError):
    """A state or excitation of the wrong shape or with values that are not finite."""


class ActionError(DrakearmError, ValueError):
    """An action of the wrong shape or with values that are not finite."""


class TrainingError(DrakearmError):
    """A training that cannot start or that diverged."""


class PolicyFileError(DrakearmError):
    """A policy file that cannot be read, or that was trained for another task."""


class RunFolderError(DrakearmError):
    """A run folder that lacks a file or has a damaged one, or in which a file would have been overwritten."""


class OwnCodeError(DrakearmError):
    """A user's own module or file, given with `--import`, that cannot be found or fails when it is imported."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The text " (did you mean X?)", where X is the most similar known name; empty if none is similar."""
    return "".join(f" (did you mean {close}?)" for close in get_close_matches(name, known, n=1))
