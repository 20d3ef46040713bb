"""Replays of recorded movements: Meshcat scenes in one-file web pages."""

from drakearm.replay.movement import Caption, RecordedMovement
from drakearm.replay.replay import write_comparison, write_replay

__all__ = ["Caption", "RecordedMovement", "write_comparison", "write_replay"]
