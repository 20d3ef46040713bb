"""The command where something around it is missing: an output that takes nothing, no home, too little memory."""

import errno
import os
import subprocess
import sys

import pytest
from matplotlib.image import imread

from drakearm import cli
from drakearm.errors import StorageError
from drakearm.muscle.compile_cache import cache_folder
from tests.cli.command import drakearm, start


def finish(*arguments, **options):
    """Exit code, standard output and standard error of the command in a process of its own."""
    process = start(*arguments, **options)
    output, errors = process.communicate()
    return process.returncode, output, errors


def test_a_full_output_is_one_sentence():
    with open("/dev/full", "w") as full:
        assert finish("list", stdout=full)[::2] == (1, "error: The command failed: No space left on device.\n")
        assert finish("list", stdout=full, stderr=full)[0] == 1


def test_a_reader_that_leaves_is_no_error():
    reading, writing = os.pipe()
    os.close(reading)
    code, _, errors = finish("list", stdout=writing)
    os.close(writing)
    assert (code, errors) == (1, "")


@pytest.mark.slow
@pytest.mark.extra
def test_closed_streams_are_no_error_and_no_file_takes_their_place(tmp_path):
    picture = tmp_path / "arm.png"
    command = f'exec {sys.executable} -m drakearm.cli inspect arm14 --out "{picture}" <&- >&- 2>&-'
    assert subprocess.run(command, shell=True).returncode == 0
    assert imread(picture).ndim == 3


@pytest.mark.slow
@pytest.mark.extra
def test_characters_that_the_output_lacks_are_replaced():
    code, output, errors = finish("--help", env={**os.environ, "PYTHONIOENCODING": "ascii", "COLUMNS": "80"})
    assert (code, errors) == (0, "") and "human arm" in output
    code, output, errors = finish("plan", os.fsdecode(b"\xff"))
    assert code == 1 and errors.startswith("error: There is no scenario")


@pytest.mark.slow
@pytest.mark.extra
@pytest.mark.parametrize("home", [None, "below a file"])
def test_no_home(tmp_path, home):
    """The compiled functions are those of the other tests, so that they need not be compiled."""
    (tmp_path / "file").write_text("")
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache_folder().parent)}
    for name in ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "MPLCONFIGDIR"):
        environment.pop(name, None)
    if home:
        environment["HOME"] = str(tmp_path / "file" / "home")
    code, output, errors = finish("inspect", "arm14", "--out", tmp_path / "arm.png", env=environment)
    assert code == 0 and "BIClong" in output and "Traceback" not in errors
    assert imread(tmp_path / "arm.png").ndim == 3


@pytest.mark.parametrize(
    ("problem", "code", "told"),
    [
        (
            OSError(errno.ENOSPC, "No space left on device", "runs/x"),
            1,
            "error: runs/x failed: No space left on device.",
        ),
        (PermissionError(errno.EACCES, "Permission denied", b"a\xff"), 1, "error: a failed: Permission denied."),
        (OSError("no number"), 1, "error: The command failed: no number."),
        (StorageError("The disk is full."), 1, "error: The disk is full."),
        (MemoryError(), 1, "error: There is not enough memory."),
        (RecursionError("maximum recursion depth exceeded"), 1, "error: Something is nested too deeply"),
        (KeyboardInterrupt(), 130, ""),
    ],
    ids=lambda value: type(value).__name__,
)
def test_what_is_not_the_fault_of_the_code_is_one_sentence(monkeypatch, capsys, problem, code, told):
    def fail():
        raise problem

    monkeypatch.setattr(cli, "app", fail)
    with pytest.raises(SystemExit) as end:
        cli.main()
    errors = capsys.readouterr().err
    assert end.value.code == code
    assert errors.startswith(told) and errors.count("\n") == (1 if told else 0)


def test_a_bug_shows_where_it_is(monkeypatch):
    def fail():
        raise ZeroDivisionError

    monkeypatch.setattr(cli, "app", fail)
    with pytest.raises(ZeroDivisionError):
        cli.main()


@pytest.mark.parametrize("name", ["arm14.png/x.png", f"{'x' * 300}.png", "/proc/x.png"])
def test_a_picture_that_cannot_be_written_is_one_sentence(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm14.png").write_text("an earlier picture")
    message = drakearm("inspect", "arm14", "--out", name, code=1)
    assert "x.png cannot be written: " in message and len(message) <= 300
    assert (tmp_path / "arm14.png").read_text() == "an earlier picture"
    assert len(list(tmp_path.iterdir())) == 1
