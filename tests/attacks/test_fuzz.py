"""The attack with malformed files, in short; and that the attack would notice what is wrong."""

import os
import time
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from drakearm.errors import ArmError
from tests.attacks.fuzz import choose_cases, is_finite, run
from tests.attacks.mutations import mutate_bytes, mutate_json, mutate_xml, mutate_yaml
from tests.attacks.targets import Target

SEED = 3


@pytest.mark.slow
@pytest.mark.extra
def test_every_malformed_file_is_accepted_or_refused_in_one_sentence():
    rows = run(choose_cases(200, SEED), jobs=2)
    assert [other for row in rows.values() for other in row.others] == []
    for name, row in rows.items():  # mutations are neither harmless nor hopeless
        assert row.tried < 10 or (row.accepted > 0 and row.refused > 0), name


def _refuse(folder):
    raise ArmError("no arm")


def _answer_with_two_lines(folder):
    error = ArmError("")
    error.args = ("first\nsecond",)
    raise error


def _answer_at_length(folder):
    error = ArmError("")
    error.args = ("x" * 301,)
    raise error


def _exit(folder):
    raise SystemExit(1)


def _crash(folder):
    os.abort()


def _hang(folder):
    time.sleep(1000.0)


ANSWERS = {
    "good": lambda folder: {"q": np.zeros(3), "name": "x"},
    "refused": _refuse,
    "raw": lambda folder: [][1],
    "nan": lambda folder: [{"q": np.array([0.0, np.nan])}],
    "lines": _answer_with_two_lines,
    "long": _answer_at_length,
    "exit": _exit,
    "crash": _crash,
    "hang": _hang,
}


def targets() -> dict[str, Target]:
    """Types of files whose use goes wrong in a certain way, after the first time, when workers get ready."""

    def use(answer: Callable[[Path], Any]) -> Callable[[Path], Any]:
        return lambda folder: answer(folder) if folder.name == "case" else None

    return {name: Target(name, "file", use(answer), 1.0) for name, answer in ANSWERS.items()}


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    seeds = tmp_path_factory.mktemp("seeds")
    (seeds / "file").write_text("content")
    cases = [(name, 0) for name in (*ANSWERS, "good", "refused")]
    return run(cases, jobs=2, source="tests.attacks.test_fuzz", longest=3.0, seeds=seeds)


def test_every_case_is_counted_even_if_a_process_dies(rows):
    assert set(rows) == set(ANSWERS)
    for row in rows.values():
        assert row.tried == row.accepted + row.refused + len(row.others)
    assert rows["good"].accepted == 2 and rows["refused"].refused == 2


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("raw", "raw:0: IndexError: 'list index out of range' in test_fuzz.py"),
        ("nan", "nan:0: a result that is not finite"),
        ("lines", "lines:0: no sentence of 300 characters: 'first"),
        ("long", "long:0: no sentence of 300 characters: 'xxx"),
        ("exit", "exit:0: SystemExit: '1'"),
        ("crash", "crash:0: the process ended with exit code -6"),
        ("hang", "hang:0: no end after 3 s"),
    ],
)
def test_what_is_wrong_is_noticed(rows, name, what):
    (other,) = rows[name].others
    assert other.startswith(what)


def test_a_result_is_finite_if_all_its_numbers_are():
    assert is_finite({"a": [1, 2.0, (np.ones(3), None, "nan")]})
    for value in (np.nan, np.inf, np.array([1.0, np.nan]), [{"a": np.float64(np.inf)}]):
        assert not is_finite(value)


@pytest.mark.parametrize(
    ("mutate", "data"),
    [
        (mutate_bytes, b"some text"),
        (mutate_json, b'{"a": [1, {"b": 2.0}]}'),
        (mutate_yaml, b"a: [1, {b: 2.0}]"),
        (mutate_xml, b'<robot name="r"><link name="a"/></robot>'),
    ],
)
def test_the_same_number_gives_the_same_mutation(mutate, data):
    mutated = [mutate(Random(seed), data) for seed in range(50)]
    assert mutated == [mutate(Random(seed), data) for seed in range(50)]
    assert len(set(mutated)) > 20


def test_cases_of_all_types_are_tried_in_turn():
    cases = choose_cases(100, 2)
    assert len(cases) == len(set(cases)) and 95 <= len(cases) <= 105
    assert len({name for name, _ in cases[:10]}) == 10
    assert all(number >= 2_000_000 for _, number in cases)
