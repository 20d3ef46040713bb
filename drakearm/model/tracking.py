"""The reward for following a reference, compiled: every environment shares it."""

from drakearm.muscle.compiled import compiled


@compiled
def tracking_reward(q, v, a, reference_q, reference_v, w_q, w_v, w_a):
    """Minus the weighted squares of position errors, velocity errors and accelerations (eq. 6); all arrays (n_q,)."""
    reward = 0.0
    for i in range(len(q)):
        reward -= w_q[i] * (reference_q[i] - q[i]) ** 2
        reward -= w_v[i] * (reference_v[i] - v[i]) ** 2
        reward -= w_a[i] * a[i] ** 2
    return reward
