"""The batch: Gymnasium's contract, kept by every task in every mode."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import RecordEpisodeStatistics

import footwork

SHORT = {"plane": {"max_steps": 7}, "obstacles": {"max_steps": 7}, "stand": {"episode_s": 0.2}}
"""Tasks of both kinds, with episodes of a few steps."""


def play(envs, actions, steps):
    """Everything that so many steps of the same actions return."""
    return [envs.step(actions) for _ in range(steps)]


def draws(envs, seed=0):
    """Actions as unlike as a policy's at first."""
    random = np.random.default_rng(seed)
    return random.uniform(-0.5, 0.5, envs.action_space.shape).astype(np.float32)


@pytest.mark.parametrize("task", ["plane", "obstacles", "stand", "imitate", "track", "joystick", "punch", "skills"])
def test_every_task_keeps_to_its_spaces(task, make):
    envs = make(task, num_envs=5, seed=3)
    assert isinstance(envs, gymnasium.vector.VectorEnv) and envs.num_envs == 5
    observations, infos = envs.reset(seed=3)
    assert observations.dtype == np.float32 and observations in envs.observation_space and infos == {}
    for _ in range(3):
        observations, rewards, terminations, truncations, _ = envs.step(draws(envs))
        assert observations in envs.observation_space
        assert rewards.shape == terminations.shape == truncations.shape == (5,)
        assert rewards.dtype == np.float32 and terminations.dtype == truncations.dtype == np.bool_
    envs.close()
    with pytest.raises(ValueError, match="closed"):
        envs.reset()


def test_fighters_are_rows_of_the_same_environments(make):
    envs = make("box", num_envs=4)
    assert envs.num_envs == 4
    envs.reset()
    for _ in range(100):
        _, _, terminations, truncations, _ = envs.step(draws(envs))
        ended = (terminations | truncations).reshape(2, 2)
        assert (ended[:, 0] == ended[:, 1]).all(), "an episode ends for both"
    with pytest.raises(ValueError, match="num_envs is 3: it must be a positive multiple of 2"):
        make("box", num_envs=3)


@pytest.mark.parametrize("task", SHORT)
def test_episodes_are_the_same_in_every_mode(task, make):
    """Until an episode's end all modes agree; then each goes on in its own way."""
    modes = {mode: make(task, 3, autoreset_mode=mode, task=SHORT[task]) for mode in AutoresetMode}
    firsts = {mode: envs.reset(seed=1)[0] for mode, envs in modes.items()}
    assert np.array_equal(firsts[AutoresetMode.SAME_STEP], firsts[AutoresetMode.NEXT_STEP])
    assert np.array_equal(firsts[AutoresetMode.SAME_STEP], firsts[AutoresetMode.DISABLED])
    same, following, disabled = (modes[AutoresetMode[name]] for name in ("SAME_STEP", "NEXT_STEP", "DISABLED"))
    actions = draws(same)
    for _ in range(20):
        ours, next_, off = (envs.step(actions) for envs in (same, following, disabled))
        for column in range(1, 4):
            assert np.array_equal(ours[column], next_[column]) and np.array_equal(ours[column], off[column])
        ended = ours[2] | ours[3]
        if ended.any():
            break
        assert np.array_equal(ours[0], next_[0]) and np.array_equal(ours[0], off[0])
    assert ended.any()
    infos = ours[4]
    assert np.array_equal(infos["_final_obs"], ended) and np.array_equal(infos["_final_info"], ended)
    for row in range(3):
        if ended[row]:
            assert np.array_equal(infos["final_obs"][row], next_[0][row])
            assert np.array_equal(infos["final_obs"][row], off[0][row])
            assert not np.array_equal(infos["final_obs"][row], ours[0][row]), "the next episode's first"
        else:
            assert infos["final_obs"][row] is None
            assert np.array_equal(ours[0][row], next_[0][row]) and np.array_equal(ours[0][row], off[0][row])
    assert np.array_equal(infos["final_info"]["episode_length"], next_[4]["episode_length"])
    assert "final_obs" not in next_[4] and "final_obs" not in off[4]

    # The step of a reset: no reward, no end, the first observation of an episode.
    observations, rewards, terminations, truncations, _ = following.step(actions)
    assert (rewards[ended] == 0).all() and not (terminations | truncations)[ended].any()
    assert not np.array_equal(observations[ended], next_[0][ended])

    with pytest.raises(ValueError, match="has ended: reset it first"):
        disabled.step(actions)
    observations, _ = disabled.reset(options={"reset_mask": ended})
    assert np.array_equal(observations[~ended], off[0][~ended])
    assert np.array_equal(observations[ended], ours[0][ended]), "the same episodes follow"
    disabled.step(actions)


