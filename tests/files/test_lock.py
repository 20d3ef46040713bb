"""The lock of a folder: one process at a time, until it ends."""

import os
import signal

import pytest

from drakearm.errors import RunFolderError
from drakearm.files.lock import locked


def in_child(action):
    """Runs a function in a forked process, which then waits to be killed. Returns its number."""
    read, write = os.pipe()
    process = os.fork()
    if process == 0:
        action(lambda: os.write(write, b"x"))
        os._exit(0)
    os.read(read, 1)
    return process


def test_a_second_lock_is_refused_with_a_sentence(tmp_path):
    with locked(tmp_path):
        with pytest.raises(RunFolderError, match=r"Another drakearm command is at work in .*: wait until it ends"):
            with locked(tmp_path):
                pass
    with locked(tmp_path):
        pass


def test_the_lock_of_a_killed_process_ends_with_it(tmp_path):
    def hold(ready):
        with locked(tmp_path):
            ready()
            signal.pause()

    process = in_child(hold)
    with pytest.raises(RunFolderError):
        with locked(tmp_path):
            pass
    os.kill(process, signal.SIGKILL)
    os.waitpid(process, 0)
    with locked(tmp_path):
        pass


def test_a_forked_process_does_not_keep_the_lock(tmp_path):
    """The processes of a training on Diagrams live for a while when their parent is killed."""
    with locked(tmp_path):
        process = in_child(lambda ready: (ready(), signal.pause()))
    try:
        with locked(tmp_path):
            pass
    finally:
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)
