"""MotorNet's arm of six muscles with compliant tendons: 10 ms steps of many arms at once, without gradients.

Run it with `python motornet_arm.py`, with motornet installed. It keeps MotorNet's integrator, Runge-Kutta 4 with steps
of 0.2 ms.
"""

import sys

try:
    import torch
    from motornet.effector import CompliantTendonArm26
except ImportError:
    sys.exit("not installed: pip install motornet")
from rates import is_quick, rate, report

STEP = 0.01  # s
SUBSTEPS = 50


@torch.no_grad()
def main() -> None:
    quick = is_quick(__doc__)
    torch.set_num_threads(1)
    arm = CompliantTendonArm26(timestep=STEP / SUBSTEPS)
    for arms in (64, 1024):
        arm.reset(options={"batch_size": arms})
        excitation = torch.full((arms, arm.n_muscles), 0.1)

        def control_step(excitation: torch.Tensor = excitation) -> None:
            for _ in range(SUBSTEPS):
                arm.step(excitation)

        steps = arms * rate(control_step, quick)
        report(
            "MotorNet, compliant",
            arms=arms,
            muscles=arm.n_muscles,
            control_step=STEP,
            physics_step=STEP / SUBSTEPS,
            steps=steps,
        )


if __name__ == "__main__":
    main()
