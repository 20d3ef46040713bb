"""Mutations of binary files: arrays in .npz files, and policies in safetensors files."""

import io
import json
import struct
import zipfile
from functools import cache
from random import Random
from typing import Any

import numpy as np
from numpy.lib import format as npy

from tests.attacks.mutations import fill_raw, mutate_bytes, mutate_tree

_RAW_HEADER = ["NaN", "Infinity", "1e999", "1" * 5000, "[" * 10_000 + "]" * 10_000, "x", '{"a":{}}', "", "\\"]
_DESCRS = [
    "<f8",
    "<f4",
    "<f2",
    ">f8",
    "<f16",
    "<i8",
    "|b1",
    "<c16",
    "|O",
    "<U4",
    "|S8",
    "|V8",
    "<M8[s]",
    "<m8",
    "x",
    "<f9",
]


def mutate_npz(random: Random, data: bytes) -> bytes:
    """Mutates the bytes of an .npz, its archive, or one of its arrays."""
    choice = random.random()
    if choice < 0.2:
        return mutate_bytes(random, data)
    with np.load(io.BytesIO(data)) as loaded:
        arrays = {name: loaded[name] for name in loaded.files}
    name = random.choice(list(arrays))
    if choice < 0.7:
        for _ in range(random.choice((1, 1, 2))):
            other = random.choice((name, "t", random.choice(list(arrays))))
            arrays[other] = _mutate_array(random, arrays[other])
        return _npz(arrays)
    if choice < 0.75:
        return _npy(arrays[name])
    if choice < 0.8:
        del arrays[name]
        return _npz(arrays)
    return _mutate_archive(random, arrays, name)


