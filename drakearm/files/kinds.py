"""Families of dataclasses from which a file chooses by `type`, as a scenario file chooses its costs."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, ClassVar, Self

from pydantic import TypeAdapter, ValidationError

from drakearm.errors import shown
from drakearm.files.problems import first_problem


class Kind:
    """Base of all families. A class that derives directly from it begins a family. What derives from that is a kind:

        class Shape(Kind):
            def area(self) -> float: ...

        @dataclass(frozen=True)
        class Circle(Shape):
            type = "circle"
            radius: float

        Shape.read({"type": "circle", "radius": 2.0})  # Circle(radius=2.0)

    A file can name a kind as soon as the module that defines it is imported. `type = ""` is for a kind that only code
    can use. To define a kind without a `type` of its own, or with the `type` of another kind of the family, is a
    TypeError.
    """

    type: ClassVar[str]
    _kinds: ClassVar[dict[str, Any]]  # of a family: its dataclasses by type

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if Kind in cls.__bases__:
            cls._kinds = {}
            return
        name = vars(cls).get("type")
        if name == "":
            return
        if not isinstance(name, str):
            raise TypeError(f"{_path(cls)}: expected a `type`, the name that files give it.")
        other = cls._kinds.get(name, cls)
        if _path(other) != _path(cls):  # a notebook may define the same class again
            raise TypeError(f"{_path(cls)} has the type {name!r} of {_path(other)}: expected a type of its own.")
        cls._kinds[name] = cls

    @classmethod
    def read(cls, value: Any) -> Self:
        """The dataclass that a mapping with its `type` and fields describes. One of the family is returned unchanged.

        Raises ValueError: an unknown type with a list of those that are known, a wrong field with its type and name.
        """
        if isinstance(value, cls):
            return value
        known = ", ".join(sorted(cls._kinds))
        if not isinstance(value, Mapping):
            raise ValueError(f"found {shown(value)}, expected a mapping with a type, one of {known}")
        given = dict(value)
        name = given.pop("type", None)
        if not isinstance(name, str) or name not in cls._kinds:
            raise ValueError(f"type: found {shown(name)}, expected one of {known}")
        own = [field.name for field in fields(cls._kinds[name]) if field.init]
        for field in given:
            if field not in own:
                raise ValueError(f"{name}.{str(field)[:40]}: expected one of the fields {', '.join(own)}")
        try:
            return TypeAdapter(cls._kinds[name]).validate_python(given)
        except ValidationError as error:
            raise ValueError(f"{name}.{first_problem(error, given, cls._kinds[name])}") from error


def _path(kind: Any) -> str:
    return f"{kind.__module__}.{kind.__qualname__}"
