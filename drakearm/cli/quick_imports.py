"""Imports without the garbage collector, for commands that should answer quickly."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def quick_imports() -> Iterator[None]:
    """Pauses the garbage collector for the imports inside the `with` block.

    Imports make very many objects that all stay. The collector would look at them again and again, during the imports
    and once more when the process ends. Together this takes about half a second for Drake and matplotlib.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()  # what is there now is not looked at again
        gc.enable()
