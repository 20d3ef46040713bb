"""The table of the settings of PPO on the page about learning is that of the dataclass."""

import importlib
import typing
from pathlib import Path

import pytest
from annotated_types import Ge, Gt, Le

import drakearm.task
from drakearm.files.fields import LARGEST
from drakearm.learning import PpoSettings

DOCS = Path(__file__).parents[2] / "docs"


def limits_of(annotation) -> list:
    """The limits in an annotation, also in those of its parts."""
    found = [limit for field in getattr(annotation, "__metadata__", ()) for limit in getattr(field, "metadata", [])]
    found = [limit for limit in found if isinstance(limit, Gt | Ge | Le)]
    for part in (getattr(annotation, "__origin__", None), *typing.get_args(annotation)):
        if part is not None and part is not annotation:
            found += limits_of(part)
    return found


def range_of(annotation) -> str:
    """Limits as a reader writes them; `LARGEST`, which only keeps numbers finite, is none."""
    signs = {Gt: (">", "gt"), Ge: ("≥", "ge"), Le: ("≤", "le")}
    found = [(signs[type(limit)][0], getattr(limit, signs[type(limit)][1])) for limit in limits_of(annotation)]
    shown = dict.fromkeys(f"{sign} {as_number(limit)}" for sign, limit in found if abs(limit) != LARGEST)
    if any(sign == "≥" and limit > 0 for sign, limit in found):
        shown.pop("> 0", None)
    return ", ".join(shown) or "any number"


def as_number(value: float) -> str:
    return f"{value:,.0f}".replace(",", " ") if value == int(value) else f"{value:g}"


def test_the_table_is_that_of_the_dataclass(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    meanings = importlib.import_module("class_docs").declared_fields(PpoSettings)
    hints = typing.get_type_hints(PpoSettings, include_extras=True)
    rows = [
        f"| `{name}` | {field.meaning} | {getattr(PpoSettings, name)} | {range_of(hints[name])} |"
        for name, field in meanings.items()
    ]
    assert all(field.meaning for field in meanings.values())
    assert "\n".join(rows) in (DOCS / "learning.md").read_text(), "the table should be:\n" + "\n".join(rows)


@pytest.mark.parametrize("name", ["RandomLoad", "RandomStrength", "RandomStart", "RandomDelay", "RandomMotorNoise"])
def test_every_field_of_a_randomization_has_a_meaning(name, monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    fields = importlib.import_module("class_docs").declared_fields(getattr(drakearm.task, name))
    assert fields and all(field.meaning for field in fields.values())
