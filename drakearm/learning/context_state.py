"""All that a context of Drake holds, as arrays: for the states of environments, and for checkpoints.

Drake's own copy of a context, `Context.Clone`, could not be written into a file.
"""

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np
from pydrake.systems.framework import Context

_NUMBERS = "fiub"  # the kinds of NumPy's numbers


def context_arrays(context: Context) -> dict[str, np.ndarray]:
    """Copies of the state and the parameters of a root context, by name. The time and fixed inputs are not in it.

    Of abstract values, those that are arrays, and dataclasses of arrays and numbers. Others are not in it, for example
    the geometry of a SceneGraph.
    """
    discrete = context.get_discrete_state()
    parameters = [context.get_numeric_parameter(i).value() for i in range(context.num_numeric_parameter_groups())]
    arrays = {
        "continuous": context.get_continuous_state_vector().CopyToVector(),
        "discrete": np.concatenate([[], *(discrete.value(i) for i in range(discrete.num_groups()))]),
        "parameters": np.concatenate([[], *parameters]),
    }
    for kind, i, value in _abstract_values(context):
        arrays |= _to_arrays(f"abstract_{kind}_{i}", value)
    return arrays


def set_context_arrays(context: Context, arrays: Mapping[str, np.ndarray]) -> None:
    """Sets the state and the parameters of a root context to those of `context_arrays`."""
    context.SetContinuousState(arrays["continuous"])
    sizes = [context.get_discrete_state().value(i).size for i in range(context.num_discrete_state_groups())]
    for i, part in enumerate(_split(arrays["discrete"], sizes)):
        context.SetDiscreteState(i, part)
    sizes = [context.get_numeric_parameter(i).size() for i in range(context.num_numeric_parameter_groups())]
    for i, part in enumerate(_split(arrays["parameters"], sizes)):
        context.get_mutable_numeric_parameter(i).SetFromVector(part)
    for kind, i, value in list(_abstract_values(context)):
        name = f"abstract_{kind}_{i}"
        if _to_arrays(name, value):
            restored = _of_arrays(name, value, arrays)
            if kind == "state":
                context.SetAbstractState(i, restored)
            else:
                context.get_mutable_abstract_parameter(i).set_value(restored)


def _split(values: np.ndarray, sizes: list[int]) -> list[np.ndarray]:
    return np.split(values, np.cumsum(sizes)[:-1]) if sizes else []


def _abstract_values(context: Context) -> Iterator[tuple[str, int, Any]]:
    """Kind (parameter or state), index and value of all abstract values that are objects of Python."""
    for kind, count, get in (
        ("parameter", context.num_abstract_parameters(), context.get_abstract_parameter),
        ("state", context.num_abstract_states(), context.get_abstract_state),
    ):
        for i in range(count):
            try:
                yield kind, i, get(i).get_value()
            except RuntimeError:  # a type of C++ that Python does not know
                continue


def _to_arrays(name: str, value: Any) -> dict[str, np.ndarray]:
    """The arrays and numbers of a value. Names of their parts follow a slash."""
    arrays: dict[str, np.ndarray] = {}
    for part, content in _parts(value).items():
        arrays |= _to_arrays(f"{name}/{part}", content)
    if not arrays and _is_numbers(value):
        arrays[name] = np.array(value)
    return arrays


def _of_arrays(name: str, like: Any, arrays: Mapping[str, np.ndarray]) -> Any:
    """The value of `_to_arrays`. like: a value whose other content it has."""
    if name in arrays:
        return arrays[name].copy() if isinstance(like, np.ndarray) else arrays[name].item()
    parts = {part: _of_arrays(f"{name}/{part}", content, arrays) for part, content in _parts(like).items()}
    if isinstance(like, np.ndarray):
        table = like.copy()
        for part, content in parts.items():
            table[part] = content
        return table
    return replace(like, **parts) if parts else like


def _parts(value: Any) -> dict[str, Any]:
    """The columns of a table or the fields of a dataclass, by name."""
    if isinstance(value, np.ndarray):
        return {name: value[name] for name in value.dtype.names or ()}
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: getattr(value, field.name) for field in fields(value) if field.init}
    return {}


def _is_numbers(value: Any) -> bool:
    return isinstance(value, int | float | np.number) or (
        isinstance(value, np.ndarray) and value.dtype.kind in _NUMBERS
    )
