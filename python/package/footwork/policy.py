"""What a run has learned, to be called."""

from __future__ import annotations

import os

import numpy as np
from gymnasium.vector import AutoresetMode

from footwork._footwork import Policy as _Policy
from footwork.vector_env import VectorEnv


class Policy:
    """A trained policy: ``policy(observations)`` is the mean action, without exploration.

    It observes and acts as the environments of :class:`footwork.VectorEnv` do; its observations are normalised inside.
    """

    def __init__(self, run: str | os.PathLike[str]) -> None:
        self._policy = _Policy.load(run)

    @classmethod
    def load(cls, run: str | os.PathLike[str]) -> Policy:
        """Reads the last checkpoint of a run's folder, or a given checkpoint."""
        return cls(run)

    def __call__(self, observations: np.ndarray) -> np.ndarray:
        """Actions ``(n, action_dim)`` for observations ``(n, observation_dim)``, or one for one."""
        if isinstance(observations, np.ndarray) and observations.ndim == 1:
            one: np.ndarray = self._policy.act(observations[np.newaxis])[0]
            return one
        return self._policy.act(observations)

    def make_vec(
        self,
        num_envs: int = 1,
        seed: int = 0,
        data: str | os.PathLike[str] | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
    ) -> VectorEnv:
        """Environments as it was trained in; ``data`` is where their motion is now, if it has moved."""
        mode = AutoresetMode(autoreset_mode)
        return VectorEnv._of(self._policy.batch(num_envs, seed, mode.value, data), mode)

    @property
    def task(self) -> str:
        """The task's name."""
        return self._policy.task

    @property
    def steps(self) -> int:
        """Environment steps of its training."""
        return self._policy.steps

    @property
    def config(self) -> str:
        """The text of its run's ``config.toml``."""
        return self._policy.config

    @property
    def observation_dim(self) -> int:
        """Numbers of an observation."""
        return self._policy.observation_dim

    @property
    def action_dim(self) -> int:
        """Numbers of an action."""
        return self._policy.action_dim

    @property
    def dt(self) -> float:
        """Length of a step, s."""
        return self._policy.dt

    def __repr__(self) -> str:
        return f"<Policy of {self.task}: {self.observation_dim} observations, {self.action_dim} actions>"
