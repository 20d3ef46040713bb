"""Chains of links that are not the arm, for tests of laws that hold for every chain."""

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant


def make_chain(joints: int) -> MultibodyPlant:
    """A chain of revolute joints. Their axes are not parallel, so that every entry of the mass matrix varies."""
    links = "".join(
        f'<link name="l{i}"><inertial><origin xyz="0.05 {-0.1 - 0.02 * i} 0.03"/><mass value="{1 + i}"/>'
        f'<inertia ixx="0.02" iyy="0.015" izz="0.03" ixy="0.002" ixz="0.001" iyz="0"/></inertial></link>'
        f'<joint name="j{i}" type="continuous"><parent link="{f"l{i - 1}" if i else "world"}"/><child link="l{i}"/>'
        f'<origin xyz="0.02 -0.2 0.01"/><axis xyz="{0.1 * i} {0.3 - 0.2 * i} 1"/></joint>'
        for i in range(joints)
    )
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(f'<robot name="chain">{links}</robot>', "urdf")
    plant.Finalize()
    return plant
