"""A reproduction ends with the same results wherever its trials run, and does nothing twice."""

import os
import sys

import pytest

from drakearm.errors import RunFolderError, SweepError
from drakearm.reproduction.choices import Backend
from drakearm.reproduction.reproduction import reproduce
from drakearm.reproduction.trial import Method, Trial
from drakearm.reproduction.trial_folder import TrialFolder
from tests.reproduction.small import Small, results, write_scenario

STATIC = (Method.static,)


@pytest.fixture(scope="module")
def scenario(tmp_path_factory):
    return write_scenario(tmp_path_factory.mktemp("scenario") / "small.yaml")


def reproduced(folder, *files, methods=STATIC, **options):
    return reproduce([Small(*files, methods=methods)], folder, command="drakearm reproduce small", jobs=1, **options)


@pytest.fixture(scope="module")
def static(scenario, tmp_path_factory):
    """The folder of a reproduction by static optimization."""
    folder = tmp_path_factory.mktemp("static")
    assert reproduced(folder, scenario).completed == 1
    return folder


def times(folder):
    """When each file of the trials was written."""
    return {file: file.stat().st_mtime_ns for file in (folder / "trials").rglob("*")}


def test_what_is_finished_is_not_done_again(static, scenario):
    before, expected = times(static), results(static)
    again = reproduced(static, scenario)
    assert (again.earlier, again.completed) == (1, 0)
    assert times(static) == before and results(static) == expected


def test_an_outcome_has_all_runs(static, scenario):
    (outcome,) = reproduced(static, scenario).outcomes
    assert len(outcome.noisy) == 10 and len(outcome.perturbed) == 12 and outcome.learning_curve is None
    assert outcome.seconds["plan"] > 0.0 and outcome.seconds["evaluate"] > 0.0
    assert {run.q.shape for run in (outcome.noise_free, *outcome.noisy, *outcome.perturbed)} == {(36, 2)}
    assert len({run.q[0, 0] for run in (*outcome.noisy, *outcome.perturbed)}) == 22  # each from another start
    assert outcome.feasibility.feasible


def test_a_trial_that_fails_does_not_stop_the_others(static, scenario):
    made = reproduced(static, scenario, methods=(Method.static, Method.default), batches=2_000_000)
    ((failed, problem),) = made.failures.items()
    assert failed.method is Method.default and "batches" in problem
    assert [outcome.trial.method for outcome in made.outcomes] == [Method.static]
    assert "static optimization" in made.report.read_text()
    missing = reproduced(static, static / "none.yaml")
    assert "no scenario" in "".join(missing.failures.values()) and missing.report is None


def test_another_scenario_is_refused_or_overwritten(scenario, tmp_path):
    file = tmp_path / "small.yaml"
    file.write_text(scenario.read_text())
    reproduced(tmp_path, file)
    file.write_text(scenario.read_text().replace("- 40\n", "- 41\n"))
    before = times(tmp_path)
    with pytest.raises(RunFolderError, match="static/seed-0 was made from another scenario file or arm: choose"):
        reproduced(tmp_path, file)
    assert times(tmp_path) == before
    made = reproduced(tmp_path, file, overwrite=True)
    assert made.outcomes[0].task.reference.q[-1, 1] == pytest.approx(0.7156, abs=1e-4)  # 41 degrees


def test_a_missing_backend_is_named(scenario, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)  # Python then finds no such module
    with pytest.raises(SweepError, match=r"--backend ray needs the package ray.*pip install drakearm\[cluster-ray\]"):
        reproduced(tmp_path, scenario, backend=Backend.ray)


class Note:
    """Called in a worker, it leaves a file with the number of the worker's process."""

    def __init__(self, folder):
        self.folder = folder

    def __call__(self):
        self.folder.mkdir(exist_ok=True)
        (self.folder / str(os.getpid())).touch()


def on_cluster(backend, static, scenario, folder):
    """Reproduces the same on a cluster, with two jobs. Returns the numbers of the processes that did it."""
    second = folder / "second.yaml"
    second.write_text(scenario.read_text().replace("name: small", "name: second"))
    experiment = Small(scenario, second, methods=STATIC)
    made = reproduce([experiment], folder, command="", jobs=2, backend=backend, prepare=Note(folder / "noted"))
    assert not made.failures and made.completed == 2
    first, expected = made.outcomes[0], reproduced(static, scenario).outcomes[0]
    assert first.metrics["noisy"] == expected.metrics["noisy"]
    return {int(file.name) for file in (folder / "noted").iterdir()}


@pytest.mark.slow
@pytest.mark.extra
def test_dask_cluster(static, scenario, tmp_path):
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        numbers = set(client.run(os.getpid).values())
        assert len(numbers) == 2
        assert on_cluster(Backend.dask, static, scenario, tmp_path) <= numbers


@pytest.mark.slow
@pytest.mark.extra
def test_ray_cluster(static, scenario, tmp_path):
    ray = pytest.importorskip("ray")
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        numbers = on_cluster(Backend.ray, static, scenario, tmp_path)
        assert numbers and os.getpid() not in numbers
    finally:
        ray.shutdown()


def test_imitation_counts_as_work(scenario, tmp_path):
    """It takes most of the time of a training with few batches."""
    one, two = (TrialFolder(tmp_path, Trial(str(scenario), Method.default, 0), batches) for batches in (1, 2))
    learned_nothing = TrialFolder(tmp_path, Trial(str(scenario), Method.static, 0))
    assert one.work - learned_nothing.work > 10 * (two.work - one.work) > 0.0
