"""Limbs from the files of OpenSim and MuJoCo."""

from drakearm.importing.folder import write_limb
from drakearm.importing.limb import ImportedLimb, import_limb, limb_name
from drakearm.importing.report import what_to_know

__all__ = ["ImportedLimb", "import_limb", "limb_name", "what_to_know", "write_limb"]
