"""Walks characters to their targets by an exported policy, with NumPy and ONNX Runtime alone.

    footwork data synth --out motion.footwork
    footwork train plane --data motion.footwork --steps 500000 --out run
    footwork export run --format onnx --out plane.onnx
    python examples/drive_policy.py plane.onnx motion.footwork

All that it knows of the policy is in the metadata of its file; the motion is in the database that it was trained with.
"""

import json
import sys
from pathlib import Path

import numpy as np
import onnxruntime

sys.path.insert(0, str(Path(__file__).parent / "readers"))
import footwork_database  # noqa: E402


class Policy:
    """A policy, and what its file says of it."""

    def __init__(self, path):
        self.session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
        self.about = json.loads(self.session.get_modelmeta().custom_metadata_map["footwork"])
        if [port["name"] for port in self.about["inputs"]] != ["observation"] or "matching" not in self.about:
            raise SystemExit(f"{path} is a policy of `{self.about['task']}`: this walks on an empty plane")

    def action(self, pose, target):
        """Actions [n, action] for normalised features of poses and targets [n, 2] in the character frame, m."""
        port = self.about["inputs"][0]
        observation = np.zeros((len(pose), *port["shape"]), "<f4")
        observation[:, : pose.shape[1]] = pose
        for part in port["parts"]:
            if part["name"] == "target":
                mean, scale = part.get("mean", 0.0), part.get("scale", 1.0)
                first, count = part["first"], len(part["elements"])
                observation[:, first : first + count] = (target - mean) * scale
        return self.session.run(["action"], {"observation": observation})[0]


def to_world(local, heading):
    """Ground vectors of the character frame, left and forward, in the world."""
    (left, ahead), (x, z) = local.T, heading.T
    return np.stack([z * left + x * ahead, z * ahead - x * left], axis=-1)


def nearest(rows, queries):
    """The row that is nearest to each query."""
    return ((rows**2).sum(1) - 2 * queries @ rows.T).argmin(1)


def walk(policy, database, episodes, seed=1):
    """Plays episodes from random frames and headings to random targets. Returns the seconds that each took to arrive,
    infinite where it did not."""
    matching, episode = policy.about["matching"], policy.about["episode"]
    rng = np.random.default_rng(seed)
    radius, extent = episode["success_radius_m"], episode["target_extent_m"]
    targets = rng.uniform(-extent, extent, (50 * episodes, 2))
    targets = targets[np.linalg.norm(targets, axis=1) > radius][:episodes]
    angle = rng.uniform(0, 2 * np.pi, episodes)
    heading = np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    position = np.zeros((episodes, 2))
    frame = rng.choice(database.candidates, episodes)
    pose_columns = slice(*matching["pose_columns"])
    rows = database.features[database.candidates]
    arrived = np.full(episodes, np.inf)
    for step in range(1, episode["max_steps"] + 1):
        pose = database.features[frame, pose_columns]
        target = footwork_database.to_local(targets - position, heading)
        query = np.concatenate([pose, policy.action(pose, target)], axis=1)
        found = database.candidates[nearest(rows, query)]
        frame = found + matching["frames_per_step"]
        before, after = database.path[found], database.path[frame]
        moved = footwork_database.to_local(after[:, :2] - before[:, :2], before[:, 2:])
        turned = footwork_database.to_local(after[:, 2:], before[:, 2:])
        position, heading = position + to_world(moved, heading), to_world(turned, heading)
        heading /= np.linalg.norm(heading, axis=1, keepdims=True)
        near = np.linalg.norm(targets - position, axis=1) <= radius
        arrived[near & np.isinf(arrived)] = step * policy.about["step_s"]
        if np.isfinite(arrived).all():
            break
    return arrived


def main(policy_path, database_path, episodes=200):
    policy, database = Policy(policy_path), footwork_database.load(database_path)
    if f"{database.fingerprint:08x}" != policy.about["data_fingerprint"]:
        raise SystemExit(f"{policy_path} was trained with another database than {database_path}")
    arrived = walk(policy, database, int(episodes))
    there = np.isfinite(arrived)
    print(f"{there.sum()} of {len(arrived)} episodes reach the target, in {arrived[there].mean():.2f} s on average")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        raise SystemExit("usage: drive_policy.py POLICY.onnx DATABASE [EPISODES]")
    main(*sys.argv[1:4])
