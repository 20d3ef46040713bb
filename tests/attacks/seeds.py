"""The valid files that mutations start from: an arm with one joint and two muscles, and a run of a short movement."""

from pathlib import Path

import yaml

from drakearm.experiments import RunFolder, evaluate_step, plan_step, train_step

_SKELETON = """<?xml version="1.0"?>
<robot name="limb">
  <link name="base"/>
  <joint name="shoulder_weld" type="fixed"><parent link="world"/><child link="base"/></joint>
  <link name="forearm">
    <inertial>
      <origin xyz="0 -0.15 0"/>
      <mass value="1.5"/>
      <inertia ixx="0.02" iyy="0.002" izz="0.02" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual>
      <origin xyz="0 -0.15 0" rpy="1.57 0 0"/>
      <geometry><capsule radius="0.02" length="0.28"/></geometry>
      <material name="bone"><color rgba="0.9 0.9 0.8 1"/></material>
    </visual>
  </link>
  <joint name="elbow" type="revolute">
    <parent link="base"/>
    <child link="forearm"/>
    <origin xyz="0 0 0" rpy="0 0 0"/>
    <axis xyz="0 0 1"/>
    <limit lower="0" upper="2.3" effort="100" velocity="20"/>
  </joint>
  <link name="hand"/>
  <joint name="wrist" type="fixed">
    <parent link="forearm"/>
    <child link="hand"/>
    <origin xyz="0 -0.3 0"/>
  </joint>
</robot>
"""


def _muscle(name: str, length: float, moment_arm: float) -> dict:
    """A muscle whose path has this length (m) at 0 rad and this moment arm (m) everywhere."""
    return {
        "name": name,
        "max_isometric_force": 900.0,
        "optimal_fiber_length": 0.12,
        "tendon_slack_length": 0.2,
        "pennation_angle": 0.1,
        "path": [
            {
                "coordinate": "elbow",
                "knots": [-1.0, -1.0, 3.0, 3.0],
                "coefficients": [length + moment_arm, length - 3.0 * moment_arm],
            }
        ],
        "points": [["base", [0.0, 0.1, 0.0]], ["forearm", [moment_arm, -0.05, 0.0]]],
    }


_MUSCLES = {
    "name": "limb",
    "skeleton": "skeleton.urdf",
    "gravity": [0.0, -9.81, 0.0],
    "coordinates": ["elbow"],
    "load_frame": "hand",
    "tip_frame": "hand",
    "outline": [{"name": "forearm", "radius": 0.02, "ends": [["forearm", [0, 0, 0]], ["forearm", [0, -0.3, 0]]]}],
    "defaults": {
        "max_contraction_velocity": 10.0,
        "activation_time": 0.01,
        "deactivation_time": 0.04,
        "minimum_activation": 0.01,
        "tendon_strain": 0.033,
        "passive_strain": 0.6,
        "passive_shape": 4.0,
        "active_width": 0.5,
        "force_velocity_shape": 0.3,
        "eccentric_force": 1.8,
        "model": "thelen2003",
        "tendon": "compliant",
        "specific_tension": 250000.0,
        "slow_twitch_fraction": 0.5,
    },
    "muscles": [_muscle("flexor", 0.36, 0.03), _muscle("extensor", 0.29, -0.02)],
}

_SCENARIO = {
    "name": "short",
    "description": "bend the elbow from 30 to 45 degrees in 0.1 s",
    "arm": "arm",
    "load_mass": 0.5,
    "obstacle": {"position": [0.0, 0.5, 0.0], "axis": [0, 0, 1], "radius": 0.03, "length": 0.2},
    "movement": {
        "start_deg": [30],
        "target_deg": [45],
        "duration": 0.1,
        "end": "rest",
        "hold": 0.02,
        "knots": 7,
        "angle_limit_deg": [[10, 100]],
        "speed_limit": [15],
        "torque_limit": [40],
        "clearance": 0.01,
        "costs": [
            {"type": "posture", "running": 0.1, "final": [0.2]},
            {"type": "torque_rate", "weight": 0.1},
            {"type": "switched_target", "first_deg": [35], "switch_time": 0.05, "weight": 1},
            {"type": "held_joint", "joint": "elbow", "angle_deg": 40, "weight": 1},
            {"type": "obstacle_distance", "weight": 0.1},
        ],
    },
    "success": [
        {"type": "no_contact"},
        {"type": "hand_at_goal", "within": 0.01},
        {"type": "joint_error", "of": "end", "below": 0.1, "joints": ["elbow"]},
    ],
    "tracking": {
        "observation": "full",
        "start_noise_deg": 0.5,
        "reward": {"position": [10], "velocity": [0.1], "acceleration": [1.0e-6]},
    },
    "training": {
        "batches": 1,
        "environments": 2,
        "steps": 6,
        "epochs": 1,
        "minibatches": 2,
        "imitation_rounds": 0,
        "actor_layers": [4, 4],
        "critic_layers": [4],
    },
    "preset": "drakearm",
}


def make_seeds(folder: Path) -> None:
    """Writes the folder: a scenario, its arm, and below `run` the files of its run."""
    arm = folder / "arm"
    arm.mkdir(parents=True)
    (arm / "skeleton.urdf").write_text(_SKELETON)
    (arm / "muscles.yaml").write_text(yaml.safe_dump(_MUSCLES, sort_keys=False))
    scenario = folder / "scenario.yaml"
    scenario.write_text(yaml.safe_dump(_SCENARIO, sort_keys=False))
    run = RunFolder(folder / "run")
    run.folder.mkdir()
    plan_step(run, scenario)
    train_step(run, seed=0)
    evaluate_step(run)
