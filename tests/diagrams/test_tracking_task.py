"""The task's start as Drake's default and random states, muscles that start in equilibrium, and refused states."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.common import RandomGenerator
from pydrake.systems.analysis import MonteCarloSimulation, Simulator
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams import AddMuscleArm, MakeSimulator, MakeTrackingTask
from drakearm.errors import StateError
from drakearm.task import ReferenceStart

POSTURE = np.deg2rad([-20.0, 80.0])


def make_arm(arm, time_step):
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm, time_step=time_step)
    builder.ExportInput(muscle_arm.muscles.GetInputPort("excitation"), "excitation")
    return builder.Build(), muscle_arm


def muscle_state(muscle_arm, context):
    own = muscle_arm.muscles.GetMyContextFromRoot(context)
    if muscle_arm.muscles.time_step > 0.0:
        return own.get_discrete_state(0).value().copy()
    return own.get_continuous_state_vector().CopyToVector()


@pytest.mark.parametrize("time_step", [0.0, 1e-3])
def test_muscles_start_in_equilibrium_with_the_plant_by_default(arm, time_step):
    """It is enough to set the positions of the plant. A muscle state that the user sets is kept."""
    diagram, muscle_arm = make_arm(arm, time_step)
    expected = diagram.CreateDefaultContext()
    muscle_arm.SetState(expected, POSTURE)
    for activation in (None, 0.3):
        simulator = Simulator(diagram)
        context = simulator.get_mutable_context()
        diagram.GetInputPort("excitation").FixValue(context, np.zeros(14))
        muscle_arm.plant.SetPositions(muscle_arm.plant.GetMyMutableContextFromRoot(context), POSTURE)
        if activation is not None:
            muscle_arm.SetState(expected, POSTURE, activation=activation)
            muscle_arm.SetState(context, POSTURE, activation=activation)
        simulator.Initialize()
        np.testing.assert_array_equal(muscle_state(muscle_arm, context), muscle_state(muscle_arm, expected))


@pytest.mark.parametrize("time_step", [0.0, 1e-3])
def test_an_excitation_that_is_not_finite_is_refused(arm, time_step):
    diagram, muscle_arm = make_arm(arm, time_step)
    simulator = MakeSimulator(diagram)
    context = simulator.get_mutable_context()
    muscle_arm.SetState(context, POSTURE)
    excitation = np.full(14, 0.1)
    excitation[arm.muscle_names.index("BRA")] = np.nan
    diagram.GetInputPort("excitation").FixValue(context, excitation)
    with pytest.raises(StateError, match="excitation of BRA is not finite"):
        simulator.AdvanceTo(0.01)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"q": np.zeros(3)}, "joint angles .* expected 2 finite numbers"),
        ({"q": np.zeros(2), "v": np.zeros(1)}, "joint speeds .* expected 2 finite numbers"),
        ({"q": np.array([0.0, np.nan])}, "joint angles .* expected 2 finite numbers"),
        ({"q": np.zeros(2), "activation": np.zeros(3)}, "activations .* expected 14 finite numbers"),
        ({"q": np.zeros(2), "activation": np.nan}, "The activation is nan: expected a number from 0 to 1"),
        ({"q": np.zeros(2), "activation": -0.5}, "The activation is -0.5: expected a number from 0 to 1"),
        (
            {"q": np.zeros(2), "activation": np.linspace(0.0, 1.5, 14)},
            "The activation of ECRB is 1.038: expected a number from 0 to 1",
        ),
    ],
)
def test_a_state_of_the_wrong_size_is_refused(arm, arguments, sentence):
    diagram, muscle_arm = make_arm(arm, 1e-3)
    with pytest.raises(StateError, match=sentence):
        muscle_arm.SetState(diagram.CreateDefaultContext(), **arguments)


def test_the_default_context_is_the_start_without_noise(task):
    diagram, systems = MakeTrackingTask(replace(task, start=ReferenceStart(noise=0.2)))
    plant = systems.arm.plant
    q = plant.GetPositions(plant.GetMyContextFromRoot(diagram.CreateDefaultContext()))
    np.testing.assert_array_equal(q, task.reference.q[0])


def test_monte_carlo_draws_different_starts(task):
    """The posture has the noise of the task. The muscles are in equilibrium there, so fibers do not move suddenly."""
    noise = 0.05
    first_q, first_speed = [], []

    def make_simulator(generator):
        diagram, systems = MakeTrackingTask(replace(task, start=ReferenceStart(noise=noise)))
        simulator = MakeSimulator(diagram)
        diagram.GetInputPort("actions").FixValue(simulator.get_mutable_context(), np.full(14, 0.05))

        def monitor(context):
            if context.get_time() == 0.0:
                plant, muscles = systems.arm.plant, systems.arm.muscles
                first_q.append(plant.GetPositions(plant.GetMyContextFromRoot(context)))
                velocity = muscles.GetOutputPort("fiber_velocity").Eval(muscles.GetMyContextFromRoot(context))
                first_speed.append(np.abs(velocity).max())

        simulator.set_monitor(monitor)
        return simulator

    def output(diagram, context):
        return diagram.GetOutputPort("tracking_error").Eval(context)[1]

    results = MonteCarloSimulation(make_simulator, output, 0.02, 12, RandomGenerator(0))
    assert len({result.output for result in results}) == 12
    deviation = np.array(first_q) - task.reference.q[0]
    assert 0.3 * noise < deviation.std() < 3.0 * noise
    assert max(first_speed) == 0.0
