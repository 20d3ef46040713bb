"""Repertoires: many movements that one policy learns, and makes on demand.

Each name is imported when it is first used: a policy makes a movement without PyTorch.
"""

from typing import TYPE_CHECKING

from drakearm.lazy import lazy_attributes

__all__ = [
    "Repertoire",
    "held_out_errors",
    "learn_repertoire",
    "load_repertoire",
    "repertoire_files",
    "shipped_policy",
]

if TYPE_CHECKING:
    from drakearm.repertoire.errors_table import held_out_errors
    from drakearm.repertoire.repertoire import Repertoire, load_repertoire, repertoire_files
    from drakearm.repertoire.shipped import shipped_policy
    from drakearm.repertoire.steps import learn_repertoire
else:
    __getattr__, __dir__ = lazy_attributes(
        __name__,
        {
            "drakearm.repertoire.errors_table": ("held_out_errors",),
            "drakearm.repertoire.repertoire": ("Repertoire", "load_repertoire", "repertoire_files"),
            "drakearm.repertoire.shipped": ("shipped_policy",),
            "drakearm.repertoire.steps": ("learn_repertoire",),
        },
    )
