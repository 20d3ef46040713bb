"""drakearm: a human arm with Hill-type muscles in Drake; plan with optimal control, learn excitations with PPO."""

from pathlib import Path

from gymnasium.envs.registration import register

# In a checkout `systems` and `diagrams` stand beside this folder; Python started there imports the checkout itself.
_checkout = Path(__file__).parent.parent
if (_checkout / "pyproject.toml").is_file():
    __path__.append(str(_checkout))

register(
    id="drakearm/Track-v0",
    entry_point="drakearm.experiments.environments:make_env",
    vector_entry_point="drakearm.experiments.environments:make_vector_env",
)
