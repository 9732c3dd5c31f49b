"""One environment, for programs that want no batch."""

from __future__ import annotations

import os
from typing import Any

import gymnasium
import numpy as np

from footwork import spaces
from footwork._footwork import Batch


class Env(gymnasium.Env):
    """One environment of a task: see :class:`footwork.VectorEnv`, whose arguments it takes."""

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        name: str,
        seed: int = 0,
        data: str | os.PathLike[str] | None = None,
        *,
        preset: str = "fast",
        skills: str | os.PathLike[str] | None = None,
        render_mode: None = None,
        **settings: Any,
    ) -> None:
        if render_mode is not None:
            raise ValueError(f"render_mode must be None, not {render_mode!r}: there is `footwork render` for that")
        self._batch = Batch(name, 1, seed, "Disabled", data, preset, skills, settings)
        self._everything = np.ones(1, dtype=np.bool_)
        self.observation_space = spaces.observation_space(self._batch)
        self.action_space = spaces.action_space(self._batch)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begins an episode."""
        super().reset(seed=seed)
        mask = self._everything if seed is None else None
        return self._batch.reset(seed, mask)[0], {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Plays a step; the last one of an episode says what is known of it."""
        if not isinstance(action, np.ndarray) or action.shape != self.action_space.shape:
            found = action.shape if isinstance(action, np.ndarray) else type(action).__name__
            raise ValueError(f"action must be a NumPy array of the shape {self.action_space.shape}, not {found}")
        *columns, ended, _, statistics = self._batch.step(action[np.newaxis])
        observations, rewards, terminations, truncations = columns
        info = {}
        if len(ended):
            info = {name: float(values[0]) for name, values in spaces.episode(self._batch, statistics).items()}
        return observations[0], float(rewards[0]), bool(terminations[0]), bool(truncations[0]), info
