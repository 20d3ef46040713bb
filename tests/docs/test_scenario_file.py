"""The scenario file on the page about planning: it is valid, and all that it has is required."""

import copy
import re
from pathlib import Path

import pytest
import yaml

from drakearm.errors import ScenarioError
from drakearm.experiments import load_scenario

PAGE = (Path(__file__).parents[2] / "docs" / "planning.md").read_text()
CONTENT = yaml.safe_load(re.search(r"```yaml\n(.*?)```", PAGE, flags=re.DOTALL).group(1))
SECTIONS = {"movement": CONTENT["movement"], "tracking": CONTENT["tracking"], "reward": CONTENT["tracking"]["reward"]}
FIELDS = [*((None, name) for name in CONTENT)]
FIELDS += [(section, name) for section, content in SECTIONS.items() for name in content]


def written(content, folder):
    file = folder / "scenario.yaml"
    file.write_text(yaml.safe_dump(content))
    return file


def test_the_file_is_a_scenario(tmp_path):
    scenario = load_scenario(written(CONTENT, tmp_path))
    assert scenario.movement.hold == 0.05 and scenario.tracking.observation == "full"


@pytest.mark.parametrize(("section", "name"), FIELDS)
def test_each_field_is_required(section, name, tmp_path):
    content = copy.deepcopy(CONTENT)
    within = {None: content, "movement": content["movement"], "tracking": content["tracking"]}
    within["reward"] = content["tracking"]["reward"]
    del within[section][name]
    with pytest.raises(ScenarioError, match=f"{name}.*missing|missing.*{name}"):
        load_scenario(written(content, tmp_path))
