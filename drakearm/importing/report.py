"""What the user should know about an imported limb: how close the paths are, and what was not kept."""

import math
from collections import defaultdict
from collections.abc import Iterator

from drakearm.importing.limb import GRIP, TIP, ImportedLimb
from drakearm.importing.source import SourceMuscle
from drakearm.model.path_fit import PathFit


def error_rows(fits: tuple[PathFit, ...]) -> Iterator[tuple[str, ...]]:
    """Rows of text: muscle, largest and median error of the length, coordinate, the same of its moment arm; in mm."""
    for fit in fits:
        name, length = fit.muscle, tuple(f"{1e3 * e:.3f}" for e in fit.length_error)
        for coordinate, error in fit.moment_arm_error.items():
            yield (name, *length, coordinate, *(f"{1e3 * e:.3f}" for e in error))
            name, length = "", ("", "")


def jump_sentences(limb: ImportedLimb) -> list[str]:
    """One sentence per muscle and coordinate with jumps."""
    names = list(limb.selection.limits)
    sentences = []
    for fit in limb.fits:
        jumps = defaultdict(list)
        for jump in fit.jumps:
            jumps[names[jump.coordinate]].append(f"{1e3 * jump.size:+.1f} mm at {math.degrees(jump.angle):.1f}")
        for name, texts in jumps.items():
            sentences.append(f"{fit.muscle} jumps by {', '.join(texts)} degrees of {name}")
    return sentences


def parameter_notes(muscles: tuple[SourceMuscle, ...]) -> list[str]:
    """What the muscles do not keep, each with the muscles that it concerns."""
    concerned = defaultdict(list)
    for muscle in muscles:
        for note in muscle.notes:
            concerned[note].append(muscle.name)
    everyone = [muscle.name for muscle in muscles]
    return [f"{'all muscles' if who == everyone else ', '.join(who)}: {note}" for note, who in concerned.items()]


def frame_sentence(limb: ImportedLimb) -> str:
    (body, center), (_, point) = limb.frames[GRIP], limb.frames[TIP]
    place = ", ".join(f"{round(float(x), 6) + 0.0:g}" for x in point)
    same = (center == point).all()
    return (
        f"loads hang at the mass center of {body} (frame {GRIP}); the planned point is "
        + ("the same" if same else f"({place}) m in the frame of {body}")
        + f" (frame {TIP})"
    )


def what_to_know(limb: ImportedLimb) -> list[str]:
    """Sentences, without full stops, about what is not as in the model."""
    lost = [f"not kept: {note}" for note in parameter_notes(limb.muscles)]
    return [*jump_sentences(limb), *limb.notes, *lost, frame_sentence(limb)]


def write_report(limb: ImportedLimb, name: str) -> str:
    """The text of report.md."""
    model = limb.model
    lines = [
        f"# How {name} was imported",
        "",
        f"From the model `{model.name}`, with {model.program}: {len(limb.selection.limits)} coordinates, "
        f"{len(limb.muscles)} muscles.",
        "",
        "## Paths",
        f"Differences between the fitted paths and those of {model.program} at 500 random postures of the whole joint "
        "range, in mm. The moment arm is minus the slope of the fitted length.",
        "",
        "| muscle | length: largest | median | coordinate | moment arm: largest | median |",
        "|---|---|---|---|---|---|",
        *("| " + " | ".join(row) + " |" for row in error_rows(limb.fits)),
        "",
    ]
    if jump_sentences(limb):
        lines += [
            "Lengths that jump are faults of the wrapping. There the fit follows the moment arms and is smooth. Its "
            "length is right near the default posture. The jumps below were found on one line through the range of "
            "each coordinate.",
            "",
        ]
    lines += ["## What to know", "", *(f"- {sentence}" for sentence in what_to_know(limb))]
    return "\n".join(lines) + "\n"
