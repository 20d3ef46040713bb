"""The compile cache: keeps compiled functions in files, so that a later process does not compile them again.

Numba's own cache trusts its files. A truncated one would end each later process with an exception, one with a flipped
bit could give wrong numbers, and two processes that write at the same time can exchange the code of two functions.
Therefore, here:

- Each compiled version of a function has a file of its own, which is written whole or not at all.
- A file begins with a checksum of the rest. A damaged file is discarded, and its function is compiled again.
- A file of another user is not read, because the code in it would run.

The cache never makes a command fail: what cannot be read is compiled, and what cannot be written is not kept. The
logger `drakearm` then says so, once per process.
"""

import functools
import hashlib
import logging
import os
import pickle
import re
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import llvmlite
import numba
from numba.core import config
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.dispatcher import Dispatcher
from numba.core.serialize import dumps

from drakearm.errors import DrakearmError, StorageError, shown
from drakearm.files import replacement

_CHECKSUM_SIZE = hashlib.sha256().digest_size  # bytes
_warned: set[str] = set()


def cache_folder() -> Path | None:
    """The cache folder for the present source files of drakearm: every change of a file gives another folder.

    It is in the folder NUMBA_CACHE_DIR, else in XDG_CACHE_HOME, else in the user's ~/.cache. Returns None if the user
    has no home.
    """
    home = os.path.expanduser("~")
    if config.CACHE_DIR:  # type: ignore[attr-defined]
        base = Path(config.CACHE_DIR)  # type: ignore[attr-defined]
    elif os.path.isabs(os.environ.get("XDG_CACHE_HOME", "")):  # its specification says to ignore other paths
        base = Path(os.environ["XDG_CACHE_HOME"], "drakearm")
    elif os.path.isabs(home) and os.path.isdir(home):
        base = Path(home, ".cache", "drakearm")
    else:
        return None
    state = hashlib.sha256()
    for file in sorted(Path(__file__).parents[1].rglob("*.py")):
        state.update(file.read_bytes())
    return base / state.hexdigest()[:16]


class CompileCache(NullCache):
    """The compiled versions of one function: a file for each signature and each kind of processor.

    It has the methods of Numba's caches that a compiled function calls.
    """

    def __init__(self, dispatcher: Dispatcher, folder: Path | None):
        """dispatcher: Numba's object for the function. folder: for all functions; None if nothing can be kept.

        Raises OSError if the function is not from a file.
        """
        self._function = dispatcher.py_func
        self._options = dispatcher.targetoptions
        self._source = _hash_of_file(self._function.__code__.co_filename)
        self._folder = folder

    def load_overload(self, signature: Any, target: Any) -> CompileResult | None:
        """The function compiled for a signature and for this processor, or None if it must be compiled."""
        target.refresh()
        if self._folder is None:
            return None
        file = self._file(self._folder, signature, target.codegen())
        content = _read(file)
        if content is None:
            return None
        try:
            saved_signature, parts = pickle.loads(content)
            return CompileResult._rebuild(target, *parts) if saved_signature == signature else None
        except Exception as problem:  # unpickling can raise any of them, for example if a class has been renamed
            _discard(file, f"{type(problem).__name__}: {problem}")
            return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keeps a compiled function, if that is possible."""
        if result.library.has_dynamic_globals or any(not loop.can_cache for loop in result.lifted):
            return  # its code holds addresses in the memory of this process
        if self._folder is None:
            _warn_once(_NOT_KEPT, "the user has no home folder, and NUMBA_CACHE_DIR is not set")
            return
        content = dumps((signature, result._reduce()))
        try:
            with replacement(self._file(self._folder, signature, result.codegen)) as partial:
                partial.touch(mode=0o600)  # only its owner may change it, because its code runs
                partial.write_bytes(hashlib.sha256(content).digest() + content)
        except StorageError as error:
            _warn_once(_NOT_KEPT, str(error).rstrip("."))

    def _file(self, folder: Path, signature: Any, codegen: Any) -> Path:
        """The file for a signature and a processor. Its name has a hash of what decides about the machine code.

        Different signatures can have the same text, and so the same file: it holds the signature itself.
        """
        code = self._function.__code__
        values = tuple(cell.cell_contents for cell in self._function.__closure__ or ())
        made_from = (
            (sys.implementation.cache_tag, numba.__version__, llvmlite.__version__),
            (self._source, code.co_code, dumps(values) if values else None, sorted(self._options.items())),
            (str(signature), codegen.magic_tuple()),
        )
        module, name = Path(code.co_filename), re.sub(r"[^\w.]", "", self._function.__qualname__)[:100]
        place = f"{module.parent.name}-{_short_hash(module.parent)}"
        return folder / place / f"{module.stem}.{name}-{code.co_firstlineno}.{_short_hash(made_from)}.nbc"


def _short_hash(value: Any) -> str:
    return hashlib.sha256(repr(value).encode()).hexdigest()[:16]


@functools.cache
def _hash_of_file(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


def _read(file: Path) -> bytes | None:
    """What a file of the cache holds; None if there is none, if it belongs to another user, or if it is damaged."""
    try:
        with file.open("rb") as stream:
            if os.fstat(stream.fileno()).st_uid not in (os.getuid(), 0):  # 0: root can change everything anyway
                return None
            data = stream.read()
    except OSError:
        return None
    content = data[_CHECKSUM_SIZE:]
    if data[:_CHECKSUM_SIZE] != hashlib.sha256(content).digest():
        _discard(file, "its checksum is wrong")
        return None
    return content


_NOT_KEPT = "Compiled functions cannot be kept, so each command compiles them again, which takes about a minute"
_DAMAGED = "A damaged file of the compile cache was discarded, and its function is compiled again"


def _discard(file: Path, problem: str) -> None:
    with suppress(OSError):
        file.unlink()
    _warn_once(_DAMAGED, f"{shown(file)}, {problem}")


def _warn_once(event: str, details: str) -> None:
    """Warns about the first event of its kind in this process."""
    if event not in _warned:
        _warned.add(event)
        logging.getLogger("drakearm").warning("%s", DrakearmError(f"{event}: {details}."))
