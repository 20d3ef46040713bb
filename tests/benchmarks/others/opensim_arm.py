"""OpenSim on the paper's arm: 10 ms steps with held excitations, as the paper's authors stepped it, and coarser.

Run it with `python opensim_arm.py [14muscles.osim]`, with opensim installed; the file is in the authors' repository,
BlueBrain/learning_musculoskeletal_arm_control.
"""

import sys
from pathlib import Path

try:
    import opensim
except ImportError:
    sys.exit("not installed: pip install opensim")
from rates import rate, report

FILE = Path(__file__).parents[4] / "shared" / "arm14" / "14muscles.osim"
STEP, EPISODE = 0.01, 75  # s, steps


def make_arm(file: Path) -> opensim.Model:
    """The arm with every muscle's excitation held at 0.1."""
    model = opensim.Model(str(file))
    controller = opensim.PrescribedController()
    for i in range(model.getMuscles().getSize()):
        muscle = model.getMuscles().get(i)
        controller.addActuator(muscle)
        controller.prescribeControlForActuator(muscle.getName(), opensim.Constant(0.1))
    model.addController(controller)
    model.initSystem()
    return model


class Episodes:
    """Calls advance the arm by a control step, or start a new episode first where one is over."""

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
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    if not file.is_file():
        sys.exit(f"{file.name} is not here")
    opensim.Logger.setLevelString("Off")
    model = make_arm(file)
    for name, accuracy in (("as the authors", 1e-6), ("coarse", 1e-2)):
        steps = rate(Episodes(model, accuracy))
        what = f"OpenSim, accuracy {accuracy:g} ({name})"
        report(what, arms=1, muscles=14, control_step=STEP, physics_step=None, steps=steps)


if __name__ == "__main__":
    main()
