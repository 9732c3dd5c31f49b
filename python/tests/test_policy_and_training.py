"""Trainings, and what they leave."""

import json
import os
import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import footwork


def test_a_policy_does_better_than_chance(run):
    policy = footwork.Policy.load(run)
    assert (policy.task, policy.observation_dim, policy.action_dim) == ("plane", 17, 12)
    assert "max_steps" in policy.config and policy.steps >= 60_000

    def arrivals(act):
        envs = policy.make_vec(100, seed=9)
        observations, _ = envs.reset()
        for _ in range(60):
            observations, *_ = envs.step(act(observations))
        found = envs.statistics()
        return found["episodes"] * found["success"]

    assert arrivals(policy) > 2 * arrivals(lambda seen: np.zeros((len(seen), 12), np.float32))


def test_a_policy_takes_one_observation_or_many(run):
    policy = footwork.Policy.load(run / "checkpoints" / "last.ckpt")
    seen = np.random.default_rng(0).normal(size=(3, 17)).astype(np.float32)
    actions = policy(seen)
    assert actions.shape == (3, 12) and actions.dtype == np.float32
    assert np.array_equal(policy(seen[1]), actions[1])
    with pytest.raises(ValueError, match=r"observations must .* \(n, 17\), not \(3, 16\)"):
        policy(seen[:, 1:])
    with pytest.raises(TypeError, match="not of float64"):
        policy(seen.astype(np.float64))
    with pytest.raises(TypeError, match="not list"):
        policy([0.0] * 17)


def test_what_is_no_run_says_so(tmp_path, motion):
    with pytest.raises(footwork.Error, match="is not a run folder"):
        footwork.Policy.load(tmp_path / "nothing")
    with pytest.raises(footwork.Error, match="holds no run"):
        footwork.Policy.load(tmp_path)
    with pytest.raises(footwork.Error, match="database, not a checkpoint|is not a footwork checkpoint|not a"):
        footwork.Policy.load(motion)


def test_updates_are_told_and_a_run_goes_on(tmp_path, motion):
    told = []
    arguments = {"data": motion, "num_envs": 32, "on_update": told.append}
    first = footwork.train("plane", tmp_path / "run", steps=2048, **arguments)
    assert len(told) == 4 and told[-1]["steps"] == 2048 and "episode_return" in told[-1]
    assert first["run"] == str(tmp_path / "run") and 0.0 <= first["success"] <= 1.0
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert {**summary, "run": first["run"]} == first
    on = footwork.train("plane", resume=first["run"], steps=4096)
    assert on["steps"] == 4096
    with pytest.raises(footwork.Error, match="the run has done 4096 steps"):
        footwork.train("plane", resume=first["run"])
    with pytest.raises(footwork.Error, match="is a run of the task `plane`, not of `stand`"):
        footwork.train("stand", resume=first["run"], steps=8192)
    with pytest.raises(TypeError, match="goes on as it was begun"):
        footwork.train("plane", resume=first["run"], seed=3)
    with pytest.raises(footwork.Error, match="already holds a run"):
        footwork.train("plane", first["run"], steps=2048)


def test_what_cannot_be_trained_says_why(tmp_path):
    for error, message, arguments in [
        (ValueError, "no task", {"name": "plain"}),
        (ValueError, "unknown key `ppo.gama`", {"name": "plane", "ppo": {"gama": 0.9}}),
        (ValueError, "ppo.gamma is 2", {"name": "plane", "ppo": {"gamma": 2.0}}),
        (footwork.Error, "nowhere", {"name": "plane", "data": "nowhere"}),
    ]:
        with pytest.raises(error, match=message):
            footwork.train(**arguments, out=tmp_path / "run")
        assert not (tmp_path / "run").exists(), "nothing was begun"


def test_an_error_of_the_listener_ends_the_training(tmp_path, motion):
    def fail(_):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        footwork.train("plane", tmp_path / "run", data=motion, num_envs=32, on_update=fail)
    assert (tmp_path / "run" / "checkpoints" / "last.ckpt").exists()


@pytest.mark.skipif(os.name == "nt", reason="sends a signal")
def test_an_interrupt_lets_the_training_save_and_return(tmp_path, motion):
    script = textwrap.dedent(
        f"""
        import footwork
        said = lambda row: print("update", flush=True) if row["update"] == 3 else None
        summary = footwork.train("plane", {str(tmp_path / "run")!r}, data={str(motion)!r}, steps=10**9, on_update=said)
        print(summary["stopped_by"], summary["steps"])
        """
    )
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "update\n"
    process.send_signal(signal.SIGINT)
    stopped_by, steps = process.communicate(timeout=60)[0].split()
    assert process.returncode == 0 and stopped_by == "interrupt" and int(steps) > 0
    assert footwork.Policy.load(tmp_path / "run").steps == int(steps)
