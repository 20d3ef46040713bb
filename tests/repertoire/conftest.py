"""Fixtures of the tests of repertoires."""

import pytest
import yaml

from drakearm.repertoire.repertoire import repertoire_files


@pytest.fixture(scope="session")
def small(tmp_path_factory):
    """A file like `reaching`, with two movements and one batch."""
    fields = yaml.safe_load(repertoire_files()["reaching"].read_text())
    fields["name"] = "small"
    postures = [[-30, 0], [60, 90]]
    source = {"type": "reaches", "start_deg": postures, "target_deg": postures, "duration": [0.4, 0.5]}
    fields["movements"] = {"count": 2, "source": source}
    fields["training"] = {"batches": 1, "environments": 4, "minibatches": 2, "imitation_rounds": 1}
    file = tmp_path_factory.mktemp("repertoire") / "small.yaml"
    file.write_text(yaml.safe_dump(fields))
    return file
