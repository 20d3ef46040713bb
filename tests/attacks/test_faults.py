"""A short version of `make faults`, and that it notices what is wrong."""

import random
import shutil

import pytest

from tests.attacks.faults import Attack

pytestmark = [pytest.mark.slow, pytest.mark.extra]


@pytest.fixture(scope="module")
def attack(tmp_path_factory):
    return Attack(tmp_path_factory.mktemp("faults"))


@pytest.mark.parametrize("step", ["plan", "train"])  # `make faults` kills the other two too
def test_a_kill_damages_nothing(attack, step):
    attack.kill(step, random.Random(step))


def test_a_lost_file_is_noticed(attack):
    run = attack.copy()
    run.path("plan_picture").unlink()
    with pytest.raises(AssertionError, match="neither the state before nor after"):
        attack.check("train", run)


def test_a_mixture_is_noticed(attack):
    run, other = attack.copy(), attack.folder / "other"
    shutil.copytree(run.folder, other)
    attack.start("train", run, change=0).communicate()
    shutil.copy(other / "policy.safetensors", run.folder)
    with pytest.raises(Exception, match="is not the file that"):
        attack.check("train", run)


def test_half_a_file_is_noticed(attack):
    run = attack.copy()
    run.path("reference").write_bytes(run.path("reference").read_bytes()[:-50])
    with pytest.raises(Exception, match=r"reference\.npz|zip"):
        attack.check("evaluate", run)
