"""One policy for several runs: the same seed gives the same one, and runs that do not fit together are refused."""

import shutil

import numpy as np
import pytest
import yaml

from drakearm.errors import RunFolderError, TaskError, TrainingError
from drakearm.experiments import EnvKind, Preset, RunFolder, evaluate_step, plan_step, scenario_files, train_step
from drakearm.experiments.environments import make_training_envs
from drakearm.experiments.provenance import fingerprint
from drakearm.experiments.sharing import shared_tasks
from drakearm.learning import Policy
from drakearm.model import load_arm

TRAINING = {"batches": 3, "environments": 4, "minibatches": 2, "epochs": 2, "imitation_rounds": 1}
NAMES = ("bend", "raise")
POSTURES = ([0, 90], [40, 20])  # degrees


def scenario(folder, name, target_deg, **changed):
    """A scenario that is quick to plan and to train."""
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    fields["movement"] |= {"knots": 15, "target_deg": target_deg, "costs": [{"type": "torque_rate", "weight": 0.1}]}
    file = folder / f"{name}.yaml"
    file.write_text(yaml.safe_dump({**fields, "name": name, "training": TRAINING, **changed}))
    return file


@pytest.fixture(scope="module")
def planned(tmp_path_factory):
    """A folder with the runs of two movements, which are planned."""
    folder = tmp_path_factory.mktemp("planned")
    for name, posture in zip(NAMES, POSTURES, strict=True):
        plan_step(RunFolder(folder / name), scenario(folder, name, posture))
    return folder


def copies(planned, folder):
    return [RunFolder(shutil.copytree(planned / name, folder / name)) for name in NAMES]


@pytest.fixture
def runs(planned, tmp_path):
    return copies(planned, tmp_path)


@pytest.fixture(scope="module")
def learned(planned, tmp_path_factory):
    """The runs with one policy for both."""
    runs = copies(planned, tmp_path_factory.mktemp("learned"))
    train_step(runs, seed=3)
    return runs


def policy_of(run):
    return run.path("policy").read_bytes()


def stop_after(batch):
    def stop(report):
        if report.batch == batch:
            raise KeyboardInterrupt

    return stop


def test_each_run_has_the_policy_and_a_record_of_all(learned):
    assert policy_of(learned[0]) == policy_of(learned[1])
    expected = [{"name": run.scenario().name, "reference": fingerprint(run.path("reference"))} for run in learned]
    for run in learned:
        training = run.read_json("training", "train")
        assert training["scenarios"] == expected and training["seed"] == 3 and training["finished"]
        assert not run.path("checkpoint").exists()
    assert Policy.load(learned[0].path("policy")).metadata["scenario"] == "bend, raise"


def test_each_run_is_evaluated_by_itself(learned):
    for run in learned:
        assert evaluate_step(run)["scenario"] == run.scenario().name


def test_the_same_seed_gives_the_same_policy(learned, runs):
    train_step(runs, seed=3)
    assert policy_of(runs[0]) == policy_of(learned[0])
    train_step(runs, seed=4)
    assert policy_of(runs[0]) != policy_of(learned[0])


def test_it_is_another_policy_than_that_of_one_movement(learned, runs):
    train_step(runs[0], seed=3)
    assert policy_of(runs[0]) != policy_of(learned[0])


def test_a_stopped_training_is_continued(learned, runs):
    with pytest.raises(KeyboardInterrupt):
        train_step(runs, seed=3, on_batch=stop_after(2))
    assert [run.path("checkpoint").exists() for run in runs] == [True, False]
    train_step(runs, seed=3, resume=True)
    assert [policy_of(run) for run in runs] == [policy_of(run) for run in learned]
    assert not runs[0].path("checkpoint").exists()
    before = runs[1].path("training").read_bytes()
    train_step(runs, seed=3, resume=True)  # it is finished
    assert runs[1].path("training").read_bytes() == before


def test_a_run_that_was_planned_again_in_the_same_way_gets_the_policy(learned, runs):
    train_step(runs, seed=3)
    plan_step(runs[1], runs[1].path("scenario"))
    train_step(runs, seed=3, resume=True)
    assert policy_of(runs[1]) == policy_of(learned[1])


def test_another_list_of_runs_cannot_be_continued(learned):
    for other in (learned[0], learned[1], learned[::-1]):
        with pytest.raises(RunFolderError, match=r"holds a training with another list of plans \(bend, raise\)"):
            train_step(other, seed=3, resume=True)


def test_a_preset_is_that_of_all(runs):
    train_step(runs, seed=0, batches=1, preset=Preset.paper)
    assert [run.scenario().preset for run in runs] == [Preset.paper] * 2
    assert Policy.load(runs[1].path("policy")).n_observations == 28


def different(runs, folder, **changed):
    """The first run, and one of a scenario with other fields."""
    other = RunFolder(folder / "other")
    plan_step(other, scenario(folder, "other", POSTURES[1], **changed))
    return [runs[0], other]


def test_runs_that_do_not_fit_together_are_refused_by_name(runs, tmp_path):
    shipped = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())["tracking"]
    reward = shipped["reward"] | {"position": [2, 10]}
    settings = TRAINING | {"steps": 50, "gamma": 0.9}
    for error, what, changed in (
        (TaskError, "reward", {"tracking": shipped | {"reward": reward}}),
        (TaskError, "senses", {"tracking": shipped | {"observation": "paper"}}),
        (TrainingError, r"training settings \(steps, gamma\)", {"training": settings}),
    ):
        pair = different(runs, tmp_path, **changed)
        with pytest.raises(error, match=f"other differs from bend in its {what}: expected the same in all"):
            train_step(pair, seed=0)
        assert not pair[0].path("policy").exists()


def test_the_number_of_batches_may_come_from_the_caller(runs, tmp_path):
    pair = different(runs, tmp_path, training=TRAINING | {"batches": 7})
    with pytest.raises(TrainingError, match=r"\(batches\)"):
        train_step(pair, seed=0)
    train_step(pair, seed=0, batches=1)


def test_arms_are_compared_by_their_files(tmp_path):
    arm = shutil.copytree(load_arm("arm14").skeleton.parent, tmp_path / "limb")
    runs = [RunFolder(tmp_path / "runs" / name) for name in NAMES]
    for run, posture in zip(runs, POSTURES, strict=True):
        plan_step(run, scenario(tmp_path, run.folder.name, posture, arm="limb"))
    train_step(runs, seed=0, batches=1)  # each run has its own copy of the arm
    muscles = arm / "muscles.yaml"
    muscles.write_text(muscles.read_text() + "\n# changed\n")
    plan_step(runs[1], tmp_path / "raise.yaml")
    with pytest.raises(TaskError, match="raise differs from bend in its arm"):
        train_step(runs, seed=0)


def test_without_a_run_there_is_nothing_to_train():
    with pytest.raises(TrainingError, match="expected at least one"):
        train_step([], seed=0)


def test_diagrams_get_the_movements_in_turn_as_compiled_arms_do(runs):
    tasks = shared_tasks(runs, [run.scenario() for run in runs])
    assert len(tasks) == 2
    first = []
    for kind in EnvKind:
        envs = make_training_envs(tasks, 3, kind)
        first.append(envs.reset(seed=0)[0])
        envs.close()
    np.testing.assert_allclose(first[0], first[1], rtol=1e-6, atol=1e-7)
    assert np.abs(first[0][0] - first[0][1]).max() > 1e-3
    with pytest.raises(TrainingError, match="There are 2 tasks for 1 Diagrams"):
        make_training_envs(tasks, 1, EnvKind.diagram)
