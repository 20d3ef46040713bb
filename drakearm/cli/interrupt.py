"""Ctrl-C at a time when it does no harm."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def delayed_interrupt(until: str) -> Iterator[Callable[[], None]]:
    """Yields a function. After Ctrl-C, the next call of this function raises KeyboardInterrupt.

    So what is written between two calls is complete. A second Ctrl-C interrupts at once. Processes that are forked
    inside the `with` block ignore Ctrl-C: their parent ends them. until: for the message, when the next call will be.
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