def _mutate_array(random: Random, array: np.ndarray) -> np.ndarray:
    rng = np.random.default_rng(random.randrange(2**32))
    if array.dtype != np.float64:
        return array
    match random.randrange(11):
        case 0 | 1 if array.size:
            array = array.copy()
            index = random.randrange(array.size)
            array.flat[index] = random.choice((np.nan, np.inf, -np.inf, 1e308, -1e300, 1e13, 1e6, 11.0, -1.0, 1e-300))
        case 2:
            dtype = random.choice(
                ("f4", "f2", "f16", "i8", "u1", "?", "c16", "O", "U4", "S4", ">f8", "M8[s]", "m8[s]", "V8")
            )
            array = array.astype("i8").astype(dtype) if dtype[0] in "MmV" else array.astype(dtype)
        case 3:
            array = array[..., None] if random.random() < 0.5 else np.array(array.sum())
        case 4:
            array = array[: random.choice((0, 1, 2, len(array) // 2, -1))] if array.ndim else array
        case 5:
            array = array[::-1] if array.ndim else array
        case 6:
            array = (
                np.repeat(array, random.choice((2, 3, 1000)), axis=random.randrange(array.ndim))
                if array.ndim
                else array
            )
        case 7:
            array = array * random.choice((0.0, -1.0, 2.0, 1.001, 1e6, 1e300, np.nan))
        case 8:
            array = array + random.choice((0.005, 0.01, 1.0, -1.0, 1e9)) * rng.standard_normal(array.shape)
        case 9:
            array = array.T if array.ndim > 1 else np.tile(array, (2, 1))
        case 10:
            array = np.zeros(array.shape, dtype=[("x", "f8"), ("y", "i4")])
    return array


def _mutate_archive(random: Random, arrays: dict[str, np.ndarray], name: str) -> bytes:
    """An archive with wrong headers, members, compression or sizes."""
    members = [(f"{key}.npy", _npy(array)) for key, array in arrays.items()]
    place = list(arrays).index(name)
    compression, flags = zipfile.ZIP_DEFLATED, 0
    match random.randrange(8):
        case 0 | 1 | 2:
            members[place] = (f"{name}.npy", _lying_npy(random, arrays[name]))
        case 3:
            members.append(random.choice((members[place], ("other.npy", b"x"), ("../../x", b"x"), ("a" * 5000, b""))))
        case 4:
            compression = random.choice((zipfile.ZIP_STORED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA))
        case 5:
            flags = random.choice((0x1, 0x8, 0x40, 0x800))
        case 6:
            members[place] = (f"{name}.npy", _bomb())
        case 7:
            members[place] = (random.choice((name, f"{name}.NPY", f"x/{name}.npy", f"{name}.npy\0")), members[place][1])
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        for member, content in members:
            archive.writestr(member, content)
    data = bytearray(buffer.getvalue())
    if flags:  # in the headers of all members
        for start in (i for i in range(len(data) - 4) if data[i : i + 4] in (b"PK\x01\x02", b"PK\x03\x04")):
            data[start + (8 if data[start + 2] == 1 else 6)] ^= flags & 0xFF
    if random.random() < 0.1:  # the size that the archive's directory gives
        start = data.rfind(b"PK\x01\x02")
        data[start + 24 : start + 28] = struct.pack("<I", random.choice((0, 1, 10**6, 2**32 - 2)))
    return bytes(data)


def _lying_npy(random: Random, array: np.ndarray) -> bytes:
    """An array whose header does not fit its data."""
    shape = random.choice(
        ((10**12,), (10**6, 10**6), (-1,), (0,), (2**63, 2), (3, 1), (), (1,) * 40, ("x",), (1.5,), "x", None)
    )
    header: dict[str, Any] = {"descr": "<f8", "fortran_order": False, "shape": array.shape}
    header[random.choice(("shape", "shape", "shape", "x"))] = shape
    if random.random() < 0.3:
        header["descr"] = random.choice((*_DESCRS, [("x", "<f8")], 5, None))
    if random.random() < 0.2:
        header["fortran_order"] = random.choice((True, 1, "x"))
    text = repr(header)
    if random.random() < 0.2:
        text = random.choice(
            ("{" * 500, "(" * 900, "-" * 900 + "1", "[" * 150 + "]" * 150, "{}", "1", "", "x" * 70_000)
        )
    version = random.choice(((1, 0), (1, 0), (2, 0), (3, 0), (9, 9)))
    encoded = text.encode() + b"\n"
    length = struct.pack("<H", min(len(encoded), 65535)) if version == (1, 0) else struct.pack("<I", len(encoded))
    return b"\x93NUMPY" + bytes(version) + length + encoded + array.tobytes()


@cache
def _bomb() -> bytes:
    """An array of 80 MB that takes 80 kB in the archive."""
    return _npy(np.zeros(10**7))


def _npy(array: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    npy.write_array(buffer, array, allow_pickle=True)
    return buffer.getvalue()


def _npz(arrays: dict[str, np.ndarray]) -> bytes:
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def mutate_policy(random: Random, data: bytes) -> bytes:
    """Mutates the bytes of a policy file, its header's fields, or its tensors."""
    choice = random.random()
    if choice < 0.15:
        return mutate_bytes(random, data)
    length = struct.unpack("<Q", data[:8])[0]
    header, body = json.loads(data[8 : 8 + length]), data[8 + length :]
    if choice < 0.65:  # the fields are JSON in JSON
        metadata = header["__metadata__"]
        fields = mutate_tree(random, {key: json.loads(text) for key, text in metadata.items()}, _RAW_HEADER)
        if isinstance(fields, dict):
            header["__metadata__"] = {
                str(key): fill_raw(json.dumps(value), _RAW_HEADER) for key, value in fields.items()
            }
        return _safetensors(header, body)
    if choice < 0.75:
        header = mutate_tree(random, header)
        return _safetensors(header, body)
    if choice < 0.95:
        values = np.frombuffer(body, "<f4").copy()
        values[random.randrange(len(values))] = random.choice((np.nan, np.inf, -np.inf, 1e38, 1e10, 90.0, -200.0, 0.0))
        if random.random() < 0.2:
            values *= random.choice((1e5, 1e30, -1.0, np.nan))
        return _safetensors(header, values.tobytes())
    sizes = (0, 1, length - 1, length + 1, len(data), 10**8, 10**9, 2**63, 2**64 - 1)
    return struct.pack("<Q", random.choice(sizes)) + data[8:]


def _safetensors(header: Any, body: bytes) -> bytes:
    text = json.dumps(header).encode()
    return struct.pack("<Q", len(text)) + text + body
