"""OpenSim is imported without a trace in the environment of other programs."""

import subprocess
import sys
from importlib.util import find_spec

import pytest

SCRIPT = """
import os
before = dict(os.environ)
from drakearm.importing.opensim_file import import_opensim
import_opensim()
assert dict(os.environ) == before, set(os.environ.items()) ^ set(before.items())
"""


@pytest.mark.skipif(not find_spec("opensim"), reason="OpenSim is not installed")
def test_the_environment_stays_as_it_was():
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
