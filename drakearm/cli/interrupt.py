"""Ctrl-C at a time when it does no harm."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def delayed_interrupt(until: str) -> Iterator[Callable[[], None]]:
    """Delays a KeyboardInterrupt until the function is called that this yields. until: for the message, when that is.

    So what is written before each call is complete. A second Ctrl-C interrupts at once. Processes that are forked
    meanwhile ignore Ctrl-C: their parent ends them.
    """
    process, pressed = os.getpid(), False

    def note(number: int, frame: FrameType | None) -> None:
        nonlocal pressed
        if os.getpid() == process:
            pressed = True
            signal.signal(signal.SIGINT, before)
            # Not through Python's buffered streams, which may be at work on a line just now
            os.write(2, f"\nstopping {until}; press Ctrl-C again to stop at once\n".encode())

    def interrupt_now() -> None:
        if pressed:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, note)
    try:
        yield interrupt_now
    finally:
        signal.signal(signal.SIGINT, before)
