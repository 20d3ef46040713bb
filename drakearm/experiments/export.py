"""Writes a recording as a table that other programs open: .csv for pandas and spreadsheets, .sto and .mot for OpenSim.

The columns of a .csv name quantity, joint or muscle, and unit: `q_elbow_rad`, `tendon_force_BRA_N`. Those of a .sto are
the paths of OpenSim's state variables, `/jointset/elbow/elbow/value` and `/forceset/BRA/activation`, and names of the
same form for other quantities. Both are in SI and radians. A .mot has the joint angles alone, in degrees.
"""

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, NamedTuple

import numpy as np

from drakearm.errors import RunFolderError, StorageError, shown
from drakearm.files import replacement
from drakearm.model.arm import Arm
from drakearm.model.recording import Recording

FORMATS = (".csv", ".sto", ".mot")
_JOINTS = {  # of each joint: unit, and the last part of the name in a .sto
    "q": ("rad", "value"),
    "v": ("rad_per_s", "speed"),
    "reference_q": ("rad", "reference_value"),
    "reference_v": ("rad_per_s", "reference_speed"),
    "muscle_torque": ("Nm", "muscle_torque"),
}
_MUSCLES = {  # of each muscle: unit
    "excitation": "",
    "activation": "",
    "fiber_length": "m",
    "fiber_velocity": "m_per_s",
    "tendon_force": "N",
    "mtu_length": "m",
    "fiber_power": "W",
    "tendon_power": "W",
    "metabolic_power": "W",
}
_HAND = {"p_WH": ("position", "m"), "v_WH": ("velocity", "m_per_s")}


class Column(NamedTuple):
    """A column of the table: its name in a .csv and in a .sto, and its values (N,)."""

    csv_name: str
    sto_name: str
    values: np.ndarray


def export_recording(
    recording: Recording, arm: Arm, file: str | Path, coordinates: Sequence[str] | None = None
) -> None:
    """Writes a recording of an arm into a file whose name ends in .csv, .sto or .mot. An earlier file is replaced.

    coordinates: for OpenSim, "JOINT/COORDINATE" of its model for each of the arm's coordinates. By default both names
    are that of the arm's coordinate. Raises RunFolderError if it is not a recording of this arm, or if there are not as
    many coordinates; StorageError if the file has another name, or cannot be written.
    """
    file = Path(file)
    if file.suffix not in FORMATS:
        raise StorageError(f"{shown(file)} is no name for a table: expected one that ends in {', '.join(FORMATS)}.")
    recording.check(arm)
    paths = list(coordinates or (f"{name}/{name}" for name in arm.coordinates))
    if len(paths) != len(arm.coordinates):
        raise RunFolderError(
            f"There are {len(paths)} coordinates for OpenSim, {shown(paths)}: expected {len(arm.coordinates)}, for "
            f"{', '.join(arm.coordinates)}."
        )
    columns = list(table(recording, arm, paths))
    values = [column.values for column in columns]
    with replacement(file) as partial, partial.open("w", encoding="utf-8", newline="") as stream:
        if file.suffix == ".csv":
            csv.writer(stream, lineterminator="\n").writerow(["time_s", *(column.csv_name for column in columns)])
            _write_rows(stream, recording.t, values, ",")
        elif file.suffix == ".sto":
            names = [column.sto_name for column in columns]
            _write_storage(stream, "states", names, recording.t, values, in_degrees=False)
        else:
            names = [path.split("/")[-1] for path in paths]
            _write_storage(stream, "Coordinates", names, recording.t, list(np.rad2deg(recording.q).T), in_degrees=True)


def table(recording: Recording, arm: Arm, paths: Sequence[str]) -> Iterator[Column]:
    """The columns after the time. paths: "JOINT/COORDINATE" of the coordinates in an OpenSim model."""
    for name, (unit, sto_name) in _JOINTS.items():
        for joint, path, values in zip(arm.coordinates, paths, getattr(recording, name).T, strict=True):
            yield Column(_joined(name, joint, unit), f"/jointset/{path}/{sto_name}", values)
    for name, unit in _MUSCLES.items():
        for muscle, values in zip(arm.muscle_names, getattr(recording, name).T, strict=True):
            yield Column(_joined(name, muscle, unit), f"/forceset/{muscle}/{name}", values)
    for i, muscle in enumerate(arm.muscle_names):
        for j, (joint, path) in enumerate(zip(arm.coordinates, paths, strict=True)):
            sto_name = f"/forceset/{muscle}/moment/{path.split('/')[-1]}"
            yield Column(_joined("joint_moment", muscle, joint, "Nm"), sto_name, recording.joint_moment[:, i, j])
    for name, (sto_name, unit) in _HAND.items():
        for axis, values in zip("xyz", getattr(recording, name).T, strict=True):
            yield Column(_joined(name, axis, unit), f"/hand/{sto_name}_{axis}", values)


def _joined(*parts: str) -> str:
    return "_".join(part for part in parts if part)


def _write_storage(
    stream: IO[str],
    title: str,
    names: Sequence[str],
    t: np.ndarray,
    columns: Sequence[np.ndarray],
    in_degrees: bool,
) -> None:
    """The format of .sto and .mot files: a header, then columns with tabs between them."""
    header = {
        "inDegrees": "yes" if in_degrees else "no",
        "nColumns": len(names) + 1,
        "nRows": len(t),
        "DataType": "double",  # without it, OpenSim 4's tables refuse a .sto
        "version": 3,
    }
    stream.write("".join([f"{title}\n", *(f"{key}={value}\n" for key, value in header.items()), "endheader\n"]))
    stream.write("\t".join(["time", *names]) + "\n")
    _write_rows(stream, t, columns, "\t")


def _write_rows(stream: IO[str], t: np.ndarray, columns: Sequence[np.ndarray], delimiter: str) -> None:
    np.savetxt(stream, np.column_stack([t, *columns]), fmt="%.12g", delimiter=delimiter)
