"""Saves dataclasses of arrays as .npz files, and loads them. What is wrong in a file becomes one sentence.

A field of such a dataclass is `Annotated[np.ndarray, Layout(...)]`, and the layouts of all fields are the schema of the
file. The size of an array is checked before its numbers are read, so that a small file cannot take much memory.
"""

import math
import typing
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, Any, TypeVar
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

import numpy as np
from numpy.lib import format as npy

from drakearm.errors import RunFolderError, shown
from drakearm.files.fields import LARGEST
from drakearm.files.formats import FORMAT, NEWEST, require_readable
from drakearm.files.writing import replacement

T = TypeVar("T")
_LARGEST_FILE = 64_000_000  # bytes, of the file and of all arrays that it holds
_LARGEST_STACK = 4 * _LARGEST_FILE  # of a file that holds several dataclasses
_LONGEST_HEADER = 1000  # characters, of an array's type and shape


@dataclass(frozen=True)
class Layout:
    """The shape of an array, and the range of its values.

    axes: the names of the axes, or their lengths. Axes of the same name have the same length in all arrays of a file.
    """

    axes: tuple[str | int, ...]
    least: float = -LARGEST
    most: float = LARGEST

    def allows(self, shape: tuple[int, ...]) -> bool:
        """Whether a shape has the number of axes and the lengths that are fixed."""
        if len(shape) != len(self.axes):
            return False
        return all(isinstance(axis, str) or axis == length for axis, length in zip(self.axes, shape, strict=True))

    def __str__(self) -> str:
        return f"({', '.join(map(str, self.axes))}{',' * (len(self.axes) == 1)})"


def save_arrays(instance: Any, file: Path) -> None:
    """Writes every field of a dataclass of arrays into a compressed .npz. Raises StorageError, see `replacement`."""
    _save({name: getattr(instance, name) for name in _layouts(type(instance))}, file)


def save_stack(instances: Sequence[Any], file: Path) -> None:
    """Writes at least one dataclass of arrays into a compressed .npz, where a new first axis is the instance.

    Raises StorageError, see `replacement`, and ValueError if the shapes of the instances differ.
    """
    names = _layouts(type(instances[0]))
    _save({name: np.stack([getattr(instance, name) for instance in instances]) for name in names}, file)


def load_arrays(cls: type[T], file: Path) -> T:
    """Reads what `save_arrays` wrote, as arrays of float64.

    Raises RunFolderError if the file is missing or damaged, or if an array does not have the layout of its field.
    """
    return cls(**_load(_layouts(cls), file, _LARGEST_FILE))


def load_stack(cls: type[T], file: Path) -> list[T]:
    """Reads what `save_stack` wrote. Raises RunFolderError as `load_arrays` does."""
    layouts = {name: replace(layout, axes=("runs", *layout.axes)) for name, layout in _layouts(cls).items()}
    stack = _load(layouts, file, _LARGEST_STACK)
    return [cls(**{name: array[i] for name, array in stack.items()}) for i in range(len(next(iter(stack.values()))))]


def _save(arrays: dict[str, Any], file: Path) -> None:
    with replacement(file) as partial, partial.open("wb") as stream:  # to a path, NumPy would append .npz
        np.savez_compressed(stream, **(arrays | {FORMAT: NEWEST}))


def _load(layouts: dict[str, Layout], file: Path, largest: int) -> dict[str, np.ndarray]:
    """The arrays of a file of at most this size, which have these layouts. Raises RunFolderError."""
    what = f"expected an .npz with the arrays {', '.join(layouts)}"
    try:
        if not file.is_file():
            raise RunFolderError(f"There is no file {shown(file)}: {what}.")
        if file.stat().st_size > largest:
            raise RunFolderError(f"{shown(file)} is larger than {largest // 1_000_000} MB: {what}.")
        with ZipFile(file) as archive:
            arrays = _read(archive, layouts, file, largest)
    except RunFolderError:
        raise
    except Exception as error:  # for damaged bytes, zipfile, zlib and NumPy raise errors of a dozen types
        raise RunFolderError(f"{shown(file)} is damaged: {what}.") from error
    problem = _problem(layouts, arrays)
    if problem:
        raise RunFolderError(f"{shown(file)}: {problem}.")
    return arrays


def array_problem(instance: Any, names: Sequence[str] | None = None) -> str | None:
    """What a dataclass has that its layouts do not allow: array, found, expected. None if there is nothing.

    names: of the arrays that are checked; by default all.
    """
    layouts = {name: layout for name, layout in _layouts(type(instance)).items() if names is None or name in names}
    return _problem(layouts, {name: np.asarray(getattr(instance, name)) for name in layouts})


