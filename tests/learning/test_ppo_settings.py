"""The settings of PPO can be read from plain data, and wrong ones are refused."""

import math

import pytest
from pydantic import TypeAdapter, ValidationError

from drakearm.learning import PpoSettings


def test_settings_come_from_plain_data():
    read = TypeAdapter(PpoSettings).validate_python
    assert read({"batches": 7, "actor_layers": [8, 8]}) == PpoSettings(batches=7, actor_layers=(8, 8))
    for wrong in (
        {"batch": 7},
        {"steps": 0},
        {"gamma": 1.5},
        {"learning_rate": math.inf},
        {"critic_layers": [64, 0]},
    ):
        with pytest.raises(ValidationError, match=next(iter(wrong))):
            read(wrong)
