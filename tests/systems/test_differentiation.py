"""The continuous muscle arm in AutoDiffXd: derivatives of every equation, conversion of the Diagram, linearization."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.autodiffutils import AutoDiffXd, ExtractGradient, ExtractValue, InitializeAutoDiff
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import Linearize
from scipy.optimize import least_squares

from drakearm.diagrams import AddMuscleArm
from drakearm.errors import DerivativeError
from drakearm.model.joint_stops import HARDENING
from drakearm.systems import HillMuscles, JointStops
from tests.coupled_arm import with_tensor_paths

KINDS = [(model, tendon) for model in ("thelen2003", "degroote2016") for tendon in ("compliant", "rigid")]


def with_muscles(arm, model, tendon):
    """The arm with this model and tendon. Rigid tendons are made shorter, because they must not exceed their paths."""
    muscles = [
        replace(
            m,
            model=model,
            tendon=tendon,
            tendon_slack_length=m.tendon_slack_length * (0.97 if tendon == "rigid" else 1),
        )
        for m in arm.muscles
    ]
    return replace(arm, muscles=tuple(muscles))


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize(("model", "tendon"), KINDS)
def test_gradients_of_every_output_and_of_the_state_agree_with_differences(arm, model, tendon, coupled):
    muscles = HillMuscles(with_muscles(with_tensor_paths(arm, 1e-3) if coupled else arm, model, tendon), 0.0)
    n, n_q = 14, 2
    rng = np.random.default_rng(0)
    q = np.array([0.2, 1.1])
    start = muscles.CreateDefaultContext()
    muscles.SetEquilibrium(start, q, 0.3)
    fiber = start.get_continuous_state_vector().CopyToVector()[n:]
    point = np.concatenate([rng.uniform(0.1, 0.8, n), fiber * 1.01, rng.uniform(0.1, 0.9, n), q, [0.5, -0.7]])
    names = ["generalized_force", "activation", "fiber_length", "fiber_velocity", "tendon_force", "mtu_length"]

    def evaluate(system, x):
        context = system.CreateDefaultContext()
        context.SetContinuousState(x[: 2 * n])
        system.GetInputPort("excitation").FixValue(context, x[2 * n : 3 * n])
        system.GetInputPort("arm_state").FixValue(context, x[3 * n :])
        values = [system.GetOutputPort(name).Eval(context) for name in names]
        return np.concatenate([system.EvalTimeDerivatives(context).CopyToVector(), *values])

    differentiated = evaluate(muscles.ToAutoDiffXd(), InitializeAutoDiff(point).ravel())
    np.testing.assert_allclose(ExtractValue(differentiated).ravel(), evaluate(muscles, point), rtol=1e-12)
    gradient = ExtractGradient(differentiated)
    for k in range(3 * n + 2 * n_q):
        step = np.zeros_like(point)
        step[k] = 1e-7
        ahead, behind = evaluate(muscles, point + step), evaluate(muscles, point - step)
        numeric = (ahead - behind) / 2e-7
        np.testing.assert_allclose(gradient[:, k], numeric, rtol=2e-4, atol=2e-4 * max(1.0, np.abs(numeric).max()))


def make_arm(arm, time_step=0.0):
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm, time_step=time_step)
    builder.ExportInput(muscle_arm.muscles.GetInputPort("excitation"), "excitation")
    return builder.Build(), muscle_arm


def equilibrium(arm, excitation):
    """The Diagram, and its context at joint angles at which the muscles balance gravity."""
    diagram, muscle_arm = make_arm(arm)
    context = diagram.CreateDefaultContext()
    diagram.GetInputPort("excitation").FixValue(context, excitation)

    def acceleration(q):
        muscle_arm.SetState(context, q, activation=excitation)
        return diagram.EvalTimeDerivatives(context).CopyToVector()[2:4]

    q = least_squares(acceleration, [-0.3, 1.0], bounds=([-1.0, 0.1], [0.5, 2.2]), xtol=1e-15, ftol=1e-15).x
    assert np.abs(acceleration(q)).max() < 1e-8
    return diagram, context


@pytest.mark.parametrize("model", ["thelen2003", "degroote2016"])
def test_diagram_converts_and_its_linearization_agrees_with_differences(arm, model):
    """The linearization lies between the differences ahead and behind, which are equal except at a kink.

    At rest the activation dynamics has a kink, and Thelen's force-velocity curve too. There the linearization takes one
    side.
    """
    excitation = np.full(14, 0.02)
    excitation[5] = 0.15
    diagram, context = equilibrium(with_muscles(arm, model, "compliant"), excitation)
    linear = Linearize(diagram, context, equilibrium_check_tolerance=1e-4)
    x0 = context.get_continuous_state_vector().CopyToVector()
    assert linear.A().shape == (32, 32) and linear.B().shape == (32, 14)

    def rates(x):
        context.SetContinuousState(x)
        return diagram.EvalTimeDerivatives(context).CopyToVector()

    smooth = 0
    for k in range(32):
        step = 1e-7 * np.eye(32)[k]
        ahead, behind = (rates(x0 + step) - rates(x0)) / 1e-7, (rates(x0) - rates(x0 - step)) / 1e-7
        tolerance = 1e-4 * max(1.0, np.abs(ahead).max(), np.abs(behind).max())
        assert (linear.A()[:, k] >= np.minimum(ahead, behind) - tolerance).all()
        assert (linear.A()[:, k] <= np.maximum(ahead, behind) + tolerance).all()
        smooth += np.allclose(ahead, behind, rtol=1e-2, atol=tolerance)
    assert smooth >= (18 if model == "degroote2016" else 2)  # all but the activations; q and v at least


def test_discrete_arm_converts_but_refuses_to_step(arm):
    diagram, _ = make_arm(arm, time_step=1e-3)
    converted = diagram.ToAutoDiffXd()
    context = converted.CreateDefaultContext()
    converted.GetInputPort("excitation").FixValue(context, np.array([AutoDiffXd(0.1)] * 14))
    with pytest.raises(DerivativeError, match="time_step = 0"):
        converted.EvalUniquePeriodicDiscreteUpdate(context)


def test_output_without_derivatives_is_refused(arm):
    muscles = HillMuscles(arm, 0.0).ToAutoDiffXd()
    with pytest.raises(DerivativeError, match="metabolic_power"):
        muscles.GetOutputPort("metabolic_power").Eval(muscles.CreateDefaultContext())


def test_stops_have_known_derivatives():
    stops = JointStops([-1.0, 0.0], [1.0, 2.0], 0.0)
    differentiated = stops.ToAutoDiffXd()
    context = differentiated.CreateDefaultContext()
    differentiated.GetInputPort("arm_state").FixValue(context, InitializeAutoDiff([1.1, -0.05, 0.2, 0.1]).ravel())
    tau = differentiated.GetOutputPort("generalized_force").Eval(context)
    upper, lower = (0.1 / HARDENING) ** 2, (0.05 / HARDENING) ** 2
    np.testing.assert_allclose(ExtractValue(tau).ravel(), [-500 * (1 + upper) - 2, 250 * (1 + lower) - 1])
    expected = [[-5000 * (1 + 3 * upper), 0, -10, 0], [0, -5000 * (1 + 3 * lower), 0, -10]]
    np.testing.assert_allclose(ExtractGradient(tau), expected, atol=1e-9)
