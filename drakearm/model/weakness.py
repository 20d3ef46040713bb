"""Why muscles cannot exert a joint torque, in words."""


def weakness(joint: str, missing: float, required: float) -> str:
    """A part of a sentence: which torque a joint lacks, or what acts on it instead of the torque that it needs.

    missing: Nm, what remains of the required torque (Nm) at best. If this is more than the required torque, or has the
    other sign, then the muscles are not too weak: forces that they cannot switch off, or that another joint needs, act
    on the joint.
    """
    if abs(missing) <= abs(required) and missing * required > 0.0:
        return f"the {joint} lacks {abs(missing):.3g} Nm of the {abs(required):.3g} Nm that it needs"
    needed = required if abs(required) > 1e-6 * abs(missing) else 0.0
    return (
        f"passive forces, or muscles for another joint, exert {required - missing:.3g} Nm on the {joint}, which needs "
        f"{needed:.3g} Nm"
    )
