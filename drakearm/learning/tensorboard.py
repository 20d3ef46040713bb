"""The progress of a training for TensorBoard, beside its CSV log."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Protocol

from drakearm.errors import TrainingError
from drakearm.files.writing import storage
from drakearm.learning.batch_report import BatchReport

_NOT_DRAWN = ("batch", "batches", "steps", "seconds_left")


class Log(Protocol):
    def __call__(self, report: BatchReport) -> None:
        """Writes the numbers of a batch."""


@contextmanager
def tensorboard_log(folder: Path) -> Iterator[Log]:
    """A function for `on_batch` of `train`, which writes event files into a folder; closed after the `with` block.

    Each field of BatchReport is a curve over the steps. `tensorboard --logdir FOLDER` shows them. Raises TrainingError
    if TensorBoard is not installed, StorageError if the folder cannot be written.
    """
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ImportError as error:
        raise TrainingError("TensorBoard is not installed: expected `pip install tensorboard`.") from error
    with storage(folder):
        folder.mkdir(parents=True, exist_ok=True)
        writer = SummaryWriter(str(folder))

    def write(report: BatchReport) -> None:
        with storage(folder):
            for name, value in asdict(report).items():
                if name not in _NOT_DRAWN:
                    writer.add_scalar(name, value, report.steps)
            writer.flush()

    try:
        yield write
    finally:
        writer.close()
