"""The option `reset_mask` of Gymnasium's vector environments: which of them a reset starts."""

from typing import Any

import numpy as np

from drakearm.errors import TrainingError, shown


def reset_mask(options: dict[str, Any], num_envs: int) -> np.ndarray:
    """Which environments a reset with these options starts, (N,), bool. Raises TrainingError for another mask."""
    mask = options.get("reset_mask")
    if mask is None:
        return np.ones(num_envs, dtype=bool)
    if not (isinstance(mask, np.ndarray) and mask.shape == (num_envs,) and mask.dtype == bool and mask.any()):
        raise TrainingError(f"The reset_mask is {shown(mask)}: expected an array ({num_envs},) of bool, some true.")
    return mask
