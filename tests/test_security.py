"""The promises of SECURITY.md: no file runs code, servers listen on localhost only, the sources use nothing unsafe."""

import ast
import os
import pickle
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch
import yaml
from pydrake.geometry import Meshcat, MeshcatParams

from drakearm.errors import DrakearmError, RunFolderError
from drakearm.experiments import load_scenario, scenario_files
from drakearm.experiments.catalog import _FastLoader
from drakearm.files.reading import _Loader, read_json
from drakearm.learning import Policy
from drakearm.model import Recording, Reference, load_arm
from drakearm.replay.scene import ReplayScene

ROOT = Path(__file__).parents[1]
SOURCES = [file for folder in ("drakearm", "systems", "diagrams", "examples") for file in (ROOT / folder).rglob("*.py")]
CODE_FROM_DATA = {"pickle", "dill", "cloudpickle", "joblib", "marshal", "shelve"}
CONNECTIONS = {
    "socket",
    "socketserver",
    "http",
    "urllib",
    "requests",
    "httpx",
    "aiohttp",
    "ftplib",
    "smtplib",
    "xmlrpc",
}
OTHER_PROGRAMS = {"subprocess", "pty"}
MAY_IMPORT = {
    "drakearm/muscle/compile_cache.py": {"pickle"},  # checked with a checksum, see the file
    "drakearm/replay/film.py": {"subprocess"},  # runs ffmpeg, without a shell, with the paths of files as arguments
    "drakearm/planning/library.py": {"joblib"},  # no file: it exchanges messages with its own workers
    "drakearm/reproduction/backends.py": {"joblib"},  # the same
    "drakearm/reproduction/sweep.py": {"joblib"},
}
MAY_LOAD_YAML = {"drakearm/files/reading.py": "_Loader", "drakearm/experiments/catalog.py": "_FastLoader"}
UNSAFE_CALLS = (
    r"eval|exec|compile|__import__|os\.(system|popen|exec\w*|spawn\w*)|torch\.load|pd\.read_pickle|StartMeshcat|"
    r"yaml\.(unsafe_load|full_load|load_all|unsafe_load_all|full_load_all)"
)


def relative(file):
    return str(file.relative_to(ROOT))


@pytest.mark.parametrize("file", SOURCES, ids=relative)
def test_sources_use_nothing_unsafe(file):
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]
            rooms = {name.split(".")[0] for name in names} - MAY_IMPORT.get(relative(file), set())
            assert not rooms & (CODE_FROM_DATA | CONNECTIONS | OTHER_PROGRAMS), ast.unparse(node)
        if isinstance(node, ast.Call):
            called, code = ast.unparse(node.func), ast.unparse(node)
            assert not re.fullmatch(UNSAFE_CALLS, called), code
            assert not re.search("allow_pickle=(?!False)|shell=(?!False)|weights_only=(?!True)", code), code
            if called == "yaml.load":
                assert ast.unparse(node.args[1]) == MAY_LOAD_YAML.get(relative(file)), code
            if called == "Meshcat":
                assert node.args or node.keywords, f"{code}: by default it listens to the whole network"
            if called == "MeshcatParams":
                assert "host='localhost'" in code, code


def test_the_loaders_of_yaml_are_safe():
    assert issubclass(_Loader, yaml.SafeLoader)
    assert issubclass(_FastLoader, yaml.constructor.SafeConstructor)
    assert not issubclass(_FastLoader, yaml.constructor.FullConstructor)


class Bomb:
    """Makes a folder where it is unpickled."""

    def __init__(self, folder):
        self.folder = folder

    def __reduce__(self):
        return os.mkdir, (str(self.folder),)


@pytest.fixture
def witness(tmp_path):
    """The folder that is made if a file could run code."""
    yield tmp_path / "code ran"
    assert not (tmp_path / "code ran").exists()


def test_the_bomb_works(tmp_path):
    pickle.loads(pickle.dumps(Bomb(tmp_path / "x")))
    assert (tmp_path / "x").is_dir()


