"""Perturbations: each does what it says to the arm or its senses, nothing else, and the controller does not know it."""

from dataclasses import fields, replace

import numpy as np
import pytest
from pydantic import ValidationError
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, LogVectorOutput

from drakearm.diagrams import (
    ExtraLoad,
    MakePolicyLoop,
    MakeStaticLoop,
    MotorNoise,
    Perturbation,
    Push,
    SensorDelay,
    StartNoise,
    StartOffset,
    Strength,
)
from drakearm.errors import TaskError
from drakearm.model.reference import CONTROL_STEP
from drakearm.systems import Noise
from drakearm.task import OBSERVATIONS, SENSES, ReferenceStart

NEUTRAL = (
    ExtraLoad(0.0),
    Strength(1.0),
    MotorNoise(0.0),
    SensorDelay(0.0),
    Push(0.0, 0.1, 0.2),
    StartOffset(0.0),
    StartNoise(),
)


def start_state(loop, rng=None):
    """The state in which a run of a loop starts."""
    return loop.systems.Reset(loop.diagram.CreateDefaultContext(), rng).start


def assert_same(one, other):
    for field in fields(one):
        np.testing.assert_array_equal(getattr(one, field.name), getattr(other, field.name), field.name)


@pytest.fixture
def short(task):
    """The first 0.2 s of the task: its start with little noise."""
    parts = {field.name: getattr(task.reference, field.name)[:21] for field in fields(task.reference)}
    return replace(task, reference=replace(task.reference, **parts))


def observations(task, perturbations):
    """What a policy observes (N, size) that gives the same excitations whatever it observes."""
    seen = []
    excitations = iter(np.random.default_rng(3).uniform(0.0, 0.3, (len(task.reference.t), 14)))

    def policy(observation):
        seen.append(observation.copy())
        return next(excitations)

    MakePolicyLoop(task, policy, perturbations=perturbations).Run()
    return np.array(seen)


def test_neutral_perturbations_change_nothing(short):
    plain = MakeStaticLoop(short).Run(np.random.default_rng(0))
    assert_same(MakeStaticLoop(short, perturbations=NEUTRAL).Run(np.random.default_rng(0)), plain)


def test_without_a_generator_random_ones_have_no_effect(short):
    noisy = (StartNoise(posture_deg=5.0, activation=0.1), MotorNoise(0.5))
    assert_same(MakeStaticLoop(short, perturbations=noisy).Run(), MakeStaticLoop(short).Run())


def test_the_generator_determines_the_run(short):
    noisy = (StartNoise(posture_deg=5.0, activation=0.1), MotorNoise(0.5))
    loop = MakeStaticLoop(short, perturbations=noisy)
    first = loop.Run(np.random.default_rng(1))
    assert_same(loop.Run(np.random.default_rng(1)), first)
    assert_same(MakeStaticLoop(short, perturbations=noisy).Run(np.random.default_rng(1)), first)
    assert not np.array_equal(loop.Run(np.random.default_rng(2)).q, first.q)


@pytest.mark.parametrize("steps", [1, 3])
def test_a_delayed_sense_is_that_of_some_steps_ago_and_the_start_before(short, steps):
    """The previews, and the controller's own excitations, are not delayed."""
    short = replace(short, senses=SENSES, start=ReferenceStart(0.0))
    now, late = observations(short, ()), observations(short, [SensorDelay(steps * CONTROL_STEP)])
    for name, place in short.observation.places.items():
        delay = 0 if name in ("preview_q", "preview_v", "excitation", "recent_excitation") else steps
        expected = np.concatenate([np.repeat(now[:1], delay, axis=0), now[: len(now) - delay]])
        np.testing.assert_array_equal(late[:, place], expected[:, place], name)
        assert np.any(now[0, place] != now[-1, place])


def test_delays_add_up_and_need_not_be_whole_control_steps(short):
    together = observations(short, [SensorDelay(0.015), SensorDelay(0.005)])
    np.testing.assert_array_equal(together, observations(short, [SensorDelay(0.02)]))


def test_static_optimization_senses_late_too(short):
    """Its senses stay at the start while the arm is moved."""
    loop = MakeStaticLoop(short, perturbations=[SensorDelay(0.05)])
    context = Simulator(loop.diagram).get_mutable_context()
    loop.systems.Reset(context)
    sensed = loop.systems.sensed["arm_state"]
    reader = sensed.get_system().GetMyContextFromRoot(context)
    np.testing.assert_array_equal(sensed.Eval(reader), np.concatenate([short.reference.q[0], np.zeros(2)]))
    loop.systems.arm.SetState(context, np.array([0.3, 0.9]))
    np.testing.assert_array_equal(sensed.Eval(reader)[:2], short.reference.q[0])


