"""Pictures from the environments: what Gymnasium expects, and an arm that moves in them."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from drakearm.errors import TrainingError
from drakearm.experiments import make_env


@pytest.mark.slow
def test_pictures_show_the_arm_where_it_is():
    env = gymnasium.make("drakearm/Track-v0", scenario="obstacle", render_mode="rgb_array")
    env.reset(seed=0)
    first = env.render()
    assert first.dtype == np.uint8 and first.ndim == 3 and first.shape[2] == 3
    np.testing.assert_array_equal(env.render(), first)
    red = []
    for _ in range(20):
        env.step(np.full(14, 0.9, np.float32))
        picture = env.render().astype(int)
        red.append(int(np.sum(picture[..., 0] > picture[..., 1] + 90)))
    assert (env.render() != first).any()
    assert red[-1] > red[0] + 200  # the muscles become red, and so does more of the picture
    check_env(env.unwrapped, skip_render_check=False)


def test_without_a_mode_there_is_no_picture():
    env = make_env("reach-000")
    env.reset(seed=0)
    assert env.render_mode is None and env.render() is None
    with pytest.raises(TrainingError, match="render mode is 'ansi': expected one of human, rgb_array"):
        make_env("reach-000", render_mode="ansi")


def test_the_arm_moves_in_meshcat(caplog):
    with caplog.at_level("INFO", logger="drakearm"):
        env = make_env("reach-000", render_mode="human")
    assert "http://localhost" in caplog.text
    env.reset(seed=0)
    env.step(np.full(14, 0.3))
    assert env.render() is None
