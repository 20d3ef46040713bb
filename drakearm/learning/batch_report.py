"""The progress of a training: a report per batch, and the log that holds them."""

import csv
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from drakearm.files.writing import storage


@dataclass(frozen=True)
class BatchReport:
    """The progress of a training after a batch: one row of the log.

    Rewards, errors and losses are those with exploration, so the policy without noise is better.
    """

    batch: int  # from 1
    batches: int  # of the whole training
    steps: int  # transitions so far, over all environments
    steps_per_second: float  # in this batch, updates included
    seconds_left: float  # if the remaining batches take as long as those so far
    mean_reward: float  # per episode: the mean sum of rewards of those that ended in this batch; nan if none did
    tracking_error: float  # rad, the mean of absolute errors over joints, steps and arms; nan if `info` has none
    approx_kl: float  # nats, between the policy that collected the batch and the updated one
    clip_fraction: float  # share of transitions whose probability ratio is outside the clip range
    explained_variance: float  # of the returns, by the critic: 1 is perfect, 0 no better than their mean
    policy_loss: float  # mean of the actor's loss over all minibatches, see `ActorLearner`
    value_loss: float  # mean squared error of the critic, in the unit of returns squared
    entropy: float  # nats
    std: float  # standard deviation of the actions, in their unit, mean over their elements


def csv_log(path: Path | None, finished: int, stack: ExitStack) -> Callable[[BatchReport], None]:
    """A function that appends a report as a row to a file; `stack` closes the file.

    finished: number of batches whose rows are kept, if the file exists already.
    """
    if path is None:
        return lambda report: None
    names = [field.name for field in fields(BatchReport)]
    with storage(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        kept = path.read_text().splitlines()[1 : 1 + finished] if finished and path.exists() else []
        file = stack.enter_context(path.open("w", newline=""))
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        file.writelines(f"{row}\r\n" for row in kept)

    def write_row(report: BatchReport) -> None:
        with storage(path):
            writer.writerow(asdict(report))
            file.flush()  # so that the rows can be read during the training and after a crash

    return write_row