@pytest.mark.parametrize("torque", [2.0, (3.0, -1.0)])
def test_a_push_changes_the_acceleration_at_once(short, torque):
    loop = MakeStaticLoop(short, perturbations=[Push(torque, 0.05, 0.1)])
    plant, context = loop.systems.arm.plant, loop.diagram.CreateDefaultContext()
    loop.systems.Reset(context)
    own = plant.GetMyContextFromRoot(context)
    acceleration = {}
    for time in (0.0, 0.049, 0.05, 0.149, 0.151, 9.0):
        context.SetTime(time)
        acceleration[time] = plant.get_generalized_acceleration_output_port().Eval(own).copy()
    pushed = np.linalg.solve(plant.CalcMassMatrix(own), np.broadcast_to(torque, 2))
    for time in (0.05, 0.149):
        np.testing.assert_allclose(acceleration[time] - acceleration[0.0], pushed, rtol=1e-9)
    for time in (0.049, 0.151, 9.0):
        np.testing.assert_array_equal(acceleration[time], acceleration[0.0])


def test_motor_noise_grows_with_the_excitation():
    share, steps = 0.2, 4000
    excitation = np.array([0.0, 0.01, 0.3, 1.0, 1.7, -0.2])
    builder = DiagramBuilder()
    source = builder.AddSystem(ConstantVectorSource(excitation))
    noisy = MotorNoise(share).perturb_excitation(builder, source.get_output_port())
    log = LogVectorOutput(noisy, builder, CONTROL_STEP)
    diagram = builder.Build()
    simulator = Simulator(diagram)
    for system in diagram.GetSystems():
        if isinstance(system, Noise):
            system.Begin(simulator.get_mutable_context(), np.random.default_rng(0))
    simulator.AdvanceTo(CONTROL_STEP * steps)
    drawn = log.FindLog(simulator.get_context()).data()
    possible = np.clip(excitation, 0.0, 1.0)
    np.testing.assert_allclose(drawn.std(axis=1), share * possible, rtol=0.05)
    np.testing.assert_allclose(drawn.mean(axis=1), possible, atol=5.0 * share / np.sqrt(steps))
    assert np.abs(np.corrcoef(drawn[1:4])[np.triu_indices(3, 1)]).max() < 0.1


def test_the_controller_does_not_know_the_load(short):
    """Its first decision, at the same start, is that without the load. One that knows the load decides otherwise."""
    bent = replace(short, reference=replace(short.reference, q=short.reference.q + 0.5))  # gravity pulls the load down
    first = MakeStaticLoop(bent).Run().excitation[1]
    loop = MakeStaticLoop(bent, perturbations=[ExtraLoad(1.0)])
    np.testing.assert_array_equal(loop.Run().excitation[1], first)
    assert loop.systems.arm.plant.GetBodyByName("load").default_mass() == 1.0
    assert not np.array_equal(MakeStaticLoop(replace(bent, load_mass=1.0)).Run().excitation[1], first)


def test_a_load_comes_beside_that_of_the_task(short):
    loop = MakeStaticLoop(replace(short, load_mass=2.0), perturbations=[ExtraLoad(1.0), ExtraLoad(0.5)])
    assert loop.systems.arm.plant.GetBodyByName("load").default_mass() == 3.5


def test_strength_scales_every_muscle_and_no_sense(short):
    """In the same state, forces are 0.8 times as large. The sense divides them by the strength that is known."""
    force = Perturbation.read({"type": "strength", "factor": 0.8})
    sense = next(sense for sense in SENSES if sense.name == "tendon_force")
    short = replace(short, senses=(*OBSERVATIONS["full"], sense), start=ReferenceStart(0.0))
    place = short.observation.places["tendon_force"]
    np.testing.assert_allclose(
        observations(short, [force])[0, place], 0.8 * observations(short, ())[0, place], rtol=1e-6
    )


