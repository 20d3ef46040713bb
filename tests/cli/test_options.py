"""Options and arguments are checked before any work begins: the message says what was found and what was expected."""

import pytest

from drakearm.errors import ScenarioError
from drakearm.experiments.catalog import find_scenario
from tests.cli.command import drakearm


def refusal(*arguments):
    """The message of a usage error, in one line."""
    return " ".join(drakearm(*arguments, code=2).replace("│", " ").split())


SEED = "expected a whole number from 0 to 4294967295"
BATCHES = "expected a whole number from 1 to 1000000"
PUSH = "expected a torque, a start and a duration, such as 2,0.3,0.1"
SECONDS = "expected a number of seconds greater than 0"


@pytest.mark.parametrize(
    ("arguments", "found", "expected"),
    [
        (["train", "x", "--seed", "-1"], "'-1'", SEED),
        (["run", "x", "--seed", str(2**70)], "'1180591620717411303424'", SEED),
        (["run", "x", "--seed", "1.5"], "'1.5'", SEED),
        (["run", "x", "--seed", "9" * 5000], "'999999999999...9999999999999'", SEED),
        (["run", "x", "--batches", "0"], "'0'", BATCHES),
        (["train", "x", "--batches", "9999999999"], "'9999999999'", BATCHES),
        (["train", "x", "--batches", "many"], "'many'", BATCHES),
        (["plan", "x", "--horizon", "nan"], "'nan'", SECONDS),
        (["plan", "x", "--horizon", "inf"], "'inf'", SECONDS),
        (["plan", "x", "--horizon", "-1"], "'-1'", SECONDS),
        (["plan", "x", "--horizon", "0"], "'0'", SECONDS),
        (["plan", "x", "--horizon", "1e400"], "'1e400'", SECONDS),
        (["plan", "x", "--out", ""], "''", "expected a path"),
        (["evaluate", "x", "--out", " "], "' '", "expected a path"),
        (["evaluate", "x", "--load", "much"], "'much'", "expected a number"),
        (["evaluate", "x", "--strength", "nan"], "'nan'", "expected a number"),
        (
            ["evaluate", "x", "--push", "2,0.3"],
            "'2,0.3'",
            PUSH,
        ),
        (["evaluate", "x", "--load", "-1"], "-1.0", "expected a number greater than or equal to 0"),
        (["evaluate", "x", "--sensor-delay", "0.0105"], "0.0105", "expected a whole number of time steps of 0.001 s"),
        (["evaluate", "x", "--policy", ""], "''", "expected a path"),
        (["inspect", "x", "--out", ""], "''", "expected a path"),
        (["inspect", ""], "''", "expected a name or a path"),
        (["plan", "x", ""], "''", "expected a name or a path"),
        (["replay", ""], "''", "expected a name or a path"),
        (["plan", "x", "--import", ""], "''", "expected a name or a path"),
    ],
)
def test_a_wrong_value_is_quoted(arguments, found, expected):
    assert f"found {found}, {expected}." in refusal(*arguments)


def test_a_missing_scenario_is_a_usage_error():
    assert "Missing argument 'SCENARIO...'" in refusal("plan")


def test_the_ends_of_a_range_belong_to_it():
    for options in (["--seed", "0"], ["--seed", str(2**32 - 1)], ["--batches", "1"], ["--batches", "1000000"]):
        assert "There is no scenario" in drakearm("run", "dancing", *options, code=1)


@pytest.mark.parametrize("name", ["", "\0", "x" * 5000, "a/" * 3000, "/", "\udcff", "\x1b[31m", "x" * 300])
def test_any_name_of_a_scenario_is_one_short_sentence(name):
    with pytest.raises(ScenarioError) as refused:
        find_scenario(name)
    message = str(refused.value)
    assert message.startswith("There is no scenario") and len(message) <= 300 and message.isprintable()
