"""The shipped scenarios, by what they move."""

from drakearm.experiments import load_scenario, scenario_files

PAPER = [name for name in scenario_files() if load_scenario(name).arm == "arm14"]  # the movements of the paper
OTHER_LIMBS = [name for name in scenario_files() if name not in PAPER]
