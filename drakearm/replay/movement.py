"""What a replay shows: a recorded movement with its arm, load, obstacle and caption."""

import html
from collections.abc import Sequence
from dataclasses import dataclass, field

from drakearm.model import Arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.recording import Recording


@dataclass(frozen=True)
class Caption:
    """What stands above a replay: what moves, how well, and a verdict: green, or red if the movement failed."""

    title: str
    lines: Sequence[str] = ()
    verdict: str = ""
    failed: bool = False

    @property
    def html(self) -> str:
        lines = [f"<h1>{html.escape(self.title)}</h1>", *(f"<p>{html.escape(line)}</p>" for line in self.lines)]
        if self.verdict:
            lines.append(f'<p class="{"bad" if self.failed else "good"}">{html.escape(self.verdict)}</p>')
        return "".join(lines)


@dataclass(frozen=True)
class RecordedMovement:
    """A recording, and what a replay shows beside it. load_mass: kg, in the hand."""

    arm: Arm
    recording: Recording
    load_mass: float = 0.0
    obstacle: Obstacle | None = None
    caption: Caption = field(default_factory=lambda: Caption("drakearm replay"))


def duration(recording: Recording) -> float:
    """How long a recording is, s."""
    return float(recording.t[-1] - recording.t[0])
