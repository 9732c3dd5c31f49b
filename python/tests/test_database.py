"""Motion: files, features, search."""

import numpy as np
import pytest

import footwork


@pytest.fixture(scope="module")
def database():
    return footwork.Database.synthetic(minutes=1.0)


def test_arrays_are_views_of_the_same_motion(database):
    frames, joints = database.frames, len(database.joint_names)
    assert database.features.shape == (frames, 27) and database.path.shape == (frames, 4)
    assert database.hips.shape == (frames, 3) and database.rotations.shape == (frames, joints, 4)
    assert database.offsets.shape == (joints, 3) and database.parents[0] == -1
    assert np.shares_memory(database.features, database.features)
    with pytest.raises(ValueError, match="read-only"):
        database.features[0, 0] = 1.0
    assert np.allclose(np.linalg.norm(database.rotations, axis=2), 1.0, atol=1e-4)
    assert sum(clip["frames"] for clip in database.clips) == frames
    features = database.features
    del database
    assert np.isfinite(features).all(), "a view keeps what it shows"


def test_the_search_finds_what_numpy_finds(database):
    random = np.random.default_rng(0)
    queries = random.normal(size=(40, 27)).astype(np.float32)
    frames, distances = database.search(queries)
    rows = database.features[database.candidates]
    squared = ((rows[None] - queries[:, None]) ** 2).sum(axis=2)
    assert np.array_equal(frames, database.candidates[squared.argmin(axis=1)])
    assert np.allclose(distances, squared.min(axis=1), rtol=1e-5)


def test_motion_matching_by_the_index_is_the_search(database):
    random = np.random.default_rng(1)
    shown = random.integers(0, database.frames, 100)
    trajectories = random.normal(size=(100, 12)).astype(np.float32)
    frames, distances = database.match(shown, trajectories)
    queries = np.hstack([database.features[shown, :15], trajectories])
    wanted, far = database.search(queries)
    assert np.array_equal(frames, wanted) and np.array_equal(distances, far)


def test_a_file_holds_the_same_motion(database, tmp_path):
    path = tmp_path / "motion.footwork"
    database.save(path)
    assert {file.name for file in tmp_path.iterdir()} == {"motion.footwork", "motion.footwork.index"}
    loaded = footwork.Database.load(path)
    assert loaded.fingerprint == database.fingerprint
    assert np.array_equal(loaded.features, database.features)


def bvh(frames):
    """A person of a few joints that walks along z, as a BVH file's text."""

    def joint(name, offset, *children, root=False):
        kind = "ROOT" if root else "JOINT"
        channels = "6 Xposition Yposition Zposition" if root else "3"
        inner = "".join(children) or "End Site\n{\nOFFSET 0 0 5\n}\n"
        return f"{kind} {name}\n{{\nOFFSET {offset}\nCHANNELS {channels} Zrotation Yrotation Xrotation\n{inner}}}\n"

    def leg(side, x):
        foot = joint(f"{side}Foot", "0 -42 0", joint(f"{side}Toe", "0 -6 14"))
        return joint(f"{side}UpLeg", f"{x} 0 0", joint(f"{side}Leg", "0 -44 0", foot))

    def arm(side, x):
        hand = joint(f"{side}Hand", f"{2.5 * x} 0 0")
        return joint(
            f"{side}Shoulder",
            f"{x / 2} 20 0",
            joint(f"{side}Arm", f"{x} 0 0", joint(f"{side}ForeArm", f"{3 * x} 0 0", hand)),
        )

    neck = joint("Neck", "0 25 0", joint("Head", "0 10 0"))
    spine = joint("Spine", "0 12 0", joint("Spine1", "0 15 0", neck, arm("Left", 10), arm("Right", -10)))
    root = joint("Hips", "0 0 0", leg("Left", 9), leg("Right", -9), spine, root=True)
    joints = root.count("JOINT")
    lines = []
    for frame in range(frames):
        swing = 25 * np.sin(frame / 5)
        numbers = {"LeftUpLeg": swing, "RightUpLeg": -swing}
        order = [line.split()[1] for line in root.splitlines() if line.startswith("JOINT")]
        turns = " ".join(f"0 0 {numbers.get(name, 0.0):.3f}" for name in order)
        lines.append(f"0 92 {4 * frame} 0 0 0 {turns}")
    assert len(lines[0].split()) == 6 + 3 * joints
    return f"HIERARCHY\n{root}MOTION\nFrames: {frames}\nFrame Time: 0.033333\n" + "\n".join(lines) + "\n"


def test_a_folder_of_bvh_files_is_imported(tmp_path):
    (tmp_path / "walk.bvh").write_text(bvh(120))
    database = footwork.import_bvh(tmp_path, mirror=True)
    assert [clip["name"] for clip in database.clips] == ["walk", "walk mirrored"]
    assert "LeftFoot" in database.joint_names
    path = database.path
    assert path[100, 1] - path[0, 1] == pytest.approx(4.0, abs=0.2), "four metres, in metres"


def test_what_cannot_be_read_says_why(tmp_path):
    broken = tmp_path / "broken.bvh"
    broken.write_text("HIERARCHY\nROOT")
    for error, message, act in [
        (footwork.Error, "broken.bvh", lambda: footwork.import_bvh(broken)),
        (footwork.Error, "nothing.bvh", lambda: footwork.import_bvh(tmp_path / "nothing.bvh")),
        (footwork.Error, "is not a footwork database", lambda: footwork.Database.load(broken)),
        (footwork.Error, "cannot read .*nothing", lambda: footwork.Database.load(tmp_path / "nothing")),
        (footwork.Error, "cannot write", lambda: footwork.Database.synthetic(0.5).save(tmp_path / "no" / "where")),
        (ValueError, "minutes must be from 0.1", lambda: footwork.Database.synthetic(0.0)),
        (ValueError, "weights must be", lambda: footwork.Database.synthetic(weights="mine")),
        (ValueError, "up must be", lambda: footwork.import_bvh(broken, up="w")),
    ]:
        with pytest.raises(error, match=message):
            act()


def test_wrong_queries_are_named(database):
    frames, row = np.zeros(1, np.int64), np.zeros((1, 12), np.float32)
    for error, message, act in [
        (ValueError, r"queries must .* \(n, 27\), not \(1, 12\)", lambda: database.search(row)),
        (TypeError, "queries must be a NumPy array of float32", lambda: database.search("all")),
        (TypeError, "frames must be a NumPy array of int64", lambda: database.match(frames.astype(float), row)),
        (ValueError, r"trajectories must .* \(1, 12\)", lambda: database.match(frames, row[:, :3])),
        (ValueError, r"frames\[0\] is -1", lambda: database.match(frames - 1, row)),
    ]:
        with pytest.raises(error, match=message):
            act()
    assert all(len(part) == 0 for part in database.search(np.zeros((0, 27), np.float32)))
