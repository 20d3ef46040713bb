"""MuJoCo alone on MyoSuite's elbow: one joint and six muscles with rigid tendons.

Run it with `python mujoco_elbow.py`, with mujoco and myo-sim installed.
"""

import sys

try:
    import mujoco
    from myo_sim import MODELS_DIR
except ImportError:
    sys.exit("not installed: pip install mujoco myo-sim")
from rates import is_quick, rate, report

MODEL = MODELS_DIR / "legacy" / "elbow" / "myoelbow_1dof6muscles.xml"
SUBSTEPS = 10  # a control step, as in MyoSuite's environment


def main() -> None:
    quick = is_quick(__doc__)
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    data = mujoco.MjData(model)
    data.ctrl[:] = 0.1
    steps = rate(lambda: mujoco.mj_step(model, data, SUBSTEPS), quick)
    step = model.opt.timestep
    report("MuJoCo's elbow", arms=1, muscles=model.nu, control_step=SUBSTEPS * step, physics_step=step, steps=steps)


if __name__ == "__main__":
    main()
