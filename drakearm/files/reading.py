"""Reads text, YAML and JSON from files that may be damaged or hostile: what is wrong becomes one sentence.

A file cannot run code, cannot take much memory and cannot keep the reader busy: its size, its depth and what its YAML
aliases expand to are limited.
"""

import json
import math
import re
from collections import Counter
from pathlib import Path
from typing import Any

import yaml

from drakearm.errors import DrakearmError, shown
from drakearm.files.formats import FORMAT, require_readable

_LARGEST = 5_000_000  # bytes of a file
_LARGEST_YAML = 500_000  # bytes of a YAML file: a larger one could keep the reader busy for minutes
_MOST_VALUES = 100_000  # in a YAML file, with those that its aliases repeat
_DEEPEST = 50  # lists and mappings inside each other


def read_text(file: Path, error: type[DrakearmError], largest: int = _LARGEST) -> str:
    """The text of a UTF-8 file. Raises `error` if it cannot be read, is no text, or is larger than this many bytes."""
    try:
        with file.open("rb") as stream:
            data = stream.read(largest + 1)
    except (OSError, ValueError) as problem:  # ValueError: the path has a NUL
        reason = getattr(problem, "strerror", None) or "no file can have this name"
        raise error(f"{shown(file)} cannot be read: {reason}.") from problem
    if len(data) > largest:
        raise error(f"{shown(file)} is larger than {largest // 1000} kB: expected a smaller text file.")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise error(f"{shown(file)} is not text: byte {problem.start} is not UTF-8.") from problem


def read_yaml(file: Path, error: type[DrakearmError]) -> dict[str, Any]:
    """The mapping in a YAML file: names with text, numbers, true, false, null, lists and mappings.

    As in YAML 1.2, a date is text, 1e3 is a number, and << is a name like others. The field `format` is checked and
    left out. Raises `error` if the file is not valid YAML, if it has tags or a name twice, if it is too large or too
    deep, or if it is of a format that this drakearm does not know.
    """
    text = read_text(file, error, _LARGEST_YAML)
    try:
        content = yaml.load(text, _Loader)  # a SafeLoader
    except yaml.MarkedYAMLError as problem:
        line = f" in line {problem.problem_mark.line + 1}" if problem.problem_mark else ""
        raise error(f"{shown(file)} is not valid YAML{line}: {_plain(str(problem.problem))}.") from problem
    except RecursionError as problem:
        raise _too_deep(file, error) from problem
    except yaml.YAMLError as problem:
        raise error(f"{shown(file)} is not valid YAML: {problem}.") from problem
    except ValueError as problem:  # Python does not read longer integers
        raise error(f"{shown(file)} is not valid YAML: found a number with thousands of digits.") from problem
    _check_size(content, file, error, _MOST_VALUES)
    return _checked_mapping(content, file, error)


def _plain(problem: str) -> str:
    """What PyYAML finds wrong, in plain words where its own are those of a grammar."""
    for pattern, words in _PLAIN.items():
        if re.match(pattern, problem):
            return words
    return problem


def read_json(file: Path, error: type[DrakearmError]) -> dict[str, Any]:
    """The object in a JSON file, without its `format`.

    Raises `error` if the file holds anything else or is of an unknown format, or as `parse_json` does.
    """
    return _checked_mapping(parse_json(read_text(file, error), file, error), file, error)


def parse_json(text: str, file: Path, error: type[DrakearmError], *, infinity: bool = False) -> Any:
    """The value that a JSON text in a file describes.

    Raises `error` if the text is no JSON, is too large or too deep, or has a number that is not finite. infinity:
    whether Infinity and -Infinity are allowed.
    """

    def constant(name: str) -> float:
        number = float(name)
        if math.isfinite(number) or (infinity and not math.isnan(number)):
            return number
        raise ValueError(f"found {name[:40]}, expected a finite number")

    try:
        content = json.loads(text, parse_constant=constant, parse_float=constant)
    except RecursionError as problem:
        raise _too_deep(file, error) from problem
    except ValueError as problem:  # of thousands of digits Python writes a long sentence
        found = "" if "digits" in str(problem) else f" ({problem})"
        raise error(f"{shown(file)} is damaged: it is not valid JSON{found}.") from problem
    _check_size(content, file, error, _LARGEST)
    return content


_PLAIN = {
    "expected <block end>": "the line is not indented like the lines above it",
    "mapping values are not allowed here": "this line, or the one above, is not indented like the other ones",
    "could not find expected ':'": "this line, or the one above, has no name with a colon and a space after it",
    r"found character '\\t'": "found a tab, expected spaces",
    r"expected ',' or '[\]}]'": "a bracket is not closed, or a comma is missing, here or above",
}


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
        twice, count = Counter(names).most_common(1)[0] if names else ("", 0)
        if count > 1:
            raise yaml.constructor.ConstructorError(None, None, f"found {shown(twice)} twice", node.start_mark)
        return super().construct_mapping(node, deep)


# Numbers as in YAML 1.2: 1e3 is one, although dot and sign are missing, 010 is 10, and 10:30 is text. So is a date. And
# << does not merge mappings: a short file of merged mappings could take all memory.
_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag.endswith((":bool", ":null"))]
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
    require_readable(content.pop(FORMAT, 1), file, error)
    return content


def _check_size(content: Any, file: Path, error: type[DrakearmError], most: int) -> None:
    try:
        size = _expanded_size(content, {}, 0)
    except RecursionError as problem:
        raise _too_deep(file, error) from problem
    if size > most:
        raise error(f"{shown(file)} is too large: it holds more than {most:,} values.")


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
