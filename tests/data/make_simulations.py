"""Makes simulations.npz: random movements of the arm of 14muscles.osim, as OpenSim simulates them.

Run it with `python make_simulations.py 14muscles.osim`, with opensim 4.6 installed; it takes a few minutes. The file
is in the repository of the paper's authors, BlueBrain/learning_musculoskeletal_arm_control. drakearm is compared with
what is stored by `tests/systems/test_against_opensim.py` and `tests/benchmarks/integration.py`.

The paths are the polynomials of polynomial_paths.json, because the file's own paths have jumps. There are no joint
stops. Each run starts at rest, with every muscle in equilibrium at activation 0.05. It lasts 0.75 s, or ends earlier
when the shoulder passes -90 deg, where the polynomials stop resembling muscles. The integration accuracy is 1e-9.

Arrays in simulations.npz, with n runs:

- `muscles` (14,), names; `kind` (n,), of the excitation pattern;
- `thousandths` (n, 75, 14): excitations times 1000, held for 10 ms each;
- `q` and `v` (n, 76, 2): [shoulder, elbow] every 10 ms, rad and rad/s, NaN after the end; `v` is rounded to 32 bits.
"""

import json
import sys
from pathlib import Path

import numpy as np

try:
    import opensim
except ImportError:
    sys.exit("not installed: pip install opensim==4.6")

PATHS = Path(__file__).with_name("polynomial_paths.json")
OUTPUT = Path(__file__).with_name("simulations.npz")
STEP, STEPS = 0.01, 75  # s, number of held excitations
SHOULDER_END = -np.pi / 2.0  # rad
ACCURACY = 1e-9
KINDS = ("smooth", "jumping", "bursts", "constant")
RUNS_PER_KIND = 15
LOWEST, HIGHEST = np.deg2rad([-60.0, 10.0]), np.deg2rad([60.0, 120.0])  # of the start posture


def excitations(kind: str, rng: np.random.Generator) -> np.ndarray:
    """Thousandths (75, 14) of an excitation pattern, at a random level: weak, medium or as strong as possible.

    None is below 0.01, where OpenSim's activation falls below its minimum and drakearm's does not.
    kind: "smooth", sums of slow sines; "jumping", new values every 50 ms; "bursts", three muscles for 0.2 s each while
    the others are nearly passive; "constant", on average half of the muscles.
    """
    level, t = rng.choice([0.2, 0.5, 1.0]), STEP * np.arange(STEPS)[:, None]
    if kind == "smooth":
        frequency, phase = rng.uniform(0.5, 4.0, (3, 1, 14)), rng.uniform(0.0, 2.0 * np.pi, (3, 1, 14))
        u = level * 0.5 * (1.0 + np.sin(2.0 * np.pi * frequency * t + phase).mean(axis=0))
    elif kind == "jumping":
        u = level * np.repeat(rng.random((STEPS // 5, 14)) ** 2, 5, axis=0)
    elif kind == "bursts":
        u = np.full((STEPS, 14), 0.02)
        for muscle in rng.choice(14, 3, replace=False):
            begin = rng.integers(0, STEPS - 20)
            u[begin : begin + 20, muscle] = level
    else:
        u = np.tile(level * rng.random(14) * rng.integers(0, 2, 14), (STEPS, 1))
    return np.round(1000.0 * np.clip(u, 0.01, 1.0)).astype(np.uint16)


def polynomial(shoulder: list[float], elbow: list[float]) -> opensim.MultivariatePolynomialFunction:
    """A[0] + A[1] x + ... + B[0] + B[1] y + ... as OpenSim's polynomial of two variables.

    OpenSim lists the coefficient of x^i y^j, i + j <= order, with j running faster.
    """
    order = len(shoulder) - 1
    coefficients = opensim.Vector((order + 1) * (order + 2) // 2, 0.0)
    position = 0
    for i in range(order + 1):
        for j in range(order + 1 - i):
            if i == 0 or j == 0:
                value = (shoulder[i] if j == 0 else 0.0) + (elbow[j] if i == 0 else 0.0)
                coefficients.set(position, value)
            position += 1
    return opensim.MultivariatePolynomialFunction(coefficients, 2, order)


class Arm:
    """The arm on polynomial paths, with excitations that can be set between the steps of a simulation."""

    def __init__(self, file: str):
        self._model = model = opensim.Model(file)
        paths = json.loads(PATHS.read_text())["muscles"]
        model.initSystem()
        coordinates = model.getCoordinateSet()
        self._coordinates = [coordinates.get(name) for name in ("r_shoulder_elev", "elbow_flexion")]
        muscles = model.getMuscles()
        self.names = [muscles.get(i).getName() for i in range(muscles.getSize())]
        controller = opensim.PrescribedController()
        for name in self.names:
            muscle = opensim.Thelen2003Muscle.safeDownCast(muscles.get(name))
            path = opensim.FunctionBasedPath()
            path.setLengthFunction(polynomial(paths[name]["A"], paths[name]["B"]))
            for coordinate in self._coordinates:
                path.appendCoordinatePath(coordinate.getAbsolutePathString())
            muscle.set_path(path)
            controller.addActuator(muscle)
            controller.prescribeControlForActuator(name, opensim.Constant(0.0))
        model.addController(controller)
        model.initSystem()
        functions = controller.upd_ControlFunctions()
        self._excitations = [opensim.Constant.safeDownCast(functions.get(i)) for i in range(len(self.names))]

    def simulate(self, q: np.ndarray, excitation: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """q and v (76, 2) every 10 ms, from rest at q (2,), with excitations (75, 14); NaN after the run's end."""
        state = self._model.initializeState()
        for coordinate, angle in zip(self._coordinates, q, strict=True):
            coordinate.setValue(state, float(angle))
            coordinate.setSpeedValue(state, 0.0)
        for name in self.names:
            self._model.setStateVariableValue(state, f"/forceset/{name}/activation", 0.05)
        self._model.equilibrateMuscles(state)
        positions, speeds = np.full((2, STEPS + 1, 2), np.nan)
        for k in range(STEPS + 1):
            angles = [c.getValue(state) for c in self._coordinates]
            if angles[0] < SHOULDER_END:
                break
            positions[k], speeds[k] = angles, [c.getSpeedValue(state) for c in self._coordinates]
            if k == STEPS:
                break
            for function, u in zip(self._excitations, excitation[k], strict=True):
                function.setValue(float(u))
            manager = opensim.Manager(self._model)
            manager.setIntegratorAccuracy(ACCURACY)
            manager.initialize(state)
            state = opensim.State(manager.integrate((k + 1) * STEP))
        return positions, speeds


def main() -> None:
    opensim.Logger.setLevelString("Error")
    arm, rng = Arm(sys.argv[1]), np.random.default_rng(46)
    kinds, patterns, positions, speeds = [], [], [], []
    for kind in KINDS * RUNS_PER_KIND:
        pattern, start = excitations(kind, rng), rng.uniform(LOWEST, HIGHEST)
        q, v = arm.simulate(start, pattern / 1000.0)
        kinds.append(kind)
        patterns.append(pattern)
        positions.append(q)
        speeds.append(v.astype(np.float32))
        print(f"{len(kinds)}: {kind}, at most {np.nanmax(np.abs(v)):.0f} rad/s", flush=True)
    np.savez_compressed(OUTPUT, muscles=arm.names, kind=kinds, thousandths=patterns, q=positions, v=speeds)
    print(f"in {OUTPUT}")


if __name__ == "__main__":
    main()
