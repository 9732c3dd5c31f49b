"""The compiled half of the package."""

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

_Path = str | os.PathLike[str]

TASKS: list[tuple[str, str]]
OBSERVATION_LIMIT: float

class Error(RuntimeError):
    """A file, a run or a device that cannot be used; the message says why and what to do."""

class Batch:
    """A batch of environments, stepped on all cores without Python's lock."""

    def __init__(
        self,
        task: str,
        num_envs: int,
        seed: int,
        autoreset_mode: str,
        data: _Path | None = None,
        preset: str = "fast",
        skills: _Path | None = None,
        settings: dict[str, Any] | None = None,
    ) -> None: ...
    @property
    def num_envs(self) -> int: ...
    @property
    def agents(self) -> int: ...
    @property
    def vector_dim(self) -> int: ...
    @property
    def map_shape(self) -> tuple[int, int, int] | None: ...
    @property
    def style_dim(self) -> int: ...
    @property
    def action_dim(self) -> int: ...
    @property
    def action_scale(self) -> float: ...
    @property
    def dt(self) -> float: ...
    @property
    def level(self) -> int | None: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def stat_names(self) -> list[str]: ...
    def reset(self, seed: int | None = None, mask: NDArray[np.bool_] | None = None) -> NDArray[np.float32]: ...
    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[
        NDArray[np.float32],
        NDArray[np.float32],
        NDArray[np.bool_],
        NDArray[np.bool_],
        NDArray[np.int64],
        NDArray[np.float32],
        NDArray[np.float32],
    ]: ...
    def take_means(self) -> list[tuple[str, float]]: ...

class Database:
    """Clips joined, one row a frame at 30 Hz, with the index of what can be matched."""

    @staticmethod
    def load(path: _Path) -> Database:
        """Reads a database file."""
    @staticmethod
    def synthetic(minutes: float = 39.0, seed: int = 1, weights: str = "paper") -> Database:
        """Makes synthetic motion of so many minutes."""
    def save(self, path: _Path) -> None:
        """Writes a database file, and the search's index beside it."""
    def search(self, queries: NDArray[np.float32]) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
        """The nearest frames to normalised features ``(n, 27)``, among those that can be matched, and the squared
        distances to them; all are compared."""
    def match(
        self, frames: NDArray[np.int64], trajectories: NDArray[np.float32]
    ) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
        """The frames to go on with from ``frames``, ``(n,)``, along normalised trajectories ``(n, 12)``, and the
        squared distances to them: motion matching, by the index."""
    @property
    def frames(self) -> int:
        """Frames of all clips."""
    @property
    def minutes(self) -> float:
        """Length of all clips together."""
    @property
    def fingerprint(self) -> int:
        """Checksum of all that a policy depends on."""
    @property
    def notes(self) -> list[str]:
        """What there is to know of an import."""
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def parents(self) -> list[int]:
        """The parent of every joint; -1 of the root."""
    @property
    def clips(self) -> list[dict[str, Any]]:
        """``name``, ``first`` frame, number of ``frames``, ``source`` and ``licence`` of every clip."""
    @property
    def candidates(self) -> NDArray[np.uint32]:
        """Frames that can be matched, ascending."""
    @property
    def normalisation(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Mean and scale: ``normalised = (feature - mean) * scale``."""
    @property
    def offsets(self) -> NDArray[np.float32]:
        """Position of each joint relative to its parent, ``(joints, 3)``, m."""
    @property
    def features(self) -> NDArray[np.float32]:
        """Normalised features ``(frames, 27)``: 15 of the pose, 12 of the trajectory. A view: read only."""
    @property
    def path(self) -> NDArray[np.float32]:
        """The character's path in its clip, ``(frames, 4)``: x and z (m), heading x and z. A view: read only."""
    @property
    def hips(self) -> NDArray[np.float32]:
        """World positions of the hips, ``(frames, 3)``, m. A view: read only."""
    @property
    def rotations(self) -> NDArray[np.float32]:
        """Local rotations ``(frames, joints, 4)``, quaternions x, y, z, w. A view: read only."""

class Policy:
    """A trained policy."""

    @staticmethod
    def load(run: _Path) -> Policy: ...
    @property
    def task(self) -> str: ...
    @property
    def steps(self) -> int: ...
    @property
    def config(self) -> str: ...
    @property
    def observation_dim(self) -> int: ...
    @property
    def action_dim(self) -> int: ...
    @property
    def dt(self) -> float: ...
    def act(self, observations: NDArray[np.float32]) -> NDArray[np.float32]: ...
    def batch(self, num_envs: int, seed: int, autoreset_mode: str, data: _Path | None = None) -> Batch: ...

def import_bvh(
    path: _Path,
    *,
    unit: float | None = None,
    up: str | None = None,
    roles: _Path | None = None,
    trim: bool = False,
    recursive: bool = False,
    skip_bad: bool = False,
    mirror: bool = False,
    weights: str = "paper",
) -> Database:
    """Makes a database of a BVH file or a folder of them.

    ``unit`` is metres of one unit of the files and ``up`` the axis that is up, both otherwise found; ``roles`` a TOML
    file that names joints; ``trim`` keeps the longest piece of recordings that jump; ``recursive`` reads sub-folders;
    ``skip_bad`` leaves out what cannot be used; ``mirror`` adds mirrored copies; ``weights`` are those of the search,
    ``paper`` or ``holden``. What there is to know of the files is in ``notes``.
    """

def train(
    task: str,
    out: _Path | None = None,
    steps: int | None = None,
    seed: int | None = None,
    data: _Path | None = None,
    num_envs: int | None = None,
    preset: str = "fast",
    skills: _Path | None = None,
    max_time_s: float | None = None,
    stop_at_success: float | None = None,
    resume: _Path | None = None,
    on_note: Any = None,
    on_update: Any = None,
    settings: dict[str, Any] | None = None,
) -> tuple[os.PathLike[str], str]: ...
