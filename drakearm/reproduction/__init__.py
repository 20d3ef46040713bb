"""The paper's experiments: the trials that they consist of, and the tables, figures and report of the outcomes.

Each name is imported when it is first used.
"""

from typing import TYPE_CHECKING

from drakearm.lazy import lazy_attributes

__all__ = [
    "EXPERIMENTS",
    "Experiment",
    "Method",
    "Outcome",
    "Reproduction",
    "Row",
    "Share",
    "Spread",
    "Table",
    "Trial",
    "Value",
    "noisy",
    "reproduce",
    "shares",
    "spreads",
    "write_report",
]

if TYPE_CHECKING:
    from drakearm.reproduction.catalog import EXPERIMENTS
    from drakearm.reproduction.experiment import Experiment, noisy, shares, spreads
    from drakearm.reproduction.page import Table
    from drakearm.reproduction.report import write_report
    from drakearm.reproduction.reproduction import Reproduction, reproduce
    from drakearm.reproduction.rows import Row, Share, Spread, Value
    from drakearm.reproduction.trial import Method, Outcome, Trial
else:
    __getattr__, __dir__ = lazy_attributes(
        __name__,
        {
            "drakearm.reproduction.catalog": ("EXPERIMENTS",),
            "drakearm.reproduction.experiment": ("Experiment", "noisy", "shares", "spreads"),
            "drakearm.reproduction.page": ("Table",),
            "drakearm.reproduction.report": ("write_report",),
            "drakearm.reproduction.reproduction": ("Reproduction", "reproduce"),
            "drakearm.reproduction.rows": ("Row", "Share", "Spread", "Value"),
            "drakearm.reproduction.trial": ("Method", "Outcome", "Trial"),
        },
    )
