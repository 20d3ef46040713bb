"""What users import: each public name is there, and importing the package stays quick."""

import subprocess
import sys
from importlib import import_module
from importlib.metadata import version

import pytest

import drakearm


@pytest.mark.parametrize("package", ["drakearm", "drakearm.experiments", "drakearm.figures", "drakearm.reproduction"])
def test_every_public_name_is_there_and_listed(package):
    module = import_module(package)
    for name in module.__all__:
        assert getattr(module, name) is not None
    assert set(module.__all__) <= set(dir(module))
    assert len(set(module.__all__)) == len(module.__all__)


@pytest.mark.parametrize("package", ["drakearm", "drakearm.experiments", "drakearm.reproduction"])
def test_no_name_is_provided_that_is_not_public(package):
    code = f"import {package} as p; print(*sorted(set(dir(p)) - set(vars(p)) - set(p.__all__)))"
    assert run(code).strip() == ""


def test_unknown_names_are_refused_as_in_any_module():
    with pytest.raises(AttributeError, match="module 'drakearm' has no attribute 'leg'"):
        drakearm.leg  # noqa: B018


def test_version():
    assert drakearm.__version__ == version("drakearm")


def test_importing_drakearm_imports_nothing_heavy():
    code = "import sys, drakearm; print(*{'gymnasium', 'numpy', 'torch', 'pydrake', 'pydantic'} & set(sys.modules))"
    assert run(code).strip() == ""


@pytest.mark.parametrize("order", ["drakearm, gymnasium", "gymnasium, drakearm"])
def test_the_environment_is_registered_whichever_is_imported_first(order):
    printed = run(f"import {order}; print(gymnasium.spec('drakearm/Track-v0').entry_point)")
    assert printed.strip() == "drakearm.experiments.environments:make_env"


def run(code: str) -> str:
    """What Python code prints in a process of its own."""
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout
