"""Makes metabolic.npz: the metabolic power of the muscles of 14muscles.osim, as OpenSim's probe computes it.

Run it with `python make_metabolic.py 14muscles.osim`, with opensim 4.6 installed. The file is in the repository of the
paper's authors, BlueBrain/learning_musculoskeletal_arm_control. `tests/muscle/test_energy.py` compares drakearm with
what is stored.

Every muscle of the file pulls alone on a slider here, so that every fiber length and tendon strain can be reached.
Arrays in metabolic.npz: `muscles` (14,), names; all others (samples, 14), in SI units:

- the state: excitation, activation (before OpenSim clamps it), fiber_length, mtu_length;
- OpenSim's fiber_velocity, active_force, passive_force (along the fiber) and tendon_force in this state;
- OpenSim's activation_rate, maintenance_rate, shortening_rate and work_rate, each from a probe that computes this part
  alone and has no limits, and total_rate, from a probe that computes all parts and has OpenSim's default limits.

All probes have use_force_dependent_shortening_prop_constant = true and include_negative_mechanical_work = false, and
otherwise OpenSim's default values: a specific tension of 0.25 MPa, a density of 1059.7 kg/m^3, half of the fibers slow.
"""

import sys
from pathlib import Path

import numpy as np

try:
    import opensim
except ImportError:
    sys.exit("not installed: pip install opensim==4.6")

OUTPUT = Path(__file__).with_name("metabolic.npz")
PARTS = ("activation", "maintenance", "shortening", "mechanical_work")  # as in the probe's properties
CONSTANTS = (0.5, 40.0, 133.0, 74.0, 111.0)  # OpenSim's default values: slow fraction, then W/kg
FASTEST = 15.0  # optimal fiber lengths per second
TRIALS = 1000


def lone_muscles(file: str) -> opensim.Model:
    """The muscles of a model file, each between the ground and its own slider."""
    source, model = opensim.Model(file), opensim.Model()
    source.initSystem()
    ground = model.getGround()
    for i in range(source.getMuscles().getSize()):
        muscle = opensim.Thelen2003Muscle.safeDownCast(source.getMuscles().get(i)).clone()
        name = muscle.getName()
        body = opensim.Body(f"{name}_body", 1.0, opensim.Vec3(0), opensim.Inertia(1.0))
        joint = opensim.SliderJoint(f"{name}_joint", ground, body)
        joint.updCoordinate().setName(f"{name}_length")
        muscle.set_path(opensim.GeometryPath())
        muscle.addNewPathPoint("origin", ground, opensim.Vec3(0))
        muscle.addNewPathPoint("insertion", body, opensim.Vec3(0))
        model.addBody(body)
        model.addJoint(joint)
        model.addForce(muscle)
    model.initSystem()  # until then getMuscles() does not list all of them
    return model


def add_probe(model: opensim.Model, parts: tuple[str, ...], limits: bool) -> opensim.Bhargava2004MuscleMetabolicsProbe:
    """A probe of all muscles that computes some parts of the power."""
    probe = opensim.Bhargava2004MuscleMetabolicsProbe()
    probe.setName("_".join(parts))
    probe.set_report_total_metabolics_only(False)
    probe.set_use_force_dependent_shortening_prop_constant(True)
    probe.set_include_negative_mechanical_work(False)
    probe.set_enforce_minimum_heat_rate_per_muscle(limits)
    probe.set_forbid_negative_total_power(limits)
    probe.set_basal_rate_on(False)
    for part in PARTS:
        getattr(probe, f"set_{part}_rate_on")(part in parts)
    model.addProbe(probe)
    for i in range(model.getMuscles().getSize()):
        probe.addMuscle(model.getMuscles().get(i).getName(), *CONSTANTS)
    return probe


