"""What is wrong in a file that does not fit its schema, as one sentence."""

import typing
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from drakearm.errors import did_you_mean, shown


def describe(error: ValidationError, file: Path, content: Mapping[str, Any], schema: type) -> str:
    """One sentence: the file, then the first of its problems as in `first_problem`."""
    return f"{shown(file)}: {first_problem(error, content, schema)}."


def first_problem(error: ValidationError, content: Mapping[str, Any], schema: type) -> str:
    """Names the field of the first problem, what was found and what was expected, and how many problems there are more.

    content: what was validated. schema: the dataclass that it should be. An element of a list that has a `name` is
    called by it.
    """
    problems = error.errors()
    where, what = _problem(problems[0], content, schema)
    more = len({p["loc"] for p in problems}) - 1
    others = f" (and {more} more problem{'s' * (more > 1)})" if more else ""
    return f"{where}: {what}{others}"


def _problem(problem: Any, content: Any, schema: type) -> tuple[str, str]:
    """Where a problem is, and what was found and expected there."""
    where, value = [], content
    for key in problem["loc"]:
        try:
            value = value[key]
        except (KeyError, IndexError, TypeError):  # a missing field, or pydantic's name of a variant
            value = None
        named = isinstance(key, int) and isinstance(value, dict) and isinstance(value.get("name"), str)
        where.append(value["name"][:40] if named else str(key)[:40])
    found, message = shown(problem["input"]), problem["msg"].removeprefix("Value error, ")
    match problem["type"]:
        case "missing":
            what = "is missing, but required"
        case "unexpected_keyword_argument" | "extra_forbidden":
            known = [name for kind in _kinds_at(schema, problem["loc"][:-1]) for name in _names(kind)]
            what = f"there is no such field{did_you_mean(str(problem['loc'][-1]), known)}"
        case "value_error":
            what = message if message.startswith("found ") else f"found {found}, {message}"
        case _:
            what = f"found {found}, expected {message.removeprefix('Input should be ')}"
    return ".".join(where) or "the file", what


def _names(kind: type) -> list[str]:
    return [field.name for field in fields(kind) if field.init]


def _kinds_at(schema: Any, loc: tuple[int | str, ...]) -> list[type]:
    """The dataclasses that a schema allows at a location."""
    kinds = list(_dataclasses(schema))
    for key in loc:
        if isinstance(key, str):
            hints = [typing.get_type_hints(kind) for kind in kinds]
            kinds = [inner for hint in hints if key in hint for inner in _dataclasses(hint[key])]
    return kinds


def _dataclasses(annotation: Any) -> Iterator[type]:
    """The dataclasses in an annotation such as tuple[Muscle, ...] or Obstacle | None."""
    if is_dataclass(annotation) and isinstance(annotation, type):
        yield annotation
    for argument in typing.get_args(annotation):
        yield from _dataclasses(argument)
