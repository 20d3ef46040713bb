"""Files that are replaced together: all of them or none, even if the process is killed at any moment."""

import os
import signal
import sys

import pytest

from drakearm.errors import RunFolderError, StorageError
from drakearm.files.together import recover, replaced_together

OLD = {"a": "old a", "b": "old b", "arm/part": "old part", "later": "made from a"}
NEW = {"a": "new a", "c": "new c", "arm/other": "new part"}
REMOVED = ("later", "arm", "absent")
AFTER = {"a": "new a", "b": "old b", "c": "new c", "arm/other": "new part"}


@pytest.fixture
def folder(tmp_path):
    write(tmp_path, OLD)
    return tmp_path


def write(folder, files):
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)


def contents(folder):
    return {str(f.relative_to(folder)): f.read_text() for f in folder.rglob("*") if f.is_file()}


def replace(folder):
    with replaced_together(folder, REMOVED) as staged:
        write(staged, NEW)


def killed(folder, change):
    """Replaces the files in a process that is killed before its nth change. Returns whether it came to that."""
    process = os.fork()
    if process == 0:
        changes = 0

        def count(event, arguments):
            nonlocal changes
            writing = event == "open" and isinstance(arguments[2], int) and arguments[2] & (os.O_WRONLY | os.O_RDWR)
            if writing or event in ("os.mkdir", "os.rename", "os.remove", "os.rmdir"):
                changes += 1
                if changes == change:
                    os.kill(os.getpid(), signal.SIGKILL)

        sys.addaudithook(count)
        replace(folder)
        os._exit(0)
    return os.WIFSIGNALED(os.waitpid(process, 0)[1])


def test_files_are_replaced_and_removed(folder):
    replace(folder)
    assert contents(folder) == AFTER


def test_a_process_killed_at_any_change_leaves_all_or_nothing(tmp_path):
    outcomes, change = [], 0
    while True:
        change += 1
        folder = tmp_path / str(change)
        write_all = folder.mkdir() or write(folder, OLD)
        assert write_all is None
        was_killed = killed(folder, change)
        recover(folder)
        outcomes.append(contents(folder))
        assert outcomes[-1] in (OLD, AFTER), change
        replace(folder)  # going on works
        assert contents(folder) == AFTER
        if not was_killed:
            break
    assert change > 10 and OLD in outcomes and AFTER in outcomes[:-1]  # kills before and after the point of no return


def test_an_error_leaves_the_folder_as_it_was(folder):
    with pytest.raises(ZeroDivisionError), replaced_together(folder, REMOVED) as staged:
        write(staged, NEW)
        raise ZeroDivisionError
    assert contents(folder) == OLD and not (folder / ".staged").exists()


def test_what_the_file_system_refuses_is_a_sentence(folder):
    with pytest.raises(StorageError, match=r"cannot be written: No space left on device\.$"):
        with replaced_together(folder, REMOVED):
            raise OSError(28, os.strerror(28))
    assert contents(folder) == OLD


def test_a_folder_of_somebody_else_touches_nothing_outside(tmp_path):
    outside, folder = tmp_path / "outside", tmp_path / "folder"
    for place in (outside, folder / ".ready" / "arm"):
        place.mkdir(parents=True)
    (outside / "precious").write_text("kept")
    (folder / "link").symlink_to(outside)
    (folder / "arm").symlink_to(outside)
    (folder / ".ready" / "arm" / "precious").write_text("hostile")
    (folder / ".ready" / ".removed").write_text(f"../outside\n{outside}\n..\n.\nlink\nlink/precious")
    recover(folder)
    assert contents(outside) == {"precious": "kept"}
    assert (folder / "arm" / "precious").read_text() == "hostile" and not (folder / "link").is_symlink()
    (folder / ".ready").symlink_to(outside)
    with pytest.raises(RunFolderError, match="is a link"):
        recover(folder)
    assert contents(outside) == {"precious": "kept"}
