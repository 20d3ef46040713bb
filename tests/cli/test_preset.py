"""`drakearm train --preset`: another way to learn the plan that the run has, which the run remembers."""

import pytest

from drakearm.errors import RunFolderError
from drakearm.experiments import Preset, RunFolder, evaluate_step, plan_step, train_step
from drakearm.learning import PAPER, Policy
from drakearm.model.loader import arm_folder
from tests.cli.command import contents, drakearm

PAPER_SIZE, FULL_SIZE = 28, 58  # numbers of an observation
QUICK = ("--batches", 1, "--seed", 3)


@pytest.fixture(scope="module")
def learned(tiny, tmp_path_factory):
    """A run that was planned with the default and trained with the preset of the paper."""
    run = RunFolder(tmp_path_factory.mktemp("paper"))
    drakearm("plan", tiny, "--out", run.folder)
    drakearm("train", tiny, "--out", run.folder, "--preset", "paper", *QUICK)
    return run


def test_the_policy_and_its_record_are_those_of_the_preset(learned, tiny):
    training = learned.read_json("training", "train")
    assert training["preset"] == "paper" and learned.scenario().preset is Preset.paper
    assert training["settings"]["environments"] == PAPER.environments
    assert Policy.load(learned.path("policy")).n_observations == PAPER_SIZE
    assert learned.holds_plan_of(tiny, Preset.paper) and not learned.holds_plan_of(tiny)


def test_it_is_the_policy_of_a_run_that_was_planned_with_the_preset(learned, tiny, tmp_path):
    run = RunFolder(tmp_path)
    plan_step(run, tiny, preset=Preset.paper)
    drakearm("train", tiny, "--out", tmp_path, *QUICK)
    for name in ("policy", "reference", "scenario"):
        assert run.path(name).read_bytes() == learned.path(name).read_bytes(), name


def test_what_comes_later_uses_the_same_preset(learned, tiny):
    drakearm("evaluate", tiny, "--out", learned.folder)
    again = drakearm("train", tiny, "--out", learned.folder, "--resume", *QUICK)
    assert "the training is finished already" in again
    for preset in ("drakearm", None):
        chosen = ("--preset", preset) if preset else ()
        assert "exists already" in drakearm("train", tiny, "--out", learned.folder, *chosen, code=1)


def test_a_training_with_another_preset_cannot_be_continued(learned, tiny):
    other = ("train", tiny, "--out", learned.folder, "--resume", "--preset", "drakearm", *QUICK)
    assert "holds a training with another preset" in drakearm(*other, code=1)


def test_the_preset_is_changed_back(run, tiny):
    train_step(run, seed=0, batches=1, preset=Preset.paper)
    assert not run.path("metrics").exists() and run.scenario().preset is Preset.paper
    drakearm("train", tiny, "--out", run.folder, "--preset", "drakearm", "--overwrite", "--batches", 1)
    assert run.scenario().preset is Preset.drakearm
    assert Policy.load(run.path("policy")).n_observations == FULL_SIZE
    evaluate_step(run)


def test_until_the_first_batch_is_done_the_run_stays_as_it_was(run, tiny):
    before = contents(run)

    def stop(number, rounds):
        raise KeyboardInterrupt

    drakearm("train", tiny, "--out", run.folder, "--preset", "paper", "--overwrite", "--device", "abacus", code=1)
    with pytest.raises(KeyboardInterrupt):
        train_step(run, seed=1, preset=Preset.drakearm, on_round=stop)
    assert contents(run) == before


def test_a_training_without_a_preset_in_its_record_is_continued(run):
    """Older records have none: the scenario says it."""
    training = run.read_json("training", "train")
    with run.replacing("train", arm_folder("arm14")) as new:
        for name in ("policy", "training_log"):
            new.path(name).write_bytes(run.path(name).read_bytes())
        new.write_record({name: training[name] for name in ("seed", "env", "settings", "finished", "steps", "seconds")})
    assert train_step(run, seed=3, resume=True).n_observations == FULL_SIZE
    with pytest.raises(RunFolderError, match="another preset"):
        train_step(run, seed=3, resume=True, preset=Preset.paper)
