"""The compiled equations of motion agree with the plant they were read off."""

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drakearm.diagrams import MakeTorqueArm
from drakearm.errors import ArmError
from drakearm.model.dynamics import forward_dynamics, read_dynamics


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
    links = "".join(
        f'<link name="l{i}"><inertial><origin xyz="0.05 {-0.1 - 0.02 * i} 0.03"/><mass value="{1 + i}"/>'
        f'<inertia ixx="0.02" iyy="0.01" izz="0.03" ixy="0.002" ixz="0.001" iyz="0"/></inertial></link>'
        f'<joint name="j{i}" type="continuous"><parent link="{f"l{i - 1}" if i else "world"}"/><child link="l{i}"/>'
        f'<origin xyz="0.02 -0.2 0.01"/><axis xyz="{0.1 * i} {0.3 - 0.2 * i} 1"/></joint>'
        for i in range(joints)
    )
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(f'<robot name="chain">{links}</robot>', "urdf")
    plant.Finalize()
    assert_same_accelerations(plant)


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
