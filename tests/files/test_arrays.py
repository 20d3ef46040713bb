"""Array files: what is saved is loaded, and every other file is refused with one sentence that names the array."""

import io
import zipfile
from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import RunFolderError, TaskError
from drakearm.model.recording import Recording, load_recordings, save_recordings
from drakearm.model.reference import CONTROL_STEP, Reference
from tests.recordings import still_recording

N, N_Q = 6, 2


@pytest.fixture
def arrays():
    rng = np.random.default_rng(0)
    q, v, a, tau = rng.normal(size=(4, N, N_Q))
    return {"t": CONTROL_STEP * np.arange(N), "q": q, "v": v, "a": a, "tau": tau}


@pytest.fixture
def file(tmp_path):
    return tmp_path / "reference.npz"


def refusal(file) -> str:
    with pytest.raises(RunFolderError) as error:
        Reference.load(file)
    return str(error.value)


def write_members(file, members, compression=zipfile.ZIP_DEFLATED):
    with zipfile.ZipFile(file, "w", compression) as archive:
        for name, content in members:
            archive.writestr(name, content)


def as_npy(array) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def test_a_loaded_reference_is_the_saved_one(file, arrays):
    Reference(**arrays).save(file)
    loaded = Reference.load(file)
    for name, array in arrays.items():
        np.testing.assert_array_equal(getattr(loaded, name), array)
    assert [path.name for path in file.parent.iterdir()] == [file.name]


def test_numbers_of_other_types_are_converted(file, arrays):
    still = np.asfortranarray(np.zeros((N, N_Q), dtype=np.int32))
    np.savez(file, **{**arrays, "q": arrays["q"].astype(">f4"), "v": still})
    loaded = Reference.load(file)
    assert loaded.q.dtype == np.float64 and loaded.v.dtype == np.float64
    np.testing.assert_allclose(loaded.q, arrays["q"], rtol=1e-6)


@pytest.mark.parametrize("content", [b"", b"just text", b"PK\x03\x04", b"\0" * 1000])
def test_a_file_that_is_no_archive_is_refused(file, content):
    file.write_bytes(content)
    assert "is damaged: expected an .npz with the arrays t, q, v, a, tau" in refusal(file)


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    for path in (tmp_path / "none.npz", tmp_path, tmp_path / "a\0b"):
        assert "There is no file" in refusal(path)


def test_a_plain_npy_is_refused(file, arrays):
    file.write_bytes(as_npy(arrays["q"]))
    assert "is damaged" in refusal(file)


def test_every_cut_and_every_flipped_byte_is_noticed(file, arrays):
    Reference(**arrays).save(file)
    data = file.read_bytes()
    for at in range(0, len(data), 37):
        file.write_bytes(data[:at])
        refusal(file)
    with zipfile.ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            archive.writestr(f"{name}.npy", as_npy(array))
    data = bytearray(file.read_bytes())
    at = data.index(arrays["q"].tobytes()) + 3
    data[at] ^= 1
    file.write_bytes(data)
    assert "is damaged" in refusal(file)