class Arm:
    """Sets the state of the lone muscles, and asks OpenSim for what follows from it."""

    def __init__(self, file: str):
        self._model = lone_muscles(file)
        self._total = add_probe(self._model, PARTS, limits=True)
        self._parts = [add_probe(self._model, (part,), limits=False) for part in PARTS]
        self._state = self._model.initSystem()
        muscles = self._model.getMuscles()
        self.muscles = [opensim.Thelen2003Muscle.safeDownCast(muscles.get(i)) for i in range(muscles.getSize())]

    def set_length(self, i: int, mtu_length: float) -> None:
        self._model.getCoordinateSet().get(f"{self.muscles[i].getName()}_length").setValue(self._state, mtu_length)

    def set_fiber(self, i: int, activation: float, fiber_length: float) -> None:
        path = self.muscles[i].getAbsolutePathString()
        self._model.setStateVariableValue(self._state, f"{path}/activation", activation)
        self._model.setStateVariableValue(self._state, f"{path}/fiber_length", fiber_length)

    def relax(self, i: int) -> float:
        """The fiber length (m) of muscle i in equilibrium; it becomes that of the state."""
        self._model.realizeVelocity(self._state)
        self.muscles[i].computeEquilibrium(self._state)
        path = self.muscles[i].getAbsolutePathString()
        return self._model.getStateVariableValue(self._state, f"{path}/fiber_length")

    def speed(self, i: int) -> float:
        """The fiber velocity of muscle i, in optimal fiber lengths per second."""
        self._model.realizeVelocity(self._state)
        return self.muscles[i].getFiberVelocity(self._state) / self.muscles[i].getOptimalFiberLength()

    def answers(self, excitation: np.ndarray) -> dict[str, list[float]]:
        """What OpenSim computes in the present state with this excitation."""
        state, controls = self._state, opensim.Vector(len(excitation), 0.0)
        for i, u in enumerate(excitation):
            controls.set(i, float(u))
        self._model.realizeVelocity(state)
        self._model.setControls(state, controls)
        self._model.realizeReport(state)
        row = {
            "mtu_length": [m.getLength(state) for m in self.muscles],
            "fiber_velocity": [m.getFiberVelocity(state) for m in self.muscles],
            "active_force": [m.getActiveFiberForce(state) for m in self.muscles],
            "passive_force": [m.getPassiveFiberForce(state) for m in self.muscles],
            "tendon_force": [m.getTendonForce(state) for m in self.muscles],
        }
        names = ("activation_rate", "maintenance_rate", "shortening_rate", "work_rate", "total_rate")
        for name, probe in zip(names, [*self._parts, self._total], strict=True):
            power = probe.getProbeOutputs(state)
            row[name] = [power.get(2 + i) for i in range(len(self.muscles))]  # after the sum and the basal power
        return row


def sample(arm: Arm, kind: str, rng: np.random.Generator) -> dict[str, list[float]]:
    """One random state of all muscles, and OpenSim's answers.

    kind: "moving", at most at FASTEST; "corner", the same with excitation and activation at the ends of their ranges;
    "unclamped", the same with an activation outside its range; "fast", up to five times FASTEST; "resting", in
    equilibrium; "shortest", at or below the fiber length where OpenSim stops the fiber.
    """
    n = len(arm.muscles)
    excitation, activation, fiber_length = rng.random(n), rng.uniform(0.01, 1.0, n), np.empty(n)
    if kind == "corner":
        excitation, activation = rng.integers(0, 2, n).astype(float), rng.choice([0.01, 1.0], n)
    if kind == "unclamped":
        activation = rng.choice([-0.2, 0.001, 1.2], n)
    limit = 5.0 * FASTEST if kind == "fast" else FASTEST
    for i, muscle in enumerate(arm.muscles):
        optimal, slack = muscle.getOptimalFiberLength(), muscle.getTendonSlackLength()
        width = optimal * np.sin(muscle.getPennationAngleAtOptimalFiberLength())
        for _ in range(TRIALS):
            fiber = optimal * rng.uniform(0.25, 1.8)
            strain = rng.uniform(-0.005, 0.045)
            if kind == "shortest":
                shortest = max(muscle.getMinimumFiberLength(), 0.01 * optimal)  # OpenSim's is 0 without pennation
                fiber, strain = shortest * rng.uniform(0.9, 1.0), -0.005
            fiber_length[i] = fiber
            arm.set_length(i, slack * (1.0 + strain) + np.sqrt(max(fiber**2 - width**2, 0.0)))
            arm.set_fiber(i, activation[i], fiber)
            if kind == "resting":
                fiber_length[i] = arm.relax(i)
            if abs(arm.speed(i)) <= limit:
                break
        else:
            raise RuntimeError(f"no state of {muscle.getName()} in {TRIALS} trials is slow enough")
    return {"excitation": excitation, "activation": activation, "fiber_length": fiber_length, **arm.answers(excitation)}


def main() -> None:
    opensim.Logger.setLevelString("Error")
    arm, rng = Arm(sys.argv[1]), np.random.default_rng(2004)
    kinds = ["moving"] * 30 + ["corner"] * 10 + ["unclamped", "fast", "resting", "shortest"] * 6
    samples = [sample(arm, kind, rng) for kind in kinds]
    arrays = {name: np.array([row[name] for row in samples]) for name in samples[0]}
    np.savez_compressed(OUTPUT, muscles=[m.getName() for m in arm.muscles], **arrays)
    speed = arrays["fiber_velocity"]
    print(f"{speed.size} states of muscles, {(speed > 0).sum()} of them with lengthening fibers, in {OUTPUT}")


if __name__ == "__main__":
    main()
