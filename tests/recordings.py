"""Recordings that tests change and then save, draw or measure."""

import numpy as np

from drakearm.model.recording import Recording
from drakearm.model.reference import CONTROL_STEP


def still_recording(samples: int, n_q: int, n: int) -> Recording:
    """An arm with n_q joints and n muscles that does not move: all numbers are 0."""
    joints, muscles, hand = np.zeros((samples, n_q)), np.zeros((samples, n)), np.zeros((samples, 3))
    return Recording(
        t=CONTROL_STEP * np.arange(samples),
        q=joints,
        v=joints,
        reference_q=joints,
        reference_v=joints,
        excitation=muscles,
        activation=muscles,
        fiber_length=muscles,
        fiber_velocity=muscles,
        tendon_force=muscles,
        mtu_length=muscles,
        joint_moment=np.zeros((samples, n, n_q)),
        fiber_power=muscles,
        tendon_power=muscles,
        metabolic_power=muscles,
        p_WH=hand,
        v_WH=hand,
        reward=np.zeros(samples),
    )