@pytest.mark.parametrize(
    ("name", "change", "sentence"),
    [
        ("q", lambda q: q.astype(object), "q: found an array of '|O', expected numbers such as float64"),
        ("q", lambda q: q.astype("U8"), "q: found an array of '<U8'"),
        ("q", lambda q: q.astype(complex), "q: found an array of '<c16'"),
        ("q", lambda q: q > 0, "q: found an array of '|b1'"),
        ("q", lambda q: np.zeros(q.shape, [("x", "f8")]), "q: found an array of '|V8'"),
        ("q", lambda q: np.where(q == q[3, 1], np.nan, q), "q[3, 1]: found nan, expected a number from -10 to 10"),
        ("v", lambda v: np.where(v == v[0, 0], np.inf, v), "v[0, 0]: found inf"),
        ("q", lambda q: q + 1e6, "expected a number from -10 to 10"),
        ("tau", lambda tau: tau * 1e300, "tau[0, 0]: found"),
        ("q", lambda q: q[:, 0], "q: found an array of the shape (6,), expected (N, n_q)"),
        ("t", lambda t: t[:, None], "t: found an array of the shape (6, 1), expected (N,)"),
        ("v", lambda v: v[:-1], "v: found N = 5, expected N = 6 as in t"),
        ("v", lambda v: v[:, :1], "v: found n_q = 1, expected n_q = 2 as in q"),
        ("q", lambda q: q[:, :0], "q: found an empty array, expected (N, n_q)"),
        ("t", lambda t: t[:0], "t: found an empty array"),
        ("t", lambda t: t[::-1], "t[0]: found 0.05, expected 0, because samples are 0.01 s apart"),
        ("t", lambda t: t + 0.01, "t[0]: found 0.01, expected 0"),
        ("t", lambda t: 2.0 * t, "t[1]: found 0.02, expected 0.01"),
        ("t", lambda t: np.minimum(t, 0.03), "t[4]: found 0.03, expected 0.04"),
    ],
)
def test_an_unsuitable_array_is_named(file, arrays, name, change, sentence):
    np.savez(file, **{**arrays, name: change(arrays[name])})
    message = refusal(file)
    assert sentence in message and str(file) in message and len(message) <= 300


def test_one_sample_is_no_movement(file, arrays):
    np.savez(file, **{name: array[:1] for name, array in arrays.items()})
    assert "t: found N = 1, expected N = 2 to 20000" in refusal(file)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda m: m[1:], "t: found no such array"),
        (lambda m: [*m, m[0]], "t: found it twice"),
        (lambda m: [*m, ("other.npy", b"")], "found the array 'other', expected only t, q, v, a, tau"),
        (lambda m: [("../t.npy", m[0][1]), *m[1:]], "t: found no such array"),
        (lambda m: [("t.npy", b"text"), *m[1:]], "is damaged"),
    ],
)
@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_unsuitable_members_are_refused(file, arrays, change, sentence):
    write_members(file, change([(f"{name}.npy", as_npy(array)) for name, array in arrays.items()]))
    assert sentence in refusal(file)


def test_an_unusual_compression_is_refused(file, arrays):
    write_members(file, [(f"{name}.npy", as_npy(array)) for name, array in arrays.items()], zipfile.ZIP_LZMA)
    assert "t: found an array that is encrypted or compressed in an unusual way" in refusal(file)


def test_an_encrypted_array_is_refused(file, arrays):
    Reference(**arrays).save(file)
    data = bytearray(file.read_bytes())
    data[data.index(b"PK\x01\x02") + 8] |= 1
    file.write_bytes(data)
    assert "t: found an array that is encrypted" in refusal(file)


@pytest.mark.parametrize(
    "shape", ["(1000000000000,)", "(1000000, 1000000)", "(-6,)", "(7,)", "(18446744073709551616,)"]
)
def test_a_header_that_lies_about_the_shape_takes_no_memory(file, arrays, shape):
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    lie = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + arrays["t"].tobytes()
    write_members(
        file, [("t.npy", lie), *((f"{name}.npy", as_npy(array)) for name, array in arrays.items() if name != "t")]
    )
    assert "t: found the shape" in refusal(file)


@pytest.mark.parametrize("header", ["(" * 900, "{'descr': '<f8'}", "1", "-" * 900 + "1", "{" * 60_000])
def test_a_header_that_is_none_is_refused(file, arrays, header):
    damaged = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode() + arrays["t"].tobytes()
    others = [(f"{name}.npy", as_npy(array)) for name, array in arrays.items() if name != "t"]
    write_members(file, [("t.npy", damaged), *others])
    assert "is damaged" in refusal(file)


def test_a_small_file_that_expands_to_much_is_refused(file, arrays):
    np.savez_compressed(file, **{**arrays, "q": np.zeros((5_000_000, 2))})
    assert file.stat().st_size < 200_000
    assert "bytes: expected at most 6.4e+07" in refusal(file)


