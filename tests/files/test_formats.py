"""Formats of files: the newest and those without a number are read, and unknown ones are refused by name."""

import json

import numpy as np
import pytest

from drakearm.errors import ArmError, RunFolderError, ScenarioError
from drakearm.experiments import load_scenario, scenario_files
from drakearm.files import read_json, read_yaml
from drakearm.files.formats import NEWEST
from drakearm.model.reference import CONTROL_STEP, Reference

UNKNOWN = [NEWEST + 1, 0, -1, 1.5, True, "1", None, [1]]


def refused(number) -> str:
    return rf"has the format .*, but this drakearm reads format {NEWEST}: a newer drakearm may have written it"


@pytest.fixture
def reference() -> Reference:
    return Reference(CONTROL_STEP * np.arange(3), *np.zeros((4, 3, 2)))


def test_a_scenario_may_name_its_format(tmp_path):
    shipped = scenario_files()["reach-000"]
    file = tmp_path / "mine.yaml"
    file.write_text(f"format: {NEWEST}\n{shipped.read_text()}")
    assert load_scenario(file) == load_scenario(shipped)
    file.write_text(f"format: {NEWEST + 1}\n{shipped.read_text()}")
    with pytest.raises(ScenarioError, match=refused(NEWEST + 1)):
        load_scenario(file)


@pytest.mark.parametrize("number", UNKNOWN)
@pytest.mark.parametrize("read", [read_yaml, read_json])
def test_other_formats_are_refused(tmp_path, number, read):
    file = tmp_path / "file"
    file.write_text(json.dumps({"format": number, "a": 1}))  # JSON is YAML as well
    with pytest.raises(ArmError, match=refused(number)):
        read(file, ArmError)


def test_arrays_carry_their_format_and_do_not_need_it(tmp_path, reference):
    file = tmp_path / "reference.npz"
    reference.save(file)
    arrays = dict(np.load(file))
    assert arrays["format"] == NEWEST
    del arrays["format"]
    np.savez(file, **arrays)
    np.testing.assert_array_equal(Reference.load(file).q, reference.q)


@pytest.mark.parametrize("number", [NEWEST + 1, 0, 1.5, np.nan, [1, 1]])
def test_arrays_of_other_formats_are_refused_whatever_they_hold(tmp_path, reference, number):
    file = tmp_path / "reference.npz"
    np.savez(file, format=number, new=np.zeros(3))
    with pytest.raises(RunFolderError, match=refused(number)):
        Reference.load(file)