@pytest.mark.parametrize("task", SHORT)
def test_episodes_have_their_full_length_and_are_summed_up(task, make):
    envs = RecordEpisodeStatistics(make(task, 6, task=SHORT[task]))
    envs.reset(seed=0)
    limit = {"plane": 7, "obstacles": 7, "stand": 6}[task]
    lengths, returns = [], []
    for _ in range(3 * limit):
        _, _, terminations, truncations, infos = envs.step(draws(envs))
        if "episode" in infos:
            ended = infos["_episode"]
            assert (infos["episode"]["l"][truncations] == limit).all(), "from the first episode on"
            own = infos["final_info"]
            assert np.array_equal(own["episode_length"][ended], infos["episode"]["l"][ended])
            assert np.allclose(own["episode_return"][ended], infos["episode"]["r"][ended], rtol=1e-4, atol=1e-3)
            lengths.extend(infos["episode"]["l"][ended])
            returns.extend(infos["episode"]["r"][ended])
    found = envs.unwrapped.statistics()
    assert found["episodes"] == len(lengths) > 0
    assert np.isclose(found["episode_length"], np.mean(lengths))
    assert np.isclose(found["episode_return"], np.mean(returns), rtol=1e-4)
    assert envs.unwrapped.statistics()["episodes"] == 0, "taken"


@pytest.mark.parametrize("task", SHORT)
def test_a_seed_decides_over_everything(task, make):
    one, other = (make(task, 4, task=SHORT[task]) for _ in range(2))
    for envs in (one, other):
        envs.reset(seed=7)
    actions = draws(one)
    for ours, theirs in zip(play(one, actions, 12), play(other, actions, 12), strict=False):
        assert all(np.array_equal(a, b) for a, b in zip(ours[:4], theirs[:4], strict=False))
    again, _ = one.reset(seed=7)
    assert np.array_equal(again, other.reset(seed=7)[0])
    assert not np.array_equal(again, other.reset(seed=8)[0])
    assert not np.array_equal(again, one.reset()[0]), "other episodes, unless a seed is given"


def test_the_environments_of_a_batch_differ(make):
    observations, _ = make("plane", 8).reset(seed=0)
    assert len(np.unique(observations, axis=0)) == 8


def test_arrays_are_nobody_elses(make):
    envs = make("plane", 3)
    first, _ = envs.reset(seed=0)
    kept = first.copy()
    second, *_ = envs.step(draws(envs))
    second[:] = 0.0
    assert np.array_equal(first, kept) and first.flags.writeable
    third, *_ = envs.step(draws(envs))
    assert third.any()


def test_terminated_is_not_truncated(make):
    envs = make("plane", 64, task={"target_extent": 0.6, "max_steps": 20})
    envs.reset(seed=0)
    terminated = truncated = 0
    for step in range(60):
        _, _, terminations, truncations, infos = envs.step(draws(envs, step))
        assert not (terminations & truncations).any()
        if infos:
            assert np.array_equal(infos["final_info"]["success"] == 1.0, terminations)
        terminated, truncated = terminated + terminations.sum(), truncated + truncations.sum()
    assert terminated > 0 and truncated > 0


def test_a_level_is_passed_by_success(make):
    envs = make("obstacles", 256, task={"success_radius": 2.4, "count": 1, "promotion_success": 0.05})
    assert envs.level == 0
    envs.reset()
    for step in range(120):
        envs.step(draws(envs, step))
    assert envs.level > 0
    hardest = make("obstacles", 2, task={"curriculum": False})
    assert hardest.level == 9
    assert make("plane", 2).level is None


