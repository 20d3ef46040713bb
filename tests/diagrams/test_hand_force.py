"""A force on the hand: the arm accelerates as Drake says, and no controller knows it."""

from dataclasses import fields, replace

import numpy as np
import pytest
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams import AddMuscleArm, HandForce, MakeStaticLoop
from drakearm.diagrams.perturbation import perturb_plant
from drakearm.errors import TaskError


def acceleration(arm, q, v, perturbations=(), force=None):
    """The accelerations of the joints at q and v. force: on the tip, N, through Drake's own input port."""
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm)
    perturb_plant(builder, muscle_arm, perturbations)
    builder.ExportInput(muscle_arm.muscles.GetInputPort("excitation"), "excitation")
    diagram, plant = builder.Build(), muscle_arm.plant
    context = diagram.CreateDefaultContext()
    diagram.GetInputPort("excitation").FixValue(context, np.full(len(arm.muscles), 0.1))
    muscle_arm.SetState(context, q, v)
    if force is not None:
        tip, applied = plant.GetFrameByName(arm.tip_frame), ExternallyAppliedSpatialForce()
        applied.body_index = tip.body().index()
        applied.p_BoBq_B = tip.GetFixedPoseInBodyFrame().translation()
        applied.F_Bq_W = SpatialForce(np.zeros(3), force)
        plant.get_applied_spatial_force_input_port().FixValue(plant.GetMyContextFromRoot(context), [applied])
    return plant.get_generalized_acceleration_output_port().Eval(plant.GetMyContextFromRoot(context))


@pytest.fixture(scope="module")
def short(task):
    """The first 0.1 s of the task."""
    parts = {field.name: getattr(task.reference, field.name)[:11] for field in fields(task.reference)}
    return replace(task, reference=replace(task.reference, **parts))


def test_it_acts_as_a_force_of_drake_on_the_tip(arm):
    q, v, force = np.array([0.2, 1.3]), np.array([1.0, -2.0]), np.array([3.0, -7.0, 1.0])
    found = acceleration(arm, q, v, [HandForce(lambda t, p, v: force)])
    np.testing.assert_allclose(found, acceleration(arm, q, v, force=force), rtol=1e-9)
    assert np.abs(found - acceleration(arm, q, v)).max() > 1.0


def test_several_forces_add_up(arm):
    q, v = np.array([0.2, 1.3]), np.array([1.0, -2.0])
    one, other = np.array([3.0, -7.0, 1.0]), np.array([-1.0, 2.0, 0.0])
    both = [HandForce(lambda t, p, v: one), HandForce(lambda t, p, v: other)]
    together = acceleration(arm, q, v, [HandForce(lambda t, p, v: one + other)])
    np.testing.assert_allclose(acceleration(arm, q, v, both), together, rtol=1e-9)


def test_it_gets_the_time_and_the_motion_of_the_hand(short):
    seen = {}
    force = HandForce(lambda t, p, v: seen.update({round(t, 6): (p, v)}) or np.zeros(3))
    recording = MakeStaticLoop(short, perturbations=[force]).Run()
    for t, p, v in zip(recording.t, recording.p_WH, recording.v_WH, strict=True):
        np.testing.assert_allclose(seen[round(t, 6)], (p, v), atol=1e-3)


def test_a_force_of_another_size_is_refused(arm):
    with pytest.raises(TaskError, match="expected 3 finite numbers"):
        acceleration(arm, np.array([0.2, 1.3]), np.zeros(2), [HandForce(lambda t, p, v: np.zeros(2))])
