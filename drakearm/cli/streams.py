"""The standard streams of the process, where they are closed, full, or in an encoding that lacks characters."""

import os
import sys
from contextlib import suppress


def prepare_streams() -> None:
    """Makes it safe to print anything.

    A standard stream that is closed gets the null device: otherwise the next file that is opened would take its place,
    and the messages of libraries would be written into this file. Characters that the encoding lacks become "?".
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest descriptor that is free, which is this one
    if hasattr(sys.stdout, "reconfigure"):  # not where a test or a notebook collects the output
        sys.stdout.reconfigure(errors="replace")


def abandon_output() -> None:
    """Drops what could not be written, so that Python does not try it again, and fail, at the end of the process."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            try:
                stream.flush()
            except OSError:
                with suppress(OSError):
                    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
