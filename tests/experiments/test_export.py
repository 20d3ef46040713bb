"""What is exported is what was recorded, in files that NumPy, pandas and OpenSim read."""

from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest

from drakearm.errors import RunFolderError, StorageError
from drakearm.experiments import export_recording
from drakearm.importing.opensim_file import import_opensim
from drakearm.model.recording import Recording
from tests.recordings import still_recording

SAMPLES = 5


@pytest.fixture(scope="module")
def recording(arm) -> Recording:
    """Every array has other numbers than the others."""
    still = still_recording(SAMPLES, len(arm.coordinates), len(arm.muscles))
    arrays = {name: array for name, array in vars(still).items() if name != "t"}
    rng = np.random.default_rng(0)
    return replace(still, **{name: rng.uniform(0.1, 1.0, array.shape) for name, array in arrays.items()})


def read_storage(file):
    """The header, and the columns by their labels, of a file for OpenSim."""
    lines = file.read_text().splitlines()
    end = lines.index("endheader")
    header = dict(line.split("=") for line in lines[1:end])
    labels = lines[end + 1].split("\t")
    rows = np.array([[float(cell) for cell in line.split("\t")] for line in lines[end + 2 :]])
    assert rows.shape == (int(header["nRows"]), int(header["nColumns"])) == (SAMPLES, len(labels))
    assert header["DataType"] == "double" and lines[0] and "=" not in lines[0]
    return header, dict(zip(labels, rows.T, strict=True))


def test_a_csv_has_every_quantity_with_its_unit(recording, arm, tmp_path):
    export_recording(recording, arm, str(tmp_path / "x.csv"))
    table = np.genfromtxt(tmp_path / "x.csv", delimiter=",", names=True)
    bra = arm.muscle_names.index("BRA")
    expected = {
        "time_s": recording.t,
        "q_elbow_rad": recording.q[:, 1],
        "v_shoulder_rad_per_s": recording.v[:, 0],
        "reference_q_elbow_rad": recording.reference_q[:, 1],
        "muscle_torque_elbow_Nm": recording.joint_moment.sum(axis=1)[:, 1],
        "excitation_BRA": recording.excitation[:, bra],
        "activation_BRA": recording.activation[:, bra],
        "fiber_length_BRA_m": recording.fiber_length[:, bra],
        "fiber_velocity_BRA_m_per_s": recording.fiber_velocity[:, bra],
        "tendon_force_BRA_N": recording.tendon_force[:, bra],
        "mtu_length_BRA_m": recording.mtu_length[:, bra],
        "joint_moment_BRA_elbow_Nm": recording.joint_moment[:, bra, 1],
        "fiber_power_BRA_W": recording.fiber_power[:, bra],
        "tendon_power_BRA_W": recording.tendon_power[:, bra],
        "metabolic_power_BRA_W": recording.metabolic_power[:, bra],
        "p_WH_y_m": recording.p_WH[:, 1],
        "v_WH_z_m_per_s": recording.v_WH[:, 2],
    }
    for name, values in expected.items():
        np.testing.assert_allclose(table[name], values, rtol=1e-10, err_msg=name)
    assert len(table.dtype.names) == 1 + 5 * 2 + 9 * 14 + 14 * 2 + 6


def test_a_sto_has_the_paths_of_opensims_states(recording, arm, tmp_path):
    export_recording(recording, arm, tmp_path / "x.sto", ["r_shoulder/r_shoulder_elev", "elbow/elbow_flexion"])
    header, columns = read_storage(tmp_path / "x.sto")
    assert header["inDegrees"] == "no" and next(iter(columns)) == "time"
    np.testing.assert_allclose(columns["/jointset/r_shoulder/r_shoulder_elev/value"], recording.q[:, 0], rtol=1e-10)
    np.testing.assert_allclose(columns["/jointset/elbow/elbow_flexion/speed"], recording.v[:, 1], rtol=1e-10)
    np.testing.assert_allclose(columns["/forceset/TRIlong/activation"], recording.activation[:, 0], rtol=1e-10)
    np.testing.assert_allclose(columns["/forceset/TRIlong/fiber_length"], recording.fiber_length[:, 0], rtol=1e-10)


def test_a_mot_has_the_angles_in_degrees(recording, arm, tmp_path):
    export_recording(recording, arm, tmp_path / "x.mot")
    header, columns = read_storage(tmp_path / "x.mot")
    assert header["inDegrees"] == "yes" and list(columns) == ["time", "shoulder", "elbow"]
    np.testing.assert_allclose(columns["elbow"], np.rad2deg(recording.q[:, 1]), rtol=1e-10)


@pytest.mark.parametrize("suffix", [".sto", ".mot"])
def test_opensim_reads_it(recording, arm, tmp_path, suffix):
    if not find_spec("opensim"):
        pytest.skip("OpenSim is not installed")
    opensim = import_opensim()
    export_recording(recording, arm, tmp_path / f"x{suffix}")
    _, columns = read_storage(tmp_path / f"x{suffix}")
    table = opensim.TimeSeriesTable(str(tmp_path / f"x{suffix}"))
    assert list(table.getColumnLabels()) == list(columns)[1:]
    np.testing.assert_allclose(table.getMatrix().to_numpy(), np.transpose(list(columns.values())[1:]), rtol=1e-10)


def test_names_with_commas_stay_one_column(recording, arm, tmp_path):
    named = replace(arm, muscles=(replace(arm.muscles[0], name='a,"b'), *arm.muscles[1:]))
    export_recording(recording, named, tmp_path / "x.csv")
    assert '"activation_a,""b"' in (tmp_path / "x.csv").read_text().splitlines()[0]


def test_what_does_not_fit_is_refused(recording, arm, tmp_path):
    with pytest.raises(
        RunFolderError, match=r"There are 1 coordinates for OpenSim, .*: expected 2, for shoulder, elbow"
    ):
        export_recording(recording, arm, tmp_path / "x.sto", ["r_shoulder/r_shoulder_elev"])
    with pytest.raises(RunFolderError, match="has 2 joints and 14 muscles: expected 2 and 13"):
        export_recording(recording, replace(arm, muscles=arm.muscles[:13]), tmp_path / "x.csv")
    with pytest.raises(StorageError, match=r"expected one that ends in .csv, .sto, .mot"):
        export_recording(recording, arm, tmp_path / "x.txt")
    assert not list(tmp_path.iterdir())
