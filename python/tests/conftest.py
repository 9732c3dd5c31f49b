"""What tests share: short synthetic motion, and a run of a few updates."""

import pathlib

import pytest

import footwork


@pytest.fixture(scope="session")
def motion(tmp_path_factory) -> pathlib.Path:
    """A database file of a minute of synthetic motion, with its index."""
    path = tmp_path_factory.mktemp("motion") / "minute.footwork"
    footwork.Database.synthetic(minutes=1.0).save(path)
    return path


@pytest.fixture(scope="session")
def run(tmp_path_factory, motion) -> pathlib.Path:
    """The folder of a run that has learned something."""
    folder = tmp_path_factory.mktemp("runs") / "plane"
    summary = footwork.train("plane", folder, steps=60_000, seed=1, data=motion, num_envs=64)
    assert summary["stopped_by"] == "steps" and summary["steps"] >= 60_000
    return folder


@pytest.fixture
def make(motion):
    """Opens environments, those of motion matching with short motion."""

    def opened(name, *args, **settings):
        if name in ("plane", "obstacles"):
            settings.setdefault("data", motion)
        return footwork.make_vec(name, *args, **settings)

    return opened