def _problem(layouts: dict[str, Layout], arrays: dict[str, np.ndarray]) -> str | None:
    problem = _shape_problem(layouts, {name: array.shape for name, array in arrays.items()})
    if problem:
        return problem
    for name, layout in layouts.items():
        array = arrays[name]
        if not np.issubdtype(array.dtype, np.floating) and not np.issubdtype(array.dtype, np.integer):
            return f"{name}: found an array of {shown(array.dtype.str)}, expected numbers"
        good = (array >= layout.least) & (array <= layout.most)  # false where the array is NaN
        if not good.all():
            index = tuple(int(i) for i in np.unravel_index(int(np.argmin(good)), array.shape))
            where = f"{name}[{', '.join(map(str, index))}]"
            return f"{where}: found {float(array[index]):g}, expected a number from {layout.least:g} to {layout.most:g}"
    return None


def _layouts(cls: type) -> dict[str, Layout]:
    """The layout of each field."""
    hints = typing.get_type_hints(cls, include_extras=True)
    return {name: layout for name, hint in hints.items() for layout in getattr(hint, "__metadata__", ())}


def _shape_problem(layouts: dict[str, Layout], shapes: dict[str, tuple[int, ...]]) -> str | None:
    lengths: dict[str | int, tuple[int, str]] = {}  # of each axis with a name, and the array that gave it
    for name, layout in layouts.items():
        shape = shapes[name]
        if not layout.allows(shape):
            return f"{name}: found an array of the shape {shown(shape)}, expected {layout}"
        for axis, length in zip(layout.axes, shape, strict=True):
            expected, other = lengths.setdefault(axis, (length, name))
            if length < 1:
                return f"{name}: found an empty array, expected {layout}"
            if length != expected:
                return f"{name}: found {axis} = {length}, expected {axis} = {expected} as in {other}"
    return None


def _read(archive: ZipFile, layouts: dict[str, Layout], file: Path, largest: int) -> dict[str, np.ndarray]:
    """The arrays of an .npz. Raises RunFolderError, and any error at all if the archive is damaged."""
    members = [member.filename.removesuffix(".npy") for member in archive.infolist()]
    size = sum(info.file_size for info in archive.infolist())
    if size > largest:
        raise RunFolderError(f"{shown(file)} holds {size:.2g} bytes: expected at most {largest:.2g}.")
    infos = dict(zip(members, archive.infolist(), strict=True))
    if FORMAT in infos:
        number = _read_array(archive, infos.pop(FORMAT), FORMAT, file)
        require_readable(number.item() if number.size == 1 else number.tolist(), file, RunFolderError)
    for name in layouts:
        if members.count(name) != 1:
            found = "no such array" if name not in members else "it twice"
            raise RunFolderError(f"{shown(file)}: {name}: found {found}, expected one array of that name.")
    for name in infos:
        if name not in layouts:
            raise RunFolderError(f"{shown(file)}: found the array {shown(name)}, expected only {', '.join(layouts)}.")
    return {name: _read_array(archive, infos[name], name, file) for name in layouts}


def _read_array(archive: ZipFile, info: ZipInfo, name: str, file: Path) -> np.ndarray:
    def wrong(found: str, expected: str) -> RunFolderError:
        return RunFolderError(f"{shown(file)}: {name}: found {found}, expected {expected}.")

    if info.flag_bits & 1 or info.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
        raise wrong("an array that is encrypted or compressed in an unusual way", "what np.savez_compressed writes")
    with archive.open(info) as stream:
        shape, fortran_order, dtype = _read_header(stream)
        if dtype.kind not in "fiu" or dtype.itemsize > 8:
            raise wrong(f"an array of {shown(dtype.str)}", "numbers such as float64")
        if any(length < 0 for length in shape) or stream.tell() + math.prod(shape) * dtype.itemsize != info.file_size:
            raise wrong(f"the shape {shown(shape)}, which does not fit the size of the data", "its real shape")
        data = stream.read()  # its end is the end of the member: now the checksum is compared
    array = np.frombuffer(data, dtype).reshape(shape, order="F" if fortran_order else "C")
    return np.ascontiguousarray(array, dtype=np.float64)


def _read_header(stream: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype]:
    """Shape, whether the order is Fortran's, and type. Raises any error at all if the header is damaged."""
    version = npy.read_magic(stream)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    return read(stream, max_header_size=_LONGEST_HEADER)
