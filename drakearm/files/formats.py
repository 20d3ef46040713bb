"""The version of a file's format, which the file carries as `format`. A file without one is of the first format.

When a format changes in a way that an older drakearm would misread, NEWEST grows by one.
"""

from pathlib import Path
from typing import Any

from drakearm.errors import DrakearmError, shown

FORMAT = "format"  # name of the field or array
NEWEST = 1


def require_readable(number: Any, file: Path, error: type[DrakearmError]) -> None:
    """Raises `error` for a file whose format this drakearm does not know."""
    if isinstance(number, bool) or number not in range(1, NEWEST + 1):
        raise error(
            f"{shown(file)} has the format {shown(number)}, but this drakearm reads format {NEWEST}: "
            "a newer drakearm may have written it."
        )
