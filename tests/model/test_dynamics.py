"""The compiled equations of motion agree with the plant from which they are derived."""

import numpy as np
import pytest
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint, SpatialInertia, UnitInertia

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


def make_double_pendulum():
    """1 kg at the ends of two massless links of 1 m that hang down, in gravity of 10 m/s^2."""
    plant = MultibodyPlant(0.0)
    parent, p_PJ = plant.world_body(), (0.0, 0.0, 0.0)
    for name in ("first", "second"):
        link = plant.AddRigidBody(name, SpatialInertia(1.0, (0.0, -1.0, 0.0), UnitInertia(1.0, 0.0, 1.0)))
        frame = plant.AddFrame(FixedOffsetFrame(f"{name}_joint", parent.body_frame(), RigidTransform(p_PJ)))
        plant.AddJoint(RevoluteJoint(name, frame, link.body_frame(), (0.0, 0.0, 1.0)))
        parent, p_PJ = link, (0.0, -1.0, 0.0)
    plant.mutable_gravity_field().set_gravity_vector((0.0, -10.0, 0.0))
    plant.Finalize()
    return plant


def test_table_of_a_double_pendulum():
    """The example in the docstring of `DynamicsTable`."""
    expected = {
        "mass_entry": [[0, 0], [0, 1], [1, 1], [0, 0], [0, 1]],
        "mass_basis": [[0, 0], [0, 0], [0, 0], [0, 1], [0, 1]],
        "mass_coefficient": [3, 1, 1, 2, 1],
        "gravity_entry": [0, 1, 0, 0, 1],
        "gravity_basis": [[1, 2], [1, 2], [2, 0], [2, 1], [2, 1]],
        "gravity_coefficient": [-10, -10, -20, -10, -10],
        "mass_product": [0, 0, 0, 5, 5],
        "gravity_product": [9, 9, 2, 10, 10],
        "factors": [[1, 6], [2, 5]],
        "slope_entry": [[0, 0, 1], [0, 1, 1]],
        "slope_term": [[0, 3, 6, -1], [1, 4, 6, -1]],
    }
    found = read_dynamics(make_double_pendulum())
    assert list(expected) == list(found._fields)
    for name, values in expected.items():
        np.testing.assert_allclose(getattr(found, name), values, atol=1e-13, err_msg=name)


def test_a_double_pendulum_falls_as_its_equations_say():
    """Also those that the docstring of `DynamicsTable` gives."""
    q, v, tau = np.array([[0.4, -1.1], [2.0, -3.0], [5.0, 1.0]])
    mass = np.array([[3 + 2 * np.cos(q[1]), 1 + np.cos(q[1])], [1 + np.cos(q[1]), 1]])
    gravity = np.array([-20 * np.sin(q[0]) - 10 * np.sin(q.sum()), -10 * np.sin(q.sum())])
    coriolis = np.sin(q[1]) * np.array([-2 * v[0] * v[1] - v[1] ** 2, v[0] ** 2])
    a = forward_dynamics(q, v, tau, read_dynamics(make_double_pendulum()))
    np.testing.assert_allclose(mass @ a + coriolis, tau + gravity, atol=1e-12)


def test_the_same_plant_gives_the_same_table_bit_for_bit(arm):
    first, second = (read_dynamics(MakeTorqueArm(arm, 2.0)) for _ in range(2))
    for name, table in first._asdict().items():
        np.testing.assert_array_equal(table, getattr(second, name))


def test_skeletons_side_by_side_are_those_of_their_tables(arm):
    """Also with different coefficients, and if one table lacks terms that another has."""
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
