"""Environments stepped together."""

from __future__ import annotations

import os
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from footwork import spaces
from footwork._footwork import Batch


class VectorEnv(gymnasium.vector.VectorEnv):
    """Environments of a task, stepped on all cores at once.

    ``name`` is one of ``footwork.TASKS``; ``data`` is a database file, a BVH file or a folder of them, and without it
    synthetic motion. Whatever ``config.toml`` of a run can say may be given as ``settings``, its tables as dicts:
    ``VectorEnv("plane", 64, task={"target_extent": 3.0})``.

    Observations and actions are ``float32``; every call returns arrays of its own. Of ``box``, rows are fighters: rows
    ``2 k`` and ``2 k + 1`` fight each other.

    In the mode ``SAME_STEP`` an episode that ends is followed at once by the next: the observation is that one's first,
    and ``infos`` has the last one as ``final_obs`` and what is known of the episode as ``final_info``. In the modes
    ``NEXT_STEP`` and ``DISABLED`` the observation is the last, and ``infos`` has the episode's statistics themselves.
    """

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": AutoresetMode.SAME_STEP}

    def __init__(
        self,
        name: str,
        num_envs: int = 1,
        seed: int = 0,
        data: str | os.PathLike[str] | None = None,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        preset: str = "fast",
        skills: str | os.PathLike[str] | None = None,
        render_mode: None = None,
        **settings: Any,
    ) -> None:
        mode = AutoresetMode(autoreset_mode)
        batch = Batch(name, num_envs, seed, mode.value, data, preset, skills, settings)
        self._open(batch, mode, render_mode)

    @classmethod
    def _of(cls, batch: Batch, mode: AutoresetMode) -> VectorEnv:
        envs = cls.__new__(cls)
        envs._open(batch, mode, None)
        return envs

    def _open(self, batch: Batch, mode: AutoresetMode, render_mode: None) -> None:
        if render_mode is not None:
            raise ValueError(f"render_mode must be None, not {render_mode!r}: there is `footwork render` for that")
        self._batch: Batch | None = batch
        self.metadata = {**type(self).metadata, "autoreset_mode": mode}
        self.autoreset_mode = mode
        self.num_envs = batch.num_envs
        self.single_observation_space = spaces.observation_space(batch)
        self.single_action_space = spaces.action_space(batch)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    @property
    def batch(self) -> Batch:
        """The compiled environments."""
        if self._batch is None:
            raise ValueError("the environments are closed")
        return self._batch

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begins new episodes: in all environments, or where ``options["reset_mask"]`` says.

        A seed, from 0 to 2**32 - 1, decides over all that is random from then on.
        """
        mask = (options or {}).get("reset_mask")
        observations = self.batch.reset(seed, mask)
        super().reset(seed=seed)
        return observations, {}

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Plays one step of all environments.

        An episode is *terminated* where nothing is to be expected after it, and *truncated* where its value goes on:
        out of time, and, if a task says so, after a success.
        """
        *columns, ended, last, statistics = self.batch.step(actions)
        observations, rewards, terminations, truncations = columns
        infos = self._infos(ended, last, statistics) if len(ended) else {}
        return observations, rewards, terminations, truncations, infos

    def _infos(self, ended: np.ndarray, last: np.ndarray, statistics: np.ndarray) -> dict[str, Any]:
        episodes: dict[str, Any] = {}
        for name, values in spaces.episode(self.batch, statistics).items():
            episodes[name] = np.zeros(self.num_envs, values.dtype)
            episodes[name][ended] = values
            episodes[f"_{name}"] = self._mask(ended)
        if self.autoreset_mode != AutoresetMode.SAME_STEP:
            return episodes
        final_obs = np.full(self.num_envs, None, dtype=object)
        for row, observation in zip(ended, last, strict=False):
            final_obs[row] = observation
        return {
            "final_obs": final_obs,
            "_final_obs": self._mask(ended),
            "final_info": episodes,
            "_final_info": self._mask(ended),
        }

    def _mask(self, rows: np.ndarray) -> np.ndarray:
        mask = np.zeros(self.num_envs, dtype=np.bool_)
        mask[rows] = True
        return mask

    def statistics(self) -> dict[str, float]:
        """How many ``episodes`` ended since the last call, and means over them: ``success`` and the task's own."""
        return spaces.means(self.batch)

    @property
    def level(self) -> int | None:
        """The level of difficulty that new episodes are of, from 0, if the task has levels."""
        return self.batch.level

    @property
    def dt(self) -> float:
        """Length of a step, s."""
        return self.batch.dt

    @property
    def notes(self) -> list[str]:
        """What there is to know of how the data was loaded."""
        return self.batch.notes

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """An attribute, or what a method returns, once for every environment: they are all alike."""
        value = getattr(self, name)
        return (value(*args, **kwargs) if callable(value) else value,) * self.num_envs

    def close_extras(self, **_: Any) -> None:
        """Gives the memory back."""
        self._batch = None
