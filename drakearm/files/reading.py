"""Reads text, YAML and JSON from files that may be damaged or hostile: what is wrong becomes one sentence.

A file cannot run code, cannot take much memory and cannot keep the reader busy: its size, its depth and what its YAML
aliases expand to are limited.
"""

import json
import re
from pathlib import Path
from typing import Any, NoReturn

import yaml

from drakearm.errors import DrakearmError, shown

_LARGEST = 5_000_000  # bytes of a file, and of what the aliases of a YAML file expand to
_DEEPEST = 50  # lists and mappings inside each other


def read_text(file: Path, error: type[DrakearmError]) -> str:
    """The text of a UTF-8 file. Raises `error` if it cannot be read, is no text, or is larger than 5 MB."""
    try:
        with file.open("rb") as stream:
            data = stream.read(_LARGEST + 1)
    except OSError as problem:
        raise error(f"{shown(file)} cannot be read: {problem.strerror}.") from problem
    if len(data) > _LARGEST:
        raise error(f"{shown(file)} is larger than {_LARGEST // 1_000_000} MB: expected a smaller text file.")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise error(f"{shown(file)} is not text: byte {problem.start} is not UTF-8.") from problem


def read_yaml(file: Path, error: type[DrakearmError]) -> dict[str, Any]:
    """The mapping in a YAML file: names with text, numbers, true, false, null, lists and mappings.

    A date is text here, and 1e3 is a number. Raises `error` if the file is not valid YAML, if it has tags or a name
    twice, or if it is too large or too deep.
    """
    text = read_text(file, error)
    try:
        content = yaml.load(text, _Loader)  # a SafeLoader
    except yaml.MarkedYAMLError as problem:
        line = f" in line {problem.problem_mark.line + 1}" if problem.problem_mark else ""
        raise error(f"{shown(file)} is not valid YAML{line}: {problem.problem}.") from problem
    except RecursionError as problem:
        raise _too_deep(file, error) from problem
    except yaml.YAMLError as problem:
        raise error(f"{shown(file)} is not valid YAML: {problem}.") from problem
    except ValueError as problem:  # Python does not read longer integers
        raise error(f"{shown(file)} is not valid YAML: found a number with thousands of digits.") from problem
    return _checked_mapping(content, file, error)


def read_json(file: Path, error: type[DrakearmError]) -> dict[str, Any]:
    """The object in a JSON file. Raises `error` if the file holds anything else, NaN, or is too large or too deep."""
    try:
        content = json.loads(read_text(file, error), parse_constant=_refuse_constant)
    except RecursionError as problem:
        raise _too_deep(file, error) from problem
    except ValueError as problem:
        raise error(f"{shown(file)} is damaged: it is not valid JSON ({problem}).") from problem
    return _checked_mapping(content, file, error)


class _Loader(yaml.SafeLoader):
    """YAML without dates and tags, with numbers like 1e3, and with an error for a name that is given twice."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()
        tag = getattr(event, "tag", None)
        if tag not in (None, "!"):
            raise yaml.composer.ComposerError(
                None, None, f"found the tag {shown(tag)}, expected none", event.start_mark
            )
        return super().compose_node(parent, index)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict:
        names = [key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode)]
        if len(names) < len(node.value):
            problem = "found a list or mapping as the name of a field, expected text"
            raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)
        for name in names:
            if name != "<<" and names.count(name) > 1:
                raise yaml.constructor.ConstructorError(None, None, f"found {shown(name)} twice", node.start_mark)
        return super().construct_mapping(node, deep)


# Numbers as in YAML 1.2: 1e3 is one, although dot and sign are missing, 010 is 10, and 10:30 is text. So is a date.
_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if not tag.endswith((":timestamp", ":int", ":float"))]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:int", re.compile(r"[-+]?(0|[1-9][0-9]*)$", re.ASCII), list("-+0123456789")
)
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(
        r"([-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN))$", re.ASCII
    ),
    list("-+0123456789."),
)


def _checked_mapping(content: Any, file: Path, error: type[DrakearmError]) -> dict[str, Any]:
    if not isinstance(content, dict):
        raise error(f"{shown(file)}: expected fields with values, found {shown(content)}.")
    if not all(isinstance(name, str) for name in content):
        name = next(name for name in content if not isinstance(name, str))
        raise error(f"{shown(file)}: found the field {shown(name)}, expected names that are text.")
    try:
        size = _expanded_size(content, {}, 0)
    except RecursionError as problem:
        raise _too_deep(file, error) from problem
    if size > _LARGEST:
        raise error(f"{shown(file)} is too large: its aliases expand to {size:.1g} values.")
    return content


def _expanded_size(value: Any, known: dict[int, int], depth: int) -> int:
    """The number of values in a tree whose branches may be used many times. Raises RecursionError if it is too deep."""
    if depth > _DEEPEST:
        raise RecursionError
    if not isinstance(value, dict | list):
        return 1
    if id(value) not in known:
        parts = value.values() if isinstance(value, dict) else value
        known[id(value)] = 1 + sum(_expanded_size(part, known, depth + 1) for part in parts)
    return known[id(value)]


def _too_deep(file: Path, error: type[DrakearmError]) -> DrakearmError:
    return error(f"{shown(file)}: expected at most {_DEEPEST} lists and mappings inside each other.")


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"found {name}, expected a finite number")
