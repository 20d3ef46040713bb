"""Reads an arm from its folder: `muscles.yaml` and the skeleton file that it names."""

from pathlib import Path
from typing import Any

import yaml
from pydantic import TypeAdapter, ValidationError

from drakearm.errors import ArmError, did_you_mean
from drakearm.model.arm import Arm

_SHIPPED = Path(__file__).parent


def load_arm(arm: str | Path = "arm14") -> Arm:
    """Loads an arm that drakearm ships, by its name ("arm14"), or from a folder with a muscles.yaml of the same form.

    Raises ArmError, which names file and field, for a missing file, a missing or unknown field, a value out of range, a
    muscle given twice, or a path that depends on a coordinate that the arm does not have.
    """
    folder = arm_folder(arm)
    file = folder / "muscles.yaml"
    fields = _merge_defaults(_read(file), file)
    fields["skeleton"] = folder.resolve() / str(fields.get("skeleton", ""))
    try:
        loaded = TypeAdapter(Arm).validate_python(fields)
    except ValidationError as error:
        raise ArmError(_describe(error, file, fields)) from error
    if not loaded.skeleton.is_file():
        raise ArmError(f"{file}: skeleton: there is no file {loaded.skeleton}.")
    return loaded


def arm_folder(arm: str | Path) -> Path:
    """The folder of a shipped arm, by its name, or the given folder. Raises ArmError if it has no muscles.yaml."""
    shipped = {path.parent.name: path.parent for path in _SHIPPED.glob("*/muscles.yaml")}
    folder = shipped.get(str(arm), Path(arm))
    if not (folder / "muscles.yaml").is_file():
        raise ArmError(
            f"There is no arm {str(arm)!r}{did_you_mean(str(arm), shipped)}: "
            f"expected one of {', '.join(sorted(shipped))} or a folder with a muscles.yaml."
        )
    return folder


def _read(file: Path) -> dict[str, Any]:
    try:
        fields = yaml.safe_load(file.read_text())
    except yaml.YAMLError as error:
        raise ArmError(f"{file} is not valid YAML: {error}") from error
    if not isinstance(fields, dict):
        raise ArmError(f"{file}: expected fields with values, found {type(fields).__name__}.")
    return fields


def _merge_defaults(fields: dict[str, Any], file: Path) -> dict[str, Any]:
    """Gives each muscle the values of the section `defaults` for the fields that it does not have."""
    defaults = fields.pop("defaults", {}) or {}
    muscles = fields.get("muscles")
    if not isinstance(defaults, dict):
        raise ArmError(f"{file}: defaults: expected fields of a muscle with their values.")
    if isinstance(muscles, list):
        fields["muscles"] = [{**defaults, **m} if isinstance(m, dict) else m for m in muscles]
    return fields


def _describe(error: ValidationError, file: Path, fields: dict[str, Any]) -> str:
    """One sentence per problem: where it is (with the muscle's name), what is wrong, what was expected."""
    lines = []
    for problem in error.errors():
        where: list[str] = []
        value: Any = fields
        for key in problem["loc"]:
            try:
                value = value[key]
            except (KeyError, IndexError, TypeError):  # this is the missing field
                value = None
            named = isinstance(key, int) and isinstance(value, dict) and "name" in value
            where.append(str(value["name"] if named else key))
        message = problem["msg"].removeprefix("Value error, ")
        given = f" (found {value!r})" if isinstance(value, int | float | str) else ""
        lines.append(f"{file}: {'.'.join(where)}: {message}{given}.")
    return "\n".join(lines)
