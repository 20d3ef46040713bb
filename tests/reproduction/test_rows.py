"""The values of a table: means, spreads within and between seeds, and shares."""

import pytest

from drakearm.reproduction.rows import Share, Spread


def test_spread_tells_runs_and_seeds_apart():
    spread = Spread([[1.0, 3.0], [5.0, 7.0]], digits=1)
    assert str(spread) == "4.0 ± 2.2 (seeds ± 2.0)"
    assert spread.content == pytest.approx(
        {"mean": 4.0, "standard_deviation": 5**0.5, "between_seeds": 2.0, "minimum": 1.0, "maximum": 7.0}
        | {"runs": 4, "seeds": 2}
    )


def test_spread_says_no_more_than_was_measured():
    assert str(Spread([[0.25]], 2)) == "0.25"
    assert str(Spread([[1.0, 2.0]], 1)) == "1.5 ± 0.5"
    assert str(Spread([[1.0], [2.0]], 1)) == "1.5 ± 0.5"


def test_share_counts_over_seeds():
    share = Share([[True, False], [True, True]])
    assert str(share) == "3 of 4 (75%)"
    assert share.content == {"having": 3, "runs": 4, "seeds": 2}
