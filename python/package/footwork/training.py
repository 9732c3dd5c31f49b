"""Trainings by footwork's own learners."""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Callable
from typing import Any

from footwork import _footwork

_Path = str | os.PathLike[str]


def train(
    name: str,
    out: _Path | None = None,
    *,
    steps: int | None = None,
    seed: int | None = None,
    data: _Path | None = None,
    num_envs: int | None = None,
    preset: str = "fast",
    skills: _Path | None = None,
    max_time_s: float | None = None,
    stop_at_success: float | None = None,
    resume: _Path | None = None,
    on_update: Callable[[dict[str, Any]], None] | None = None,
    **settings: Any,
) -> dict[str, Any]:
    """Trains a policy of a task as ``footwork train`` does; returns its ``summary.json``, and its folder as ``run``.

    ``out`` is the run's folder, by default the next free ``runs/TASK-N``; ``resume`` a run to go on with instead.
    ``on_update`` hears the metrics of every update. Other keywords are keys of ``config.toml``, its tables as dicts.
    Ctrl-C lets the training write its checkpoint and return, with ``stopped_by`` ``interrupt``; a second one does not
    wait for that.
    """

    def updated(row: str) -> None:
        if on_update is not None:
            on_update(json.loads(row))

    run, summary = _footwork.train(
        name,
        out=out,
        steps=steps,
        seed=seed,
        data=data,
        num_envs=num_envs,
        preset=preset,
        skills=skills,
        max_time_s=max_time_s,
        stop_at_success=stop_at_success,
        resume=resume,
        on_note=logging.getLogger("footwork").info,
        on_update=updated,
        settings=settings,
    )
    return {"run": os.fspath(run), **json.loads(summary)}
