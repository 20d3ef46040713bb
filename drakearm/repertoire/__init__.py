"""Repertoires: many movements that one policy learns, and makes on demand."""

from drakearm.repertoire.errors_table import held_out_errors
from drakearm.repertoire.repertoire import Repertoire, load_repertoire, repertoire_files
from drakearm.repertoire.steps import learn_repertoire

__all__ = ["Repertoire", "held_out_errors", "learn_repertoire", "load_repertoire", "repertoire_files"]
