"""What a user chooses by name in a scenario file or on the command line."""

from enum import StrEnum


class Preset(StrEnum):
    """Where the settings of observation and training come from that a scenario file does not give."""

    drakearm = "drakearm"
    paper = "paper"  # 28 observations, learned from random weights; overrides the file's own settings


class EnvKind(StrEnum):
    """How the arms of a training are simulated; the result is the same to rounding errors."""

    compiled = "compiled"  # all arms in one compiled call
    diagram = "diagram"  # each arm is a Drake Diagram in its own process
