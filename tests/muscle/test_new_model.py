"""A third muscle model, added to a copy of the package by the steps of docs/extending.md: three files."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# Stands for a new model: De Groote's curves, with a passive force twice as large.
CURVES = (
    "active_force_length",
    "passive_force_length",
    "tendon_force_strain",
    "velocity_of_force",
    "force_of_velocity",
)
SCRIPT = """
from dataclasses import replace
import numpy as np
from drakearm.learning.compiled_arm import CompiledArms
from drakearm.model import MakeTorqueArm, load_arm
from drakearm.model.dynamics_table import read_dynamics
from drakearm.model.musculature import muscle_step, resting_states
from drakearm.muscle import models

arm = load_arm("arm14")
arm = replace(arm, muscles=tuple(replace(m, model="twice2026") for m in arm.muscles))
m, other = arm.muscle_table[0], load_arm("arm14").muscle_table.copy()
other["model_code"] = models.DEGROOTE2016
other["passive_offset"], other["passive_scale"] = m["passive_offset"], 0.5 * m["passive_scale"]
twice, once = models.passive_force_length(1.4, m)[0], models.passive_force_length(1.4, other[0])[0]
assert np.isclose(twice, 2.0 * once) and twice > 0.0

plant = MakeTorqueArm(arm)
arms = CompiledArms(arm, read_dynamics(plant), 1, plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits())
x, state = np.array([[-0.3, 1.2, 0.1, -0.2]]), resting_states(arm, np.array([[-0.3, 1.2]]), 0.05)
arms.set_state(np.array([True]), x, state)
excitation, alone = np.full(14, 0.3), state[0].copy()
arms.step(excitation[None], 1, 1e-3)
muscle_step(alone, np.empty(2), excitation, x[0], 1e-3, arm.muscle_table, arm.path_table)
np.testing.assert_allclose(arms.muscle_state[0], alone, atol=1e-12)
print("the new model works")
"""


def edit(file, *changes):
    text = file.read_text()
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    file.write_text(text)


def name_in_models(file):
    """Step 1: the table and the six functions."""
    text = file.read_text()
    text = text.replace("import degroote2016, thelen2003", "import degroote2016, thelen2003, twice2026")
    text = text.replace('"degroote2016": degroote2016}', '"degroote2016": degroote2016, "twice2026": twice2026}')
    text = text.replace("THELEN2003, DEGROOTE2016 = range", "THELEN2003, DEGROOTE2016, TWICE2026 = range")
    for short in ("active", "passive", "tendon", "velocity", "force", "scale"):
        text = text.replace(f"_degroote2016_{short} = (", f"_degroote2016_{short}, _twice2026_{short} = (")
        call = f"        return _degroote2016_{short}("
        at = text.index(call)
        line = text[at : text.index("\n", at) + 1]
        text = text.replace(
            line, line + "    if m.model_code == TWICE2026:\n" + line.replace("_degroote2016_", "_twice2026_")
        )
    file.write_text(text)


@pytest.mark.slow
@pytest.mark.extra
def test_a_new_model_takes_three_files(tmp_path):
    for folder in ("drakearm", "systems", "diagrams"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    muscle = tmp_path / "drakearm" / "muscle"
    model = muscle / "twice2026.py"
    shutil.copy(muscle / "degroote2016.py", model)
    edit(model, ("return offset, 1.0 / (math", "return offset, 2.0 / (math"))
    run = [sys.executable, "-c", SCRIPT]

    name_in_models(muscle / "models.py")
    half_done = subprocess.run(run, cwd=tmp_path, env={"PYTHONPATH": str(tmp_path)}, capture_output=True, text=True)
    assert "step_muscle_lanes must choose by muscle model, but lacks TWICE2026" in half_done.stderr

    edit(
        tmp_path / "drakearm" / "model" / "muscle_lanes.py",
        (
            "import DEGROOTE2016, MODEL_CODES, MODELS, THELEN2003,",
            "import DEGROOTE2016, MODEL_CODES, MODELS, THELEN2003, TWICE2026,",
        ),
        ("    rigid: np.ndarray | None", "    twice2026: np.ndarray | None\n    rigid: np.ndarray | None"),
        ("work, thelen2003, degroote2016, rigid\n):", "work, thelen2003, degroote2016, twice2026, rigid\n):"),
        (
            "    if rigid is not None:\n        _path_speeds(arm_state",
            "    if twice2026 is not None:\n"
            "        for i in twice2026:\n"
            "            m = muscle_parameters(muscles[i], TWICE2026)\n"
            "            _step_compliant(state, excitation, i, n, time_step, work, m)\n"
            "    if rigid is not None:\n        _path_speeds(arm_state",
        ),
    )
    environment = {"PYTHONPATH": str(tmp_path), "HOME": str(tmp_path)}
    done = subprocess.run(run, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.stdout == "the new model works\n", done.stderr
