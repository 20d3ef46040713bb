"""Compiled functions are cached, separately for each processor, and also run if no cache can be written."""

import os
import subprocess
import sys

import pytest

SCRIPT = """
from drakearm.muscle.compiled import compiled
from drakearm.muscle.thelen2003 import velocity_scale
print(velocity_scale(1.0, None))
"""


@pytest.mark.parametrize("writable", [True, False])
def test_functions_run_with_and_without_a_writable_cache(tmp_path, writable):
    folder = tmp_path / "cache"
    if not writable:
        folder.write_text("a file in the place of the folder")
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        cwd=tmp_path,
        env={**os.environ, "NUMBA_CACHE_DIR": str(folder)},
        capture_output=True,
        text=True,
    )
    assert run.stdout.strip() == "(1.0, 0.75)", run.stderr
    if writable:
        (state,) = folder.iterdir()  # one folder for the present source files
        assert list(state.rglob("*velocity_scale*.nbc"))


def test_code_for_another_processor_is_not_taken_from_the_cache(tmp_path):
    for limits in ({}, {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}):
        subprocess.run(
            [sys.executable, "-c", SCRIPT],
            cwd=tmp_path,
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), **limits},
            check=True,
        )
    assert len(list(tmp_path.rglob("*velocity_scale*.nbc"))) == 2
