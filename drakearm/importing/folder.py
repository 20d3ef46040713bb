"""Writes an imported limb as a folder like that of arm14."""

from pathlib import Path
from typing import Any

import yaml

from drakearm.errors import ArmError, ImportingError, StorageError, shown
from drakearm.files import replacement
from drakearm.importing.limb import GRIP, TIP, ImportedLimb
from drakearm.importing.report import write_report
from drakearm.importing.urdf import write_urdf
from drakearm.model import Muscle, load_arm
from drakearm.model.skeleton_file import check_skeleton

_HEADER = "# Imported from the model {model}, with {program}. See CREDITS.md and report.md. Units: m, N, s, rad.\n\n"
_SEQUENCE, _MAPPING = "tag:yaml.org,2002:seq", "tag:yaml.org,2002:map"


def write_limb(limb: ImportedLimb, folder: Path, overwrite: bool = False) -> None:
    """Writes muscles.yaml, skeleton.urdf, CREDITS.md and report.md, and checks that drakearm can load them.

    Raises StorageError if the folder has one of them and they are not to be overwritten, and ImportingError for a limb
    that drakearm cannot load.
    """
    name = folder.resolve().name
    texts = {
        "muscles.yaml": _muscles(limb, name),
        "skeleton.urdf": write_urdf(name, limb.links, limb.selection.limits, limb.frames),
        "CREDITS.md": _credits(limb, name),
        "report.md": write_report(limb, name),
    }
    for file in texts:
        if (folder / file).exists() and not overwrite:
            raise StorageError(
                f"{shown(folder / file)} exists already: choose another folder with --out, or replace it with "
                "--overwrite."
            )
    for file, text in texts.items():
        with replacement(folder / file) as partial:
            partial.write_text(text)
    try:
        check_skeleton(load_arm(folder))
    except ArmError as error:
        raise ImportingError(f"The imported limb cannot be used: {error}") from error


def _muscles(limb: ImportedLimb, name: str) -> str:
    order = [key for key in Muscle.__dataclass_fields__ if key in limb.muscles[0].fields]
    fields = [{key: _rounded(muscle.fields[key]) for key in order} for muscle in limb.muscles]
    shared = {key: value for key, value in fields[0].items() if all(other[key] == value for other in fields)}
    paths = {fit.muscle: [term.fields() for term in fit.terms] for fit in limb.fits}
    content: dict[str, Any] = {
        "name": name,
        "skeleton": "skeleton.urdf",
        "gravity": [_rounded(g) for g in limb.model.gravity.tolist()],
        "coordinates": list(limb.selection.limits),
        "load_frame": GRIP,
        "tip_frame": TIP,
        "defaults": shared,
        "muscles": [
            {
                "name": muscle.name,
                **{key: value for key, value in own.items() if key not in shared},
                "path": paths[muscle.name],
                "points": [[body, [round(x, 9) + 0.0 for x in point]] for body, point in muscle.points],
            }
            for muscle, own in zip(limb.muscles, fields, strict=True)
        ],
    }
    text = yaml.dump(content, Dumper=_Dumper, sort_keys=False, width=120, allow_unicode=True)
    return _HEADER.format(model=limb.model.name, program=limb.model.program) + text


class _Dumper(yaml.SafeDumper):
    """Writes mappings and points over several lines, and lists of numbers and names in one."""


def _list(dumper: _Dumper, items: list[Any]) -> yaml.Node:
    over_lines = any(isinstance(i, dict) or (isinstance(i, list) and i and isinstance(i[0], str)) for i in items)
    return dumper.represent_sequence(_SEQUENCE, items, flow_style=not over_lines)


_Dumper.add_representer(list, _list)
_Dumper.add_representer(dict, lambda dumper, items: dumper.represent_mapping(_MAPPING, items.items(), flow_style=False))


def _rounded(value: Any) -> Any:
    return float(f"{value:.12g}") if isinstance(value, float) else value


def _credits(limb: ImportedLimb, name: str) -> str:
    said = limb.model.credits or "The file does not say who made it: please add it here."
    return (
        f"# Where {name} comes from\n"
        f"It was imported by drakearm, with {limb.model.program}, from the model `{limb.model.name}`. Bodies, joints "
        "and muscles are those of the model. Muscle paths were replaced by splines, and bones by simple shapes. "
        f"report.md has more.\n\nThe file says:\n\n{said}\n"
    )