def make_recording(**changes) -> Recording:
    return replace(still_recording(N, N_Q, 3), **changes)


def test_a_recording_may_begin_at_a_later_control_step(file):
    make_recording(t=CONTROL_STEP * np.arange(3, N + 3)).save(file)
    assert Recording.load(file).t[0] == pytest.approx(0.03)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"activation": np.full((N, 3), 1.1)}, "activation[0, 0]: found 1.1, expected a number from 0 to 1"),
        ({"excitation": np.zeros((N, 4))}, "activation: found n = 3, expected n = 4 as in excitation"),
        ({"t": CONTROL_STEP * np.arange(N) + 0.005}, "because samples are 0.01 s apart"),
        ({"reward": np.full(N, np.nan)}, "reward[0]: found nan"),
        ({"fiber_length": np.full((N, 3), -0.1)}, "fiber_length[0, 0]: found -0.1"),
        ({"joint_moment": np.zeros((N, 3, 1))}, "joint_moment: found n_q = 1, expected n_q = 2 as in q"),
        ({"p_WH": np.zeros((N, 2))}, "p_WH: found an array of the shape (6, 2), expected (N, 3)"),
    ],
)
def test_an_unsuitable_recording_is_refused(file, changes, sentence):
    make_recording(**changes).save(file)
    with pytest.raises(RunFolderError) as error:
        Recording.load(file)
    assert sentence in str(error.value)


def test_several_recordings_are_loaded_as_they_were_saved(file):
    saved = [make_recording(q=np.full((N, N_Q), float(run))) for run in range(3)]
    save_recordings(saved, file)
    loaded = load_recordings(file)
    assert [recording.q[0, 0] for recording in loaded] == [0.0, 1.0, 2.0]
    np.testing.assert_array_equal(loaded[2].joint_moment, saved[2].joint_moment)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"t": CONTROL_STEP * np.arange(N) + 0.005}, "because samples are 0.01 s apart"),
        ({"activation": np.full((N, 3), 1.1)}, "activation[1, 0, 0]: found 1.1, expected a number from 0 to 1"),
    ],
)
def test_an_unsuitable_one_of_several_recordings_is_refused(file, changes, sentence):
    save_recordings([make_recording(), make_recording(**changes)], file)
    with pytest.raises(RunFolderError) as error:
        load_recordings(file)
    assert sentence in str(error.value)


def test_one_recording_is_not_several(file):
    make_recording().save(file)
    with pytest.raises(RunFolderError, match=r"t: found an array of the shape \(6,\), expected \(runs, N\)"):
        load_recordings(file)


def test_a_recording_of_another_arm_is_refused(arm):
    with pytest.raises(RunFolderError, match="has 2 joints and 3 muscles: expected 2 and 14, as the arm arm14 has"):
        make_recording().check(arm)


def test_a_recording_whose_arrays_do_not_fit_each_other_is_refused(arm):
    with pytest.raises(RunFolderError, match="has a wrong array: reference_q: found N = 3, expected N = 6"):
        make_recording(reference_q=np.zeros((3, 2))).check(arm)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda r: replace(r, q=np.full_like(r.q, np.nan)), "cannot follow the reference: q.0, 0.: found nan"),
        (lambda r: replace(r, t=2.0 * r.t), "samples are 0.01 s apart"),
        (lambda r: replace(r, v=r.v[1:]), "v: found N = 75, expected N = 76"),
        (
            lambda r: Reference(r.t, *(np.tile(getattr(r, name), 2) for name in ("q", "v", "a", "tau"))),
            "has 4 joints: expected 2, the shoulder, elbow of the arm arm14",
        ),
    ],
)
def test_a_task_refuses_a_reference_that_its_arm_cannot_follow(task, change, sentence):
    with pytest.raises(TaskError, match=sentence):
        replace(task, reference=change(task.reference))