def test_settings_are_those_of_config_toml(make):
    envs = make("plane", 2, task={"max_steps": np.int64(3), "success_radius": np.float32(0.5)})
    envs.reset()
    *_, truncations, _ = play(envs, draws(envs), 3)[-1]
    assert truncations.all()


@pytest.mark.parametrize(
    "error, message, arguments",
    [
        (ValueError, "no task `plan`, did you mean `plane`", {"name": "plan"}),
        (ValueError, "num_envs is 0: it must be a positive multiple of 1", {"name": "plane", "num_envs": 0}),
        (ValueError, "num_envs is -1", {"name": "plane", "num_envs": -1}),
        (ValueError, "seed must be a whole number from 0 to 4294967295, not -1", {"name": "plane", "seed": -1}),
        (ValueError, "not a valid AutoresetMode", {"name": "plane", "autoreset_mode": "never"}),
        (ValueError, 'preset must be "fast" or "paper", not "slow"', {"name": "plane", "preset": "slow"}),
        (
            ValueError,
            "unknown key `task.max_step`, did you mean `max_steps`|max_steps",
            {"name": "plane", "task": {"max_step": 3}},
        ),
        (ValueError, "of the type integer, not string", {"name": "plane", "task": {"max_steps": "3"}}),
        (ValueError, "task.max_steps is 0", {"name": "plane", "task": {"max_steps": 0}}),
        (TypeError, "task.max_steps must be a bool, a number", {"name": "plane", "task": {"max_steps": object()}}),
        (footwork.Error, "nowhere", {"name": "plane", "data": "nowhere.footwork"}),
        (ValueError, "uses no motion", {"name": "stand", "data": "somewhere"}),
        (ValueError, "render_mode must be None", {"name": "plane", "render_mode": "human"}),
    ],
)
def test_what_cannot_be_opened_says_why(error, message, arguments, make):
    with pytest.raises(error, match=message):
        make(**arguments)


@pytest.mark.parametrize(
    "error, message, actions",
    [
        (TypeError, r"actions must be a NumPy array of float32 and of the shape \(2, 12\), not list", [[0.0] * 12] * 2),
        (TypeError, r"of float32 and of the shape \(2, 12\), not of float64", np.zeros((2, 12))),
        (ValueError, r"of the shape \(2, 12\), not \(2, 11\)", np.zeros((2, 11), np.float32)),
        (ValueError, r"of the shape \(2, 12\), not \(24,\)", np.zeros(24, np.float32)),
        (
            ValueError,
            r"actions\[1, 3\] is NaN, which is no finite number",
            np.where(np.arange(24) == 15, np.nan, 0).reshape(2, 12).astype(np.float32),
        ),
    ],
)
def test_wrong_actions_are_named(error, message, actions, make):
    envs = make("plane", 2)
    envs.reset()
    with pytest.raises(error, match=message):
        envs.step(actions)
    envs.step(np.zeros((12, 2), np.float32).T)  # whatever the order in memory


def test_wrong_resets_are_named(make):
    envs = make("plane", 2)
    with pytest.raises(ValueError, match="seed must be a whole number"):
        envs.reset(seed=2**32)
    with pytest.raises(TypeError, match="reset_mask must be a NumPy array of bool"):
        envs.reset(options={"reset_mask": [True, False]})
    with pytest.raises(ValueError, match=r"of the shape \(2,\), not \(3,\)"):
        envs.reset(options={"reset_mask": np.ones(3, np.bool_)})
    with pytest.raises(footwork.Error, match="a seed is for all environments"):
        envs.reset(seed=1, options={"reset_mask": np.ones(2, np.bool_)})


def test_running_episodes_can_be_cut_short(make):
    envs = make("plane", 3)
    first, _ = envs.reset(seed=0)
    before, *_ = envs.step(draws(envs))
    after, _ = envs.reset(options={"reset_mask": np.array([False, True, False])})
    assert np.array_equal(after[[0, 2]], before[[0, 2]]) and not np.array_equal(after[1], before[1])


def test_forked_processes_have_threads_of_their_own(motion):
    envs = gymnasium.make_vec("footwork/Plane-v0", num_envs=2, vectorization_mode="async", data=motion)
    envs.reset(seed=0)
    envs.step(draws(envs))
    envs.close()
