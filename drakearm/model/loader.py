"""Reads an arm from its folder: `muscles.yaml` and the skeleton file that it names."""

import os.path
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any

from pydantic import TypeAdapter, ValidationError

from drakearm.errors import ArmError, did_you_mean, shown
from drakearm.files import read_yaml
from drakearm.files.problems import file_error
from drakearm.model.arm import Arm, Muscle
from drakearm.model.limb import SLACK_LENGTH_TO_COME, Limb, complete
from drakearm.model.skeleton_file import moving_joints

_SHIPPED = Path(__file__).parent


@dataclass(frozen=True)
class _MuscleFile(Arm):
    """The fields of a muscles.yaml: those of an arm, and the values of the muscles that do not give their own."""

    defaults: Muscle | None = None


def load_arm(arm: str | Path = "arm14") -> Arm:
    """Loads an arm that drakearm ships, by its name ("arm14"), or from a folder with a muscles.yaml of the same form.

    Raises ArmError, which names file and field, for a missing file, a missing or unknown field, a value out of range, a
    muscle given twice, or a path that depends on a coordinate that the arm does not have. The skeleton file is read by
    `add_skeleton`; here it only has to exist in the folder, unless muscles.yaml leaves out what follows from it: the
    coordinates, or the path of a muscle.
    """
    return load_limb(arm).arm


def load_limb(arm: str | Path) -> Limb:
    """Loads an arm as `load_arm` does, and says what has been computed because the file leaves it out."""
    file = arm_folder(arm) / "muscles.yaml"
    content = read_yaml(file, ArmError)
    defaults = content.pop("defaults", None)
    if not isinstance(defaults, dict | None):
        raise ArmError(f"{shown(file)}: defaults: found {shown(defaults)}, expected fields of a muscle with values.")
    given = content.get("muscles")
    merged = dict(content)
    without_slack_length: list[Any] = []  # names of muscles
    if "skeleton" in content:
        merged["skeleton"] = _skeleton(file, content["skeleton"])
    if "coordinates" not in content:
        if "skeleton" not in content:
            raise ArmError(f"{shown(file)}: skeleton: is missing, but required.")
        merged["coordinates"] = moving_joints(merged["skeleton"])
    if isinstance(given, list):
        merged["muscles"] = [{**(defaults or {}), **muscle} if isinstance(muscle, dict) else muscle for muscle in given]
        for muscle in merged["muscles"]:
            if isinstance(muscle, dict) and not {"path", "tendon_slack_length"} & muscle.keys():
                without_slack_length.append(muscle.get("name"))
                muscle["tendon_slack_length"] = SLACK_LENGTH_TO_COME
    try:
        loaded = TypeAdapter(Arm).validate_python(merged)
    except ValidationError as error:
        problems = _in_defaults(error, given, defaults or {})
        raise file_error(ArmError, problems, file, {**merged, "defaults": defaults}, _MuscleFile) from error
    return complete(loaded, file, without_slack_length)


def arm_folder(arm: str | Path) -> Path:
    """The folder of a shipped arm, by its name, or the given folder. Raises ArmError if it has no muscles.yaml."""
    shipped = {path.parent.name: path.parent for path in _SHIPPED.glob("*/muscles.yaml")}
    folder = shipped.get(str(arm), Path(arm))
    if not os.path.isfile(folder / "muscles.yaml"):  # unlike Path.is_file without an exception, whatever the name is
        raise ArmError(
            f"There is no arm {shown(Path(arm))}{did_you_mean(str(arm), shipped)}: "
            f"expected one of {', '.join(sorted(shipped))} or a folder with a muscles.yaml."
        )
    return folder


def _skeleton(file: Path, name: Any) -> Path:
    """The absolute path of the skeleton file. file: the muscles.yaml that has this name of the skeleton file."""
    where = f"{shown(file)}: skeleton: "
    if not isinstance(name, str) or not name.strip():
        raise ArmError(f"{where}found {shown(name)}, expected the name of a file in the same folder.")
    if PurePath(name).is_absolute() or ".." in PurePath(name).parts:
        raise ArmError(f"{where}found {shown(name)}, expected a file in the folder of muscles.yaml or below it.")
    skeleton = file.parent.resolve() / name
    if not os.path.isfile(skeleton):
        raise ArmError(f"{where}there is no file {shown(name)} in the folder of muscles.yaml.")
    return skeleton


def _in_defaults(error: ValidationError, muscles: Any, defaults: dict[str, Any]) -> ValidationError:
    """The same problems, but a wrong value that muscles have from `defaults` is one problem there, not one per muscle.

    Problems in `defaults` come first. muscles: as in the file, without the defaults.
    """
    problems: dict[Any, Any] = {}
    for problem in error.errors():
        loc = problem["loc"]
        if loc[:1] == ("muscles",) and len(loc) > 2 and loc[2] in defaults and loc[2] not in muscles[loc[1]]:
            loc = ("defaults", *loc[2:])
        problems.setdefault((loc, problem["type"]), {**problem, "loc": loc})
    in_order = sorted(problems.values(), key=lambda problem: problem["loc"][:1] != ("defaults",))
    return ValidationError.from_exception_data(error.title, in_order)
