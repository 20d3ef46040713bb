"""What a cost is: a piece that a scenario file lists by its `type`, and that adds itself to a problem."""

from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, InstanceOf, TypeAdapter, ValidationError
from pydrake.solvers import Binding

from drakearm.planning.problem import Problem

NonNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Weight = NonNegative | tuple[NonNegative, ...]  # one for all coordinates, or one for each


class CostPiece:
    """Base of all costs. For one of your own: a frozen dataclass with a `type` that derives from this.

    A scenario file may then list it, once the module that defines it is imported.
    """

    type: ClassVar[str]

    def __init_subclass__(cls) -> None:
        _KINDS[cls.type] = cls

    def add(self, problem: Problem) -> list[Binding]:
        """Adds the cost to a problem and returns what it added, so that its value can be told.

        Integrals over the movement are sums over the knots, each with its share of the time (`problem.shares`), so a
        weight means the same whatever the number of knots.
        """
        raise NotImplementedError


_KINDS: dict[str, type[CostPiece]] = {}


def _read(value: Any) -> Any:
    """The cost that a mapping with its `type` and its fields describes."""
    if not isinstance(value, dict):
        return value
    fields = dict(value)
    kind = fields.pop("type", None)
    if kind not in _KINDS:
        raise ValueError(f"type: found {kind!r}, expected one of {', '.join(sorted(_KINDS))}")
    try:
        return TypeAdapter(_KINDS[kind]).validate_python(fields)
    except ValidationError as error:
        raise ValueError(
            "; ".join(f"{'.'.join(map(str, (kind, *p['loc'])))}: {p['msg']}" for p in error.errors())
        ) from error


Cost = Annotated[InstanceOf[CostPiece], BeforeValidator(_read)]
