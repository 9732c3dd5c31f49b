"""Character control learned from motion capture: environments, search, policies and trainings.

    import footwork

    envs = footwork.make_vec("plane", num_envs=1024)
    observations, infos = envs.reset(seed=0)

Environments are also registered with Gymnasium, as ``footwork/Plane-v0`` and so on.
"""

from footwork._footwork import TASKS as _TASKS
from footwork._footwork import Database, Error, import_bvh
from footwork.env import Env
from footwork.policy import Policy
from footwork.registration import register
from footwork.training import train
from footwork.vector_env import VectorEnv

__all__ = [
    "TASKS",
    "Database",
    "Env",
    "Error",
    "Policy",
    "VectorEnv",
    "import_bvh",
    "make_vec",
    "train",
]

TASKS = dict(_TASKS)
"""What each task is about, by name."""

make_vec = VectorEnv
"""Opens environments: see :class:`VectorEnv`."""

register(TASKS)
