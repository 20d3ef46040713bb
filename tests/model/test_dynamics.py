"""The compiled equations of motion agree with the plant they were read off."""

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drakearm.errors import ArmError
from drakearm.model import MakeTorqueArm
from drakearm.model.dynamics import forward_dynamics, forward_dynamics_lanes, make_dynamics_lanes
from drakearm.model.dynamics_table import read_dynamics, stack_dynamics

from ..chains import make_chain


def assert_same_accelerations(plant, seed=0):
    rng = np.random.default_rng(seed)
    table = read_dynamics(plant)
    context = plant.CreateDefaultContext()
    worst = 0.0
    for _ in range(100):
        q, v, tau = rng.uniform(-3.0, 3.0, (3, plant.num_positions())) * [[1.0], [5.0], [10.0]]
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        plant.get_applied_generalized_force_input_port().FixValue(context, tau)
        expected = plant.get_generalized_acceleration_output_port().Eval(context)
        worst = max(worst, np.abs(forward_dynamics(q, v, tau, table) - expected).max() / np.abs(expected).max())
    print(f"largest relative error {worst:.1e}")
    assert worst < 1e-11


@pytest.mark.parametrize("load", [0.0, 5.0])
def test_arm(arm, load):
    assert_same_accelerations(MakeTorqueArm(arm, load))


@pytest.mark.parametrize("joints", [1, 3, 4])
def test_any_chain_of_revolute_joints(joints):
    assert_same_accelerations(make_chain(joints))


def test_skeletons_side_by_side_are_those_of_their_tables(arm):
    """With different coefficients, and with terms that one of them lacks."""
    empty, loaded = (read_dynamics(MakeTorqueArm(arm, load)) for load in (0.0, 5.0))
    none = {name: getattr(empty, name)[:0] for name in empty._fields if name.startswith("gravity")}
    tables = [empty, empty._replace(**none), loaded]
    stacked = stack_dynamics(tables)
    mass_coefficient, gravity_coefficient = (
        coefficients.reshape(3, -1).T.copy() for coefficients in (stacked.mass_coefficient, stacked.gravity_coefficient)
    )
    work = make_dynamics_lanes(stacked, 2, lanes=3)
    state, a = np.random.default_rng(0).uniform(-2.0, 2.0, (4, 3)), np.ones((2, 3))
    forward_dynamics_lanes(state, a, stacked, mass_coefficient, gravity_coefficient, work)
    for k, table in enumerate(tables):
        expected = forward_dynamics(state[:2, k].copy(), state[2:, k].copy(), np.ones(2), table)
        np.testing.assert_allclose(a[:, k], expected, rtol=1e-12)


def test_sliding_joint_is_refused():
    plant = MultibodyPlant(0.0)
    urdf = """<robot name="slider"><link name="turntable"><inertial><mass value="1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <link name="slide"><inertial><mass value="1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="turn" type="continuous"><parent link="world"/><child link="turntable"/><axis xyz="0 0 1"/></joint>
        <joint name="move" type="prismatic"><parent link="turntable"/><child link="slide"/><axis xyz="1 0 0"/></joint>
        </robot>"""
    Parser(plant).AddModelsFromString(urdf, "urdf")
    plant.Finalize()
    with pytest.raises(ArmError, match="revolute"):
        read_dynamics(plant)
