"""A disk without room for larger files, as far as a process without rights can have one."""

import resource
from contextlib import contextmanager


@contextmanager
def full_disk(room=1000):
    """In the `with` block, this process cannot write beyond this many bytes of any file."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
