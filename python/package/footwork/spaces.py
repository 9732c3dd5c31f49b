"""The spaces of a batch's observations and actions."""

import numpy as np
from gymnasium.spaces import Box

from footwork._footwork import OBSERVATION_LIMIT, Batch


def observation_space(batch: Batch) -> Box:
    """One flat vector: numbers first, then the maps' cells, which lie between 0 and 1."""
    maps = int(np.prod(batch.map_shape)) if batch.map_shape else 0
    high = np.full(batch.vector_dim + maps, OBSERVATION_LIMIT, np.float32)
    high[batch.vector_dim :] = 1.0
    low = -high
    low[batch.vector_dim :] = 0.0
    return Box(low, high, dtype=np.float32)


def action_space(batch: Batch) -> Box:
    """Between -1 and 1. What lies beyond is no error, and is asked for as it is."""
    return Box(-1.0, 1.0, (batch.action_dim,), np.float32)


def episode(batch: Batch, statistics: np.ndarray) -> dict[str, np.ndarray]:
    """Statistics ``[..., names]`` of episodes by name; the number of episodes itself is none of them."""
    return {
        _NAMES.get(name, name): statistics[..., at] for at, name in enumerate(batch.stat_names) if name != "episodes"
    }


_NAMES = {"successes": "success", "returns": "episode_return", "steps": "episode_length"}
"""Means over episodes have other names than the sums that they are of: those of ``metrics.jsonl``."""


def means(batch: Batch) -> dict[str, float]:
    """How many episodes ended since the last call, and means over them."""
    return {_NAMES.get(name, name): value for name, value in batch.take_means()}
