"""MyoSuite's elbow as an environment: MuJoCo, with observation and reward in Python.

Run it with `python myosuite_elbow.py`, with myosuite installed. MyoSuite needs an older Gymnasium than drakearm's
constraints name, so install it in an environment of its own.
"""

import os
import sys

os.environ["OMP_NUM_THREADS"] = "1"

try:
    from myosuite import make_env
except ImportError:
    sys.exit("not installed: pip install myosuite, in an environment of its own")
from rates import is_quick, rate, report


def main() -> None:
    quick = is_quick(__doc__)
    env = make_env("myoElbowPose1D6MRandom-v0")
    env.reset(seed=0)
    arm, action = env.unwrapped, env.action_space.sample()

    def control_step() -> None:
        *_, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()

    steps, step = rate(control_step, quick), arm.model.opt.timestep
    report("MyoSuite's elbow", arms=1, muscles=arm.model.nu, control_step=arm.dt, physics_step=step, steps=steps)


if __name__ == "__main__":
    main()