def test_strength_of_some_muscles_leaves_the_others_as_they_are(short):
    named = Perturbation.read({"type": "strength", "factor": {"BRA": 0.5, "BRD": 0.0}})
    assert named == Strength({"BRA": 0.5, "BRD": 0.0})
    muscles, before = named.perturb_task(short).arm.muscles, short.arm.muscles
    for muscle, old in zip(muscles, before, strict=True):
        factor = {"BRA": 0.5, "BRD": 0.0}.get(muscle.name, 1.0)
        assert muscle.max_isometric_force == pytest.approx(factor * old.max_isometric_force, abs=2e-6)
    recording = MakeStaticLoop(short, perturbations=[named]).Run()
    i = short.arm.muscle_names.index("BRD")
    assert np.abs(recording.tendon_force[:, i]).max() < 1e-4 < recording.tendon_force[:, i - 2].max()


def test_a_start_offset_moves_all_joints_within_their_ranges(short):
    for angle in (3.0, -400.0):
        loop = MakeStaticLoop(short, perturbations=[StartOffset(angle)])
        plant = loop.systems.arm.plant
        lower, upper = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
        expected = np.clip(short.reference.q[0] + np.deg2rad(angle), lower, upper)
        np.testing.assert_allclose(start_state(loop).q, expected, atol=1e-15)


def test_start_noise_has_its_standard_deviation(short):
    short = replace(short, reference=replace(short.reference, q=short.reference.q + 1.0), start=ReferenceStart(0.0))
    noise = StartNoise(posture_deg=2.0, activation=0.01)
    loop = MakeStaticLoop(short, perturbations=[noise])
    starts = [start_state(loop, np.random.default_rng(seed)) for seed in range(300)]
    q, activation = np.array([s.q for s in starts]), np.array([s.activation for s in starts])
    np.testing.assert_allclose(q.std(axis=0), np.deg2rad(2.0), rtol=0.15)
    np.testing.assert_allclose(q.mean(axis=0), 1.0, atol=0.01)
    np.testing.assert_allclose(activation.std(axis=0), 0.01, rtol=0.15)
    strong = MakeStaticLoop(short, perturbations=[StartNoise(activation=1.0)])
    drawn = start_state(strong, np.random.default_rng(0)).activation
    assert drawn.min() >= 0.01 and drawn.max() <= 1.0


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ({"type": "gust"}, "type: found 'gust', expected one of extra_load, motor_noise, push"),
        ({"type": "extra_load", "mass": -1.0}, "extra_load.mass: found -1.0, expected a number greater than or equal"),
        ({"type": "motor_noise", "share": "much"}, "motor_noise.share: found 'much', expected a number"),
        ({"type": "sensor_delay", "delay": 0.0105}, "found 0.0105, expected a whole number of time steps of 0.001 s"),
        ({"type": "sensor_delay", "delay": -0.01}, "sensor_delay.delay: found -0.01, expected a number greater"),
        ({"type": "strength", "factor": 0.0}, "strength.factor: found 0.0, expected a number greater than 0"),
        ({"type": "strength", "factor": {"BRA": -0.5}}, "strength.factor.BRA: found -0.5, expected a number greater"),
        ({"type": "strength", "factor": [1.0, 0.5]}, r"strength.factor: found \[1.0, 0.5\], expected a number"),
        ({"type": "push", "torque": 1.0, "start": 0.1}, "push.duration: is missing"),
        ({"type": "start_noise", "activation": 2.0}, "start_noise.activation: found 2.0, expected a number less"),
    ],
)
def test_impossible_perturbations_are_refused(content, sentence):
    with pytest.raises(ValueError, match=sentence):
        Perturbation.read(content)


def test_perturbations_that_do_not_fit_the_arm_are_refused(short):
    with pytest.raises(TaskError, match="push has 3 torques: expected one, or 2, one for each joint"):
        MakeStaticLoop(short, perturbations=[Push((1.0, 2.0, 3.0), 0.0, 0.1)])
    with pytest.raises(TaskError, match=r"muscle .BRAC. \(did you mean BRA\?\): expected muscles of the arm arm14"):
        MakeStaticLoop(short, perturbations=[Strength({"BRAC": 0.5})])
    strong = replace(short.arm, muscles=[replace(m, max_isometric_force=9e5) for m in short.arm.muscles])
    with pytest.raises(TaskError, match=r"strength 10 gives a muscle of the arm .* 9e\+06 N: "):
        MakeStaticLoop(replace(short, arm=strong), perturbations=[Strength(10.0)])


def test_fields_are_checked_in_python_too():
    with pytest.raises(ValidationError):
        ExtraLoad(-1.0)
