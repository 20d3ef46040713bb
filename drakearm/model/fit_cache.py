"""Keeps what was fitted in files of the cache folder, so that an arm is fitted only once.

What cannot be read is computed again, and what cannot be written is not kept: the cache never makes a command fail. It
is in the folder of the compile cache for the present source files, so that a change of drakearm gives another fit.
"""

import hashlib
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from drakearm.errors import StorageError
from drakearm.files import replacement
from drakearm.muscle.compile_cache import cache_folder

_Fit = TypeVar("_Fit")


def cached(key: Any, kind: type[_Fit], compute: Callable[[], _Fit]) -> _Fit:
    """What was computed earlier for the same key, or else what is computed now.

    key: everything that decides about the result; its `repr` is used. kind: a type that pydantic can write and read.
    """
    folder = cache_folder()
    if folder is None:
        return compute()
    file = folder / "fits" / f"{_hash(repr(key))}.json"
    adapter = TypeAdapter(kind)
    with suppress(OSError, ValueError, ValidationError):  # ValueError: no checksum, or no text
        checksum, content = file.read_text(encoding="utf-8").split("\n", maxsplit=1)
        if checksum == _hash(content):
            return adapter.validate_json(content)
    result = compute()
    content = adapter.dump_json(result).decode()
    with suppress(StorageError), replacement(file) as partial:
        partial.write_text(f"{_hash(content)}\n{content}", encoding="utf-8")
    return result


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
