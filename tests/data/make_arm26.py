"""Makes arm26.npz: what OpenSim says about arm26, to compare the imported limb drakearm/model/arm26 with.

Run it with `python make_arm26.py arm26.osim`, with opensim 4.6 installed; it takes a minute. `tests/importing/
test_arm26.py` compares drakearm with what is stored.

The paths are the file's own, with their wrapping. The wrapping of TRIlong has a fault between the shoulder angles
-16.60 and -16.52 deg, where its length is wrong by 8.5 mm. A movement that crosses it gets a blow in OpenSim. So five
movements start and stay below, and the same excitations start above, where they cross it. There are no joint stops.
Each movement starts at rest, with every muscle in equilibrium at activation 0.05, and lasts 0.75 s, at accuracy 1e-8.

Arrays in arm26.npz, in SI units and rad:

- `muscles` (6,) and `movements` (10,), names;
- `q` (300, 2): random postures, [shoulder, elbow], of the whole joint range; `length` (300, 6);
  `moment_arm` (300, 6, 2);
- `activation` (300, 6), random; `tendon_force` (300, 6): in equilibrium at rest, NaN where OpenSim finds none;
- `excitation` (10, 76, 6): every 10 ms, linear between; `fiber_length` (10, 6): at the start;
- `movement_q` (10, 76, 2): every 10 ms; `movement_force` (10, 76, 6): tendon forces.
"""

import sys
from pathlib import Path

import numpy as np

try:
    import opensim
except ImportError:
    sys.exit("not installed: pip install opensim==4.6")

OUTPUT = Path(__file__).with_name("arm26.npz")
STEP, STEPS = 0.01, 76
STARTS = {"below the fault": (-30.0, 95.0), "across the fault": (0.0, 60.0)}  # deg
ACTIVATION = 0.05


def excitations(names: list[str]) -> dict[str, np.ndarray]:
    """Five patterns (76, 6)."""
    t = STEP * np.arange(STEPS)[:, None]
    extensors = np.array([float(name.startswith("TRI")) for name in names])
    flexors = 1.0 - extensors
    rng = np.random.default_rng(29)
    phase, rate = rng.uniform(0.0, 2.0 * np.pi, (2, 1, len(names)))

    def burst(middle: float, width: float) -> np.ndarray:
        return np.exp(-(((t - middle) / width) ** 2))

    return {
        "constant": np.full((STEPS, len(names)), 0.1),
        "burst of flexors": 0.04 + 0.12 * burst(0.2, 0.06) * flexors,
        "extensors, then flexors": 0.05 + 0.15 * burst(0.1, 0.05) * extensors + 0.2 * burst(0.3, 0.08) * flexors,
        "in turn": 0.1 + 0.08 * np.sin(12.0 * t + np.pi * extensors),
        "random": 0.1 + 0.04 * np.sin((3.0 + rate) * t + phase),
    }


class Arm26:
    def __init__(self, file: str) -> None:
        opensim.Logger.setLevelString("off")
        self.model = opensim.Model(file)
        muscles = self.model.getMuscles()
        self.muscles = [muscles.get(i) for i in range(muscles.getSize())]
        self.coordinates = [self.model.getCoordinateSet().get(i) for i in range(2)]
        self.controller = opensim.PrescribedController()
        for muscle in self.muscles:
            self.controller.addActuator(muscle)
        self.model.addController(self.controller)

    def at(self, q: np.ndarray, excitation: np.ndarray | None = None) -> opensim.State:
        """A state at rest. excitation (76, 6): of the movement that begins there."""
        excitation = np.full((2, len(self.muscles)), ACTIVATION) if excitation is None else excitation
        for muscle, values in zip(self.muscles, excitation.T, strict=True):
            function = opensim.PiecewiseLinearFunction()
            for i, value in enumerate(values.tolist()):
                function.addPoint(STEP * i, value)
            self.controller.prescribeControlForActuator(muscle.getName(), function)
        state = self.model.initSystem()
        for coordinate, angle in zip(self.coordinates, q.tolist(), strict=True):
            coordinate.setValue(state, angle, False)
        self.model.realizePosition(state)
        return state

    def force_in_equilibrium(self, state: opensim.State, i: int, activation: float) -> float:
        self.muscles[i].setActivation(state, activation)
        try:
            self.muscles[i].computeEquilibrium(state)
        except RuntimeError:
            return np.nan
        self.model.realizeDynamics(state)
        return self.muscles[i].getTendonForce(state)

    def move(self, q: np.ndarray, excitation: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Fiber lengths at the start (6,); joint angles (76, 2) and tendon forces (76, 6)."""
        state = self.at(q, excitation)
        for muscle in self.muscles:
            muscle.setActivation(state, ACTIVATION)
        self.model.equilibrateMuscles(state)
        fibers = np.array([muscle.getFiberLength(state) for muscle in self.muscles])
        manager = opensim.Manager(self.model)
        manager.setIntegratorAccuracy(1e-8)
        manager.initialize(state)
        angles, forces = np.empty((STEPS, 2)), np.empty((STEPS, len(self.muscles)))
        for i in range(STEPS):
            if i:
                state = manager.integrate(STEP * i)
            self.model.realizeDynamics(state)
            angles[i] = [coordinate.getValue(state) for coordinate in self.coordinates]
            forces[i] = [muscle.getTendonForce(state) for muscle in self.muscles]
        return fibers, angles, forces


def main() -> None:
    arm = Arm26(sys.argv[1])
    names = [muscle.getName() for muscle in arm.muscles]
    rng = np.random.default_rng(0)
    lower, upper = ([getattr(c, side)() for c in arm.coordinates] for side in ("getRangeMin", "getRangeMax"))
    q, activation = rng.uniform(lower, upper, (300, 2)), rng.uniform(0.02, 1.0, (300, len(names)))
    length, force, moment_arm = np.empty((300, 6)), np.empty((300, 6)), np.empty((300, 6, 2))
    for k in range(len(q)):
        state = arm.at(q[k])
        for i, muscle in enumerate(arm.muscles):
            length[k, i] = muscle.getLength(state)
            moment_arm[k, i] = [muscle.computeMomentArm(state, coordinate) for coordinate in arm.coordinates]
            force[k, i] = arm.force_in_equilibrium(state, i, activation[k, i])
    movements, given, results = [], [], []
    for place, start in STARTS.items():
        for name, excitation in excitations(names).items():
            movements.append(f"{name}, {place}")
            given.append(excitation)
            results.append(arm.move(np.deg2rad(start), excitation))
            low, high = (np.rad2deg(f(results[-1][1], axis=0)).round(1) for f in (np.min, np.max))
            print(f"{movements[-1]}: shoulder {low[0]} to {high[0]}, elbow {low[1]} to {high[1]} deg")
    fibers, angles, forces = (np.array(part) for part in zip(*results, strict=True))
    np.savez_compressed(
        OUTPUT,
        muscles=names,
        movements=movements,
        q=q,
        length=length,
        moment_arm=moment_arm,
        activation=activation,
        tendon_force=force,
        excitation=np.array(given),
        fiber_length=fibers,
        movement_q=angles,
        movement_force=forces,
    )


if __name__ == "__main__":
    main()
