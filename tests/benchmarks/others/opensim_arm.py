"""OpenSim on the paper's arm: 10 ms steps with held excitations, at the accuracy of the paper's authors and a coarser.

Run it with `OPENSIM_MODEL=path/to/14muscles.osim python opensim_arm.py`, with opensim installed; the file is in the
authors' repository, BlueBrain/learning_musculoskeletal_arm_control.
"""

import os
import sys
from pathlib import Path

from rates import is_quick, rate, report

missing = []
try:
    import opensim
except ImportError:
    missing.append("OpenSim is not installed: pip install opensim")
FILE = Path(os.environ.get("OPENSIM_MODEL", ""))
if not FILE.is_file():
    missing.append("the model file is missing: set OPENSIM_MODEL to the path of the authors' 14muscles.osim")
if missing:
    sys.exit("; ".join(missing))

STEP, EPISODE = 0.01, 75  # s, steps


def make_arm() -> opensim.Model:
    """The arm with every muscle's excitation held at 0.1."""
    model = opensim.Model(str(FILE))
    controller = opensim.PrescribedController()
    for i in range(model.getMuscles().getSize()):
        muscle = model.getMuscles().get(i)
        controller.addActuator(muscle)
        controller.prescribeControlForActuator(muscle.getName(), opensim.Constant(0.1))
    model.addController(controller)
    model.initSystem()
    return model


class Episodes:
    """Each call advances the arm by a control step. Where an episode is over, it starts a new one first."""

    def __init__(self, model: opensim.Model, accuracy: float):
        self._model, self._accuracy, self._steps = model, accuracy, EPISODE

    def __call__(self) -> None:
        if self._steps == EPISODE:
            state = self._model.initializeState()
            self._model.equilibrateMuscles(state)
            self._manager = opensim.Manager(self._model)
            self._manager.setIntegratorAccuracy(self._accuracy)
            self._manager.initialize(state)
            self._steps = 0
        self._steps += 1
        self._manager.integrate(self._steps * STEP)


def main() -> None:
    quick = is_quick(__doc__)
    opensim.Logger.setLevelString("Off")
    model = make_arm()
    for name, accuracy in (("as the authors", 1e-6), ("coarse", 1e-2)):
        steps = rate(Episodes(model, accuracy), quick)
        what = f"OpenSim, accuracy {accuracy:g} ({name})"
        report(what, arms=1, muscles=14, control_step=STEP, physics_step=None, steps=steps)


if __name__ == "__main__":
    main()
