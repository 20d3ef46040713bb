"""Learning a repertoire: library, policy and errors in one folder, the same for the same seed."""

import json

import numpy as np
import pytest
import yaml

from drakearm.errors import PolicyFileError, RunFolderError, ScenarioError, TrainingError
from drakearm.files.lock import locked
from drakearm.learning import Policy
from drakearm.planning import Library
from drakearm.repertoire import held_out_errors, learn_repertoire, load_repertoire
from drakearm.repertoire import steps as module
from drakearm.repertoire.shipped import policy_and_repertoire, ship


@pytest.fixture(scope="module")
def learned(small, tmp_path_factory):
    """A folder in which the small repertoire was learned, and what was returned."""
    folder = tmp_path_factory.mktemp("learned")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "HELD_OUT", 2)
        return folder, learn_repertoire(small, folder)


def test_the_folder_has_all_that_was_learned(learned):
    folder, errors = learned
    assert sorted(file.name for file in folder.iterdir()) == sorted(module.FILES.values())
    assert json.loads((folder / "errors.json").read_text()) == json.loads(json.dumps(errors))
    policy, repertoire = policy_and_repertoire(folder / "policy.safetensors")
    tasks = repertoire.tasks(Library.load(folder / "held_out.npz"))
    assert held_out_errors(tasks, policy.act).summary() == errors["held_out"]["policy"]


def test_the_library_is_kept_and_the_seed_determines_the_policy(learned, small, tmp_path, monkeypatch):
    folder, _ = learned
    for name in ("library.npz", "held_out.npz"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    monkeypatch.setattr(module, "HELD_OUT", 2)
    monkeypatch.setattr(module, "plan_library", None)  # a call would fail
    learn_repertoire(small, tmp_path)
    assert (tmp_path / "policy.safetensors").read_bytes() == (folder / "policy.safetensors").read_bytes()


def test_a_stopped_training_is_continued(learned, small, tmp_path, monkeypatch):
    """Stopped after the first of two batches. It ends as one that was not stopped; another seed is refused."""
    folder, _ = learned
    monkeypatch.setattr(module, "HELD_OUT", 2)

    class Stopped(Exception):
        pass

    def stop(report):
        if report.batch == 1:
            raise Stopped

    for name in ("whole", "stopped"):
        (tmp_path / name).mkdir()
        for file in ("library.npz", "held_out.npz"):
            (tmp_path / name / file).write_bytes((folder / file).read_bytes())
    learn_repertoire(small, tmp_path / "whole", batches=2)
    with pytest.raises(Stopped):
        learn_repertoire(small, tmp_path / "stopped", batches=2, on_batch=stop)
    with pytest.raises(TrainingError, match="another seed"):
        learn_repertoire(small, tmp_path / "stopped", batches=2, seed=1, resume=True)
    batches = []
    learn_repertoire(small, tmp_path / "stopped", batches=2, resume=True, on_batch=batches.append)
    assert [report.batch for report in batches] == [2]
    whole, continued = (tmp_path / name / "policy.safetensors" for name in ("whole", "stopped"))
    assert whole.read_bytes() == continued.read_bytes()
    assert sorted(file.name for file in continued.parent.iterdir()) == sorted(module.FILES.values())


def test_two_processes_do_not_learn_in_one_folder(small, tmp_path):
    with locked(tmp_path), pytest.raises(RunFolderError, match="at work"):
        learn_repertoire(small, tmp_path)


def test_a_folder_with_another_repertoire_is_refused(learned):
    folder, _ = learned
    with pytest.raises(RunFolderError, match="holds another repertoire"):
        learn_repertoire("reaching", folder)


def test_what_was_learned_can_be_shipped(learned, tmp_path):
    folder, _ = learned
    place = ship(folder, tmp_path)
    assert place == tmp_path / "small"
    policy, repertoire = policy_and_repertoire(place / "policy.safetensors")
    assert repertoire.name == policy.metadata["repertoire"] == "small"


def test_static_optimization_makes_the_movements(learned):
    folder, _ = learned
    tasks = load_repertoire(folder / "repertoire.yaml").tasks(Library.load(folder / "held_out.npz"))
    errors = held_out_errors(tasks, None)
    assert errors.hand.max() < 1.0 and errors.mean.max() < 0.05
    random = held_out_errors(tasks, None, random=True, seed=1)
    assert (random.mean != errors.mean).all()
    np.testing.assert_array_equal(random.mean, held_out_errors(tasks, None, random=True, seed=1).mean)


def test_a_policy_for_one_movement_is_refused(tmp_path, learned):
    folder, _ = learned
    policy = Policy.load(folder / "policy.safetensors")
    policy.metadata = {}
    policy.save(tmp_path / "policy.safetensors")
    with pytest.raises(PolicyFileError, match="no policy for a repertoire"):
        policy_and_repertoire(tmp_path / "policy.safetensors")


def test_errors_name_file_and_field(small, tmp_path):
    fields = yaml.safe_load(small.read_text())
    fields["movements"]["source"]["duration"] = [1.0, 0.4]
    (tmp_path / "wrong.yaml").write_text(yaml.safe_dump(fields))
    with pytest.raises(ScenarioError, match=r"wrong.yaml.*duration"):
        load_repertoire(tmp_path / "wrong.yaml")
    with pytest.raises(ScenarioError, match="did you mean reaching"):
        load_repertoire("reeching")
