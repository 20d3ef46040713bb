"""Dataclasses whose fields pydantic checks, with signatures that people can read."""

import inspect
import typing
from collections.abc import Callable
from dataclasses import field
from typing import Any, TypeVar, dataclass_transform

from pydantic import Field
from pydantic.dataclasses import dataclass

from drakearm.files.fields import STRICT

T = TypeVar("T")


@dataclass_transform(frozen_default=True, field_specifiers=(field, Field))
def checked_dataclass(*, kw_only: bool = False) -> Callable[[type[T]], type[T]]:
    """Makes a frozen dataclass whose fields pydantic checks. A field that it does not have is an error.

    Its signature shows names, types and defaults. That of pydantic shows all checks too: thousands of characters.
    """

    def decorate(cls: type[T]) -> type[T]:
        checked: Any = dataclass(frozen=True, kw_only=kw_only, config=STRICT)(cls)
        checked.__signature__ = _PlainSignature(vars(checked)["__signature__"])
        return checked  # type: ignore[no-any-return]

    return decorate


class _PlainSignature:
    """A class's signature with `T` instead of `Annotated[T, ...]`, made when it is read.

    Instances have no signature from here: `inspect.signature` of one that can be called reads its `__call__`.
    """

    def __init__(self, checked: Any) -> None:
        self._checked = checked

    def __get__(self, instance: Any, owner: type) -> inspect.Signature:
        if instance is not None:
            raise AttributeError("__signature__")
        signature: inspect.Signature = self._checked.__get__(None, owner)
        types = typing.get_type_hints(owner)
        plain = [one.replace(annotation=types.get(name, one.annotation)) for name, one in signature.parameters.items()]
        return signature.replace(parameters=plain)
