"""What is wrong in a file that does not fit its schema, each problem as one sentence."""

import re
import typing
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from drakearm.errors import DrakearmError, did_you_mean, shown

E = TypeVar("E", bound=DrakearmError)
_MOST_NOTES = 10  # of an error: what fits on a screen


def file_error(kind: type[E], error: ValidationError, file: Path, content: Mapping[str, Any], schema: type) -> E:
    """An error of a kind of ours: the file, then its first problem as in `first_problem`. Its notes are the other ones.

    Python shows notes below the message of an error (PEP 678), and so does the command line.
    """
    found = kind(f"{shown(file)}: {first_problem(error, content, schema)}.")
    others = list(_problems(error, content, schema))[1:]
    for problem in others[:_MOST_NOTES]:
        found.add_note(f"{problem}.")
    if len(others) > _MOST_NOTES:
        found.add_note(f"and {len(others) - _MOST_NOTES} more.")
    return found


def first_problem(error: ValidationError, content: Mapping[str, Any], schema: type) -> str:
    """Names the field of the first problem, what was found and what was expected, and how many problems there are more.

    content: what was validated. schema: the dataclass that it should be. An element of a list that has a `name` is
    called by it.
    """
    first, *others = _problems(error, content, schema)
    more = len(others)
    return f"{first} (and {more} more problem{'s' * (more > 1)})" if more else first


def _problems(error: ValidationError, content: Mapping[str, Any], schema: type) -> Iterator[str]:
    """Every problem, as a part of a sentence."""
    problems: dict[tuple[int | str, ...], list[Any]] = {}  # by the place in the content
    for problem in error.errors(include_url=False):
        problems.setdefault(_place(problem, content), []).append(problem)
    for place in _consequences(problems):
        del problems[place]
    for place, here in problems.items():
        yield _sentence(place, here, content, schema)


def _consequences(problems: Mapping[tuple[int | str, ...], list[Any]]) -> list[tuple[int | str, ...]]:
    """The places of fields that are missing because their names are misspelled: these are named by another problem."""
    unknown = [place for place, here in problems.items() if here[0]["type"] in _UNKNOWN]
    missing = [place for place, here in problems.items() if here[0]["type"] == "missing"]
    return [
        place
        for place in missing
        if any(other[:-1] == place[:-1] and did_you_mean(str(other[-1]), [str(place[-1])]) for other in unknown)
    ]


def _place(problem: Any, content: Any) -> tuple[int | str, ...]:
    """Where a problem is, without what pydantic adds to it: where a field has a choice of types, the name of a type."""
    place = []
    for key in problem["loc"]:
        try:
            content = content[key]
        except (KeyError, IndexError, TypeError):  # a missing field, or the name of a type
            continue
        place.append(key)
    return (*place, problem["loc"][-1]) if problem["type"] == "missing" else tuple(place)


def _sentence(place: tuple[int | str, ...], here: list[Any], content: Any, schema: type) -> str:
    """Where a problem is, and what was found and expected there. here: one problem, or one for each possible type."""
    where = ".".join(_called(place, content))
    problem = here[0]
    message = problem["msg"].removeprefix("Value error, ")
    match problem["type"]:
        case "missing":
            return f"{where}: is missing, but required"
        case kind if kind in _UNKNOWN:
            known = [name for kind in _kinds_at(schema, place[:-1]) for name in _names(kind)]
            return f"{where}: there is no such field{did_you_mean(str(problem['loc'][-1]), known)}"
        case "value_error" if message.startswith("found "):
            return f"{where or 'the file'}: {message}"
        case "value_error" if _FIELD.match(message):  # a field below this one
            return f"{where}.{message}".removeprefix(".")
        case "value_error" if ": expected " in message:
            return f"{where or 'the file'}: {message}"
    expected = " or ".join(dict.fromkeys(_expected(problem) for problem in here))
    return f"{where or 'the file'}: found {shown(problem['input'])}, expected {expected}"


def _called(place: tuple[int | str, ...], content: Any) -> Iterator[str]:
    for key in place:
        try:
            content = content[key]
        except (KeyError, IndexError):
            content = None
        named = isinstance(key, int) and isinstance(content, dict) and isinstance(content.get("name"), str)
        yield content["name"][:40] if named else str(key)[:40]


def _expected(problem: Any) -> str:
    """What was expected, in the words of the project where pydantic's are those of Python."""
    kind, limits = problem["type"], problem.get("ctx", {})
    if kind in _EXPECTED:
        return _EXPECTED[kind]
    if kind.startswith("int_"):
        return "a whole number"
    if kind in ("too_short", "too_long", "string_too_short", "string_too_long"):
        least, count = "min_length" in limits, limits.get("min_length", limits.get("max_length"))
        what = "character" if isinstance(problem["input"], str) else "value"
        return f"at {'least' if least else 'most'} {count} {what}{'s' * (count != 1)}"
    message = problem["msg"].removeprefix("Value error, ").removeprefix("expected ").removeprefix("Input should be ")
    return f"a number {message}" if message.startswith(("greater ", "less ")) else message


_UNKNOWN = ("unexpected_keyword_argument", "extra_forbidden")
_FIELD = re.compile(r"[\w.-]+: ")
_EXPECTED = {
    "float_type": "a number",
    "finite_number": "a finite number",
    "string_type": "text",
    "list_type": "a list",
    "tuple_type": "a list",
    "dataclass_type": "fields with values",
    "dict_type": "fields with values",
    "invalid_key": "names that are text",
}


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
