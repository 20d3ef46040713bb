"""The compile cache: what is damaged is compiled again, what cannot be written is not kept, and no command fails."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core import config

from drakearm.muscle import compile_cache
from drakearm.muscle.compile_cache import CompileCache, cache_folder
from tests.full_disk import full_disk


@pytest.fixture(autouse=True)
def new_process(monkeypatch):
    """Each test is told what a new process would be told."""
    monkeypatch.setattr(compile_cache, "_warned", set())


def double(x):
    return x + x


def dispatcher(folder, function=double, **options):
    """The function, not compiled yet, as a new process would have it."""
    found = numba.njit(**options)(function)
    found._cache = CompileCache(found, folder)
    return found


def hits(found):
    return sum(found.stats.cache_hits.values())


def test_what_is_compiled_is_loaded_later(tmp_path):
    assert dispatcher(tmp_path)(1.5) == 3.0
    later = dispatcher(tmp_path)
    assert later(1.5) == 3.0 and hits(later) == 1


def test_each_signature_has_a_file(tmp_path):
    first = dispatcher(tmp_path)
    assert first(2) == 4 and first(1.5) == 3.0 and list(first(np.array([1.0]))) == [2.0]
    assert len(list(tmp_path.rglob("*.nbc"))) == 3
    later = dispatcher(tmp_path)
    assert later(2) == 4 and later(1.5) == 3.0 and hits(later) == 2


def test_functions_with_other_values_or_options_have_other_files(tmp_path):
    def adder(term):
        return lambda x: x + term

    assert dispatcher(tmp_path, adder(1.0))(1.0) == 2.0
    assert dispatcher(tmp_path, adder(2.0))(1.0) == 3.0
    assert dispatcher(tmp_path, adder(2.0), error_model="numpy")(1.0) == 3.0
    assert len(list(tmp_path.rglob("*.nbc"))) == 3


def flipped(data, place):
    return data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"",
        lambda data: data[:10],
        lambda data: data[: len(data) // 2],
        lambda data: data[:-1],
        lambda data: data + b"\0",
        lambda data: flipped(data, 5),
        lambda data: flipped(data, len(data) // 2),
        lambda data: flipped(data, len(data) - 1),
        lambda data: bytes(len(data)),
    ],
    ids=["empty", "short", "half", "cut", "longer", "checksum", "middle", "end", "zeros"],
)
def test_a_damaged_file_is_replaced_and_told_once(tmp_path, caplog, damage):
    dispatcher(tmp_path)(1.5)
    dispatcher(tmp_path)(2)
    for file in tmp_path.rglob("*.nbc"):
        file.write_bytes(damage(file.read_bytes()))
    healed = dispatcher(tmp_path)
    assert healed(1.5) == 3.0 and healed(2) == 4 and hits(healed) == 0
    assert len(caplog.messages) == 1 and "damaged file of the compile cache" in caplog.text
    later = dispatcher(tmp_path)
    assert later(1.5) == 3.0 and later(2) == 4 and hits(later) == 2
    assert len(caplog.messages) == 1


def test_what_was_not_written_by_the_cache_is_not_unpickled(tmp_path):
    dispatcher(tmp_path)(1.5)
    (file,) = tmp_path.rglob("*.nbc")
    witness = tmp_path / "ran"
    file.write_bytes(f"cos\nmkdir\n(V{witness}\ntR.".encode())  # a pickle that makes a folder
    assert dispatcher(tmp_path)(1.5) == 3.0
    assert not witness.exists()


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a file to another user")
def test_a_file_of_another_user_is_not_loaded(tmp_path):
    dispatcher(tmp_path)(1.5)
    (file,) = tmp_path.rglob("*.nbc")
    os.chown(file, 12345, 12345)
    later = dispatcher(tmp_path)
    assert later(1.5) == 3.0 and hits(later) == 0


def test_only_its_owner_may_change_a_file(tmp_path):
    dispatcher(tmp_path)(1.5)
    (file,) = tmp_path.rglob("*.nbc")
    assert file.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("place", ["file", "folder in place of the cache's file", "no home"])
def test_where_nothing_can_be_kept_functions_run_and_one_line_says_so(tmp_path, caplog, place):
    folder = tmp_path / "cache"
    if place == "file":
        folder.write_text("not a folder")
    elif place == "no home":
        folder = None
    else:
        dispatcher(folder)(1.5)
        (file,) = folder.rglob("*.nbc")
        file.unlink()
        (file / "full").mkdir(parents=True)
    found = dispatcher(folder)
    assert found(1.5) == 3.0 and (place.startswith("folder") or found(2) == 4)
    assert len(caplog.messages) == 1
    assert re.fullmatch("Compiled functions cannot be kept, .*", caplog.messages[0])


def test_a_full_disk_leaves_no_part_of_a_file(tmp_path, caplog):
    with full_disk():
        assert dispatcher(tmp_path)(1.5) == 3.0
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]
    assert len(caplog.messages) == 1 and "cannot be kept" in caplog.text


def test_processes_that_fill_a_cache_at_once_do_not_mix_their_code(tmp_path):
    """Each compiles the same functions for signatures in another order."""
    script = tmp_path / "functions.py"
    script.write_text(
        "import sys\n"
        "from drakearm.muscle.compiled import compiled\n"
        "@compiled\n"
        "def triple(x): return 3 * x\n"
        "@compiled\n"
        "def square(x): return x * x\n"
        "values = [2, 1.5, 2j][int(sys.argv[1]):] + [2, 1.5, 2j][:int(sys.argv[1])]\n"
        "for x in values:\n"
        "    assert triple(x) == 3 * x and square(x) == x * x, x\n"
        "print(sum(sum(f.stats.cache_hits.values()) for f in (triple, square)))\n"
    )
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    command = [sys.executable, str(script)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": environment}
    for process in [subprocess.Popen([*command, str(k)], **pipes) for k in (0, 1, 2)]:
        _, errors = process.communicate()
        assert process.returncode == 0 and not errors, errors
    later = subprocess.run([*command, "0"], check=True, **pipes)
    assert later.stdout.strip() == "6" and not later.stderr
    assert len([path for path in (tmp_path / "cache").rglob("*") if path.is_file()]) == 6


def test_where_the_cache_is(monkeypatch, tmp_path):
    def found(home, xdg=None, numba_folder=""):
        monkeypatch.setattr(config, "CACHE_DIR", numba_folder)
        monkeypatch.setenv("HOME", str(home))
        monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
        if xdg is not None:
            monkeypatch.setenv("XDG_CACHE_HOME", str(xdg))
        return cache_folder()

    home, other = tmp_path / "home", tmp_path / "other"
    home.mkdir()
    assert found(home).parent == home / ".cache" / "drakearm"
    assert found(home, xdg=other).parent == other / "drakearm"
    assert found(home, xdg=other, numba_folder=str(home)).parent == home
    for xdg in ("", "relative"):
        assert found(home, xdg=xdg).parent == home / ".cache" / "drakearm"
    for no_home in (tmp_path / "nonexistent", "relative"):
        assert found(no_home) is None
    assert found(no_home, xdg=other).parent == other / "drakearm"
    assert not Path("relative").exists()