@pytest.mark.parametrize("tag", ["!!python/object/apply:os.mkdir", "!!python/object/new:os.mkdir"])
def test_yaml_runs_no_code(tmp_path, witness, tag):
    code = f"{tag} ['{witness}']\n"
    (tmp_path / "scenario.yaml").write_text(scenario_files()["reach-000"].read_text() + f"\nload_mass: {code}")
    (tmp_path / "muscles.yaml").write_text((load_arm().skeleton.parent / "muscles.yaml").read_text() + f"\nx: {code}")
    for read in (lambda: load_scenario(tmp_path / "scenario.yaml"), lambda: load_arm(tmp_path)):
        with pytest.raises(DrakearmError):
            read()


def test_arrays_run_no_code(tmp_path, witness):
    bombs = np.array([Bomb(witness)], dtype=object)
    names = ("t", "q", "v", "a", "tau", "reference_q", "reference_v", "excitation", "activation", "reward")
    np.savez(tmp_path / "zip.npz", **dict.fromkeys(names, bombs))
    with open(tmp_path / "plain.npz", "wb") as file:
        np.save(file, bombs)
    (tmp_path / "pickle.npz").write_bytes(pickle.dumps(Bomb(witness)))
    for name in ("zip.npz", "plain.npz", "pickle.npz"):
        for kind in (Reference, Recording):
            with pytest.raises(DrakearmError):
                kind.load(tmp_path / name)


def test_policies_run_no_code(tmp_path, witness):
    torch.save({"actor": Bomb(witness)}, tmp_path / "torch.safetensors")
    (tmp_path / "pickle.safetensors").write_bytes(pickle.dumps(Bomb(witness)))
    for name in ("torch.safetensors", "pickle.safetensors"):
        with pytest.raises(DrakearmError):
            Policy.load(tmp_path / name)


def test_json_runs_no_code(tmp_path, witness):
    (tmp_path / "metrics.json").write_bytes(pickle.dumps(Bomb(witness)))
    with pytest.raises(DrakearmError):
        read_json(tmp_path / "metrics.json", RunFolderError)


def test_python_files_beside_a_scenario_and_its_arm_are_ignored(tmp_path, witness):
    command = Path(sys.executable).with_name("drakearm")
    if not command.is_file():
        pytest.skip("the command drakearm is not installed beside this Python")
    fields = yaml.safe_load(scenario_files()["reach-000"].read_text())
    shutil.copytree(load_arm().skeleton.parent, tmp_path / "arm")
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump({**fields, "name": "mine", "arm": "arm"}))
    for folder in (tmp_path, tmp_path / "arm"):
        for module in ("yaml", "numpy", "mine", "my_costs", "conftest", "sitecustomize", "arm", "muscles", "__init__"):
            (folder / f"{module}.py").write_text(f"import os\nos.mkdir({str(witness)!r})\n")
    path = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")]))
    done = subprocess.run(
        [command, "plan", "mine.yaml"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def listening_addresses():
    """The addresses at which this process waits for connections, as the kernel shows them."""
    links = (os.readlink(f"/proc/self/fd/{number}") for number in os.listdir("/proc/self/fd") if _is_open(number))
    own = {link.removeprefix("socket:[").removesuffix("]") for link in links if link.startswith("socket:[")}
    addresses = []
    for table in ("/proc/self/net/tcp", "/proc/self/net/tcp6"):
        lines = Path(table).read_text().splitlines()[1:] if Path(table).exists() else []
        for line in lines:
            fields = line.split()
            if fields[3] == "0A" and fields[9] in own:  # listening
                addresses.append(fields[1].split(":")[0])
    return addresses


def _is_open(number):
    return os.path.lexists(f"/proc/self/fd/{number}")


LOCAL = {"0100007F", "00000000000000000000000001000000"}  # 127.0.0.1 and ::1, as the kernel writes them


@pytest.mark.skipif(not Path("/proc/self/net/tcp").exists(), reason="needs Linux's list of connections")
def test_servers_listen_on_localhost_only(arm):
    before = listening_addresses()
    scene, live = ReplayScene(arm), Meshcat(MeshcatParams(host="localhost"))  # as a replay and as the examples do
    found = listening_addresses()
    assert len(found) == len(before) + 2
    assert set(found) - set(before) <= LOCAL
    everywhere = Meshcat()  # what the test would find if one of them listened to the network
    assert set(listening_addresses()) - set(before) - LOCAL
    del scene, live, everywhere


def test_the_named_tests_exist():
    named = re.findall(r"`(tests/[\w/.]+)`", (ROOT / "SECURITY.md").read_text())
    assert len(named) >= 7
    for name in named:
        assert (ROOT / name).is_file(), name
