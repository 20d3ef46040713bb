"""The option `--import`: runs a user's own modules, so that a scenario file can list the costs that they define."""

import importlib
import importlib.util
import os
import sys
import traceback
from collections.abc import Iterable
from pathlib import Path

from drakearm.errors import OwnCodeError, shown


def import_own_code(modules: Iterable[str] | None) -> None:
    """Imports modules by name, from the current folder too, or by the path of a .py file.

    Raises OwnCodeError if there is no such module or file, or if its code raises an exception.
    """
    for module in modules or ():
        try:
            _import_file(Path(module)) if module.endswith(".py") else _import_module(module)
        except OwnCodeError:
            raise
        except (Exception, SystemExit) as error:
            said = str(error).rstrip(".")
            raise OwnCodeError(
                f"--import {shown(Path(module))} failed in {_place(error)}: {type(error).__name__}: {said}."
            ) from error


def _place(error: BaseException) -> str:
    """File and line where an exception was raised."""
    if isinstance(error, SyntaxError):
        return f"{error.filename}, line {error.lineno}"
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"{frame.filename}, line {frame.lineno}"


def _import_module(name: str) -> None:
    if str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{name}.".startswith(f"{error.name}."):
            raise  # the module itself was found, but not what it imports
        raise OwnCodeError(
            f"--import: there is no module {shown(error.name)} in {shown(Path.cwd())} or among the installed ones; "
            "expected the name of a module or the path of a .py file."
        ) from error


def _import_file(file: Path) -> None:
    if not os.path.isfile(file):  # also if its name is too long
        raise OwnCodeError(f"--import {shown(file)}: there is no such file.")
    name = f"own_code_{file.stem}"  # does not hide an installed module of the same name
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # pydantic looks up the annotations of a class there
    spec.loader.exec_module(module)
