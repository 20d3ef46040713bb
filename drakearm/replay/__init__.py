"""Replays of recorded movements: Meshcat scenes in one-file web pages."""

from drakearm.replay.page import Caption
from drakearm.replay.replay import write_replay

__all__ = ["Caption", "write_replay"]
