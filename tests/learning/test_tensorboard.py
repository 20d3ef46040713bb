"""The log for TensorBoard has the numbers of the reports."""

import pytest
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from drakearm.errors import StorageError
from drakearm.learning import train
from drakearm.learning.tensorboard import tensorboard_log
from tests.learning.test_ppo import SMALL
from tests.small_environments import Tracker, vectorize


def test_curves_are_those_of_the_reports(tmp_path):
    reports = []
    with tensorboard_log(tmp_path / "log") as log:

        def on_batch(report):
            reports.append(report)
            log(report)

        train(vectorize(Tracker), SMALL, seed=0, metadata={}, on_batch=on_batch)
    events = EventAccumulator(str(tmp_path / "log"))
    events.Reload()
    for name in ("tracking_error", "approx_kl", "std"):
        points = events.Scalars(name)
        assert [point.step for point in points] == [report.steps for report in reports]
        assert [point.value for point in points] == pytest.approx([getattr(r, name) for r in reports], rel=1e-6)
    assert "batches" not in events.Tags()["scalars"]


def test_a_folder_that_cannot_be_made_is_an_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StorageError, match="file"), tensorboard_log(tmp_path / "file" / "log"):
        pass
