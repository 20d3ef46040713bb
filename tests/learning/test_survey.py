"""The survey of a task: it sees how observations vary when the arm moves at random."""

import numpy as np

from drakearm.learning.survey import survey


def test_observations_that_vary_more_get_a_smaller_scale(task):
    scaling = survey([task], action=0.15, std=0.3, seed=0)
    places = task.observation.places
    fiber_length, q = scaling.scale[places["fiber_length"]], scaling.scale[places["arm_state"]][:2]
    assert np.median(fiber_length) > 2.0 * q.max()  # angles vary by a radian, fiber lengths by a tenth of their optimum
    np.testing.assert_allclose(scaling.mean[places["activation"]], 0.28, atol=0.1)  # noise is cut off below 0


def test_the_same_seed_gives_the_same_scaling(task):
    one, same, other = (survey([task], action=0.15, std=0.3, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.scale, same.scale)
    assert (one.scale != other.scale).any()
