"""The tasks by Gymnasium's names."""

from collections.abc import Iterable

import gymnasium


def register(tasks: Iterable[str]) -> None:
    """Registers ``footwork/Plane-v0`` and so on, as one environment and as a batch of them."""
    for task in tasks:
        # A bout takes two.
        single = None if task == "box" else "footwork.env:Env"
        gymnasium.register(
            f"footwork/{task.capitalize()}-v0",
            entry_point=single,
            vector_entry_point="footwork.vector_env:VectorEnv",
            kwargs={"name": task},
        )
