"""Small limbs that are written from points, for tests: the folder of an arm with one joint, or with two branches."""

from pathlib import Path

import yaml

WORLD = '<link name="base"/><joint name="socket" type="fixed"><parent link="world"/><child link="base"/></joint>'


def link(name, mass=1.0, length=0.3):
    """A rod that hangs from the origin of its frame."""
    about = mass * length**2 / 12.0
    return (
        f'<link name="{name}"><inertial><origin xyz="0 0 {-length / 2}"/><mass value="{mass}"/><inertia ixx="{about}" '
        f'iyy="{about}" izz="{mass * 1e-4}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def hinge(name, parent, child, at=(0, 0, 0), axis=(0, -1, 0), limits=(0.0, 2.4)):
    x, y, z = at
    kind = '"revolute"' if limits else '"continuous"'
    limit = f'<limit lower="{limits[0]}" upper="{limits[1]}" effort="100" velocity="30"/>' if limits else ""
    return (
        f'<joint name="{name}" type={kind}><parent link="{parent}"/><child link="{child}"/><origin xyz="{x} {y} {z}"/>'
        f'<axis xyz="{axis[0]} {axis[1]} {axis[2]}"/>{limit}</joint>'
    )


ELBOW = (WORLD, link("forearm"), hinge("elbow", "base", "forearm"))  # turns about the negative y axis of the world
ROLL = {"name": "roll", "type": "cylinder", "body": "base", "center": [0, 0, 0], "axis": [0, 1, 0], "radius": 0.02}


def muscle(name, points, **fields):
    return {
        "name": name,
        "max_isometric_force": 500.0,
        "optimal_fiber_length": 0.1,
        "pennation_angle": 0.0,
        "points": [list(point) for point in points],
        **fields,
    }


FLEXOR = muscle("flexor", [("base", [0.03, 0, 0.25]), ("forearm", [0.03, 0, -0.05])])
EXTENSOR = muscle("extensor", [("base", [-0.03, 0, 0.25]), ("forearm", [-0.03, 0, -0.02])], wraps=["roll"])


def write_limb(folder: Path, muscles=(FLEXOR, EXTENSOR), surfaces=(ROLL,), skeleton=ELBOW, tip="forearm", **fields):
    """Writes a muscles.yaml and its skeleton.urdf, and returns the folder."""
    folder.mkdir(exist_ok=True)
    (folder / "skeleton.urdf").write_text(f'<robot name="limb">{"".join(skeleton)}</robot>')
    content = {
        "name": "limb",
        "skeleton": "skeleton.urdf",
        "tip_frame": tip,
        "muscles": list(muscles),
        "surfaces": list(surfaces),
        **fields,
    }
    (folder / "muscles.yaml").write_text(yaml.safe_dump(content))
    return folder


FORK = (  # a trunk with two fingers, whose axes are not parallel
    WORLD,
    link("trunk", 1.5, 0.3),
    hinge("wrist", "base", "trunk", axis=(0, 1, 0.2), limits=(-1, 1)),
    link("left", 0.6, 0.2),
    hinge("left_finger", "trunk", "left", (0, 0.03, -0.2), (0, 1, 0), (-1, 1)),
    link("right", 0.7, 0.2),
    hinge("right_finger", "trunk", "right", (0, -0.03, -0.2), (0.3, 1, 0), (-1, 1)),
)


def write_fork(folder: Path):
    """A tree: two flexors and two extensors of two fingers, one of them over the wrist too, and two of the wrist."""

    def pair(joint, parent, child, at, force, x):
        y, z = at
        return [
            muscle(
                f"{joint}_{side}",
                [(parent, [sign * x, y, z + 0.08]), (child, [sign * x, 0, -0.03])],
                max_isometric_force=force,
                optimal_fiber_length=0.05,
            )
            for side, sign in (("flexor", -1), ("extensor", 1))
        ]

    muscles = (
        *pair("wrist", "base", "trunk", (0.0, 0.0), 300.0, 0.02),
        *pair("left", "trunk", "left", (0.03, -0.2), 60.0, 0.01),
        *pair("right", "trunk", "right", (-0.03, -0.2), 60.0, 0.01),
        muscle(
            "long",
            [("base", [-0.02, 0, 0.1]), ("trunk", [-0.02, 0, -0.1]), ("left", [-0.01, 0, -0.03])],
            max_isometric_force=60.0,
        ),
    )
    return write_limb(folder, muscles, (), FORK, "left")
