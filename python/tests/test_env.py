"""One environment, and Gymnasium's registry."""

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import footwork

SINGLE = [name.capitalize() for name in footwork.TASKS if name != "box"]


@pytest.mark.parametrize("name", SINGLE)
def test_gymnasiums_checker_has_nothing_to_say(name, motion):
    data = {"data": motion} if name in ("Plane", "Obstacles") else {}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make(f"footwork/{name}-v0", **data)
        check_env(env.unwrapped)


def test_batches_are_made_by_name(motion):
    envs = gymnasium.make_vec("footwork/Plane-v0", num_envs=3, data=motion)
    assert isinstance(envs.unwrapped, footwork.VectorEnv) and envs.num_envs == 3
    assert gymnasium.make_vec("footwork/Box-v0", num_envs=2).num_envs == 2
    with pytest.raises(gymnasium.error.Error):
        gymnasium.make("footwork/Box-v0")


def test_an_episode_ends_with_what_is_known_of_it(motion):
    env = gymnasium.make("footwork/Plane-v0", data=motion, task={"max_steps": 4})
    first, _ = env.reset(seed=5)
    for step in range(4):
        observation, _, terminated, truncated, info = env.step(np.zeros(12, np.float32))
        assert truncated == (step == 3) and not terminated
    assert info["episode_length"] == 4.0 and info["success"] == 0.0
    with pytest.raises(ValueError, match="reset it first"):
        env.unwrapped.step(np.zeros(12, np.float32))
    following, _ = env.reset()
    assert not np.array_equal(following, first) and not np.array_equal(following, observation)


def test_actions_are_checked(motion):
    env = footwork.Env("plane", data=motion)
    env.reset()
    with pytest.raises(ValueError, match=r"of the shape \(12,\), not \(3,\)"):
        env.step(np.zeros(3, np.float32))
    with pytest.raises(TypeError, match="not of float64"):
        env.step(np.zeros(12))
