"""Reads a footwork database of motion, with NumPy alone. `docs/database.md` documents every field.

    from footwork_database import load
    database = load("motion.footwork")
    nearest = ((database.features[database.candidates] - query) ** 2).sum(axis=1).argmin()
    frame = database.candidates[nearest]
"""

import json
import struct
import sys
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

VERSION = 1
RATE = 30.0
POSE_DIM, FEATURE_DIM, ROW_STRIDE = 15, 27, 28
MIN_FUTURE_FRAMES, FRAMES_PER_STEP = 30, 6


@dataclass
class Database:
    """All clips joined, a row a frame at 30 Hz. Metres and seconds, y up."""

    names: list[str]  # of the joints; joint 0 is the root
    parents: np.ndarray  # int32 [joints], -1 for the root
    offsets: np.ndarray  # float32 [joints, 3], from the parent joint, in its frame
    roles: dict[str, int]  # joints of hips, left_foot, ...
    clips: list[dict]  # name, first, frames, source, licence, findings
    mean: np.ndarray  # float32 [27]
    scale: np.ndarray  # float32 [27]; normalised = (feature - mean) * scale
    features: np.ndarray  # float32 [frames, 27], normalised: pose (15), then trajectory (12)
    path: np.ndarray  # float32 [frames, 4]: ground position x, z and heading x, z in the clip's world
    hips: np.ndarray  # float32 [frames, 3], the root joint's position in the clip's world
    rotations: np.ndarray  # float32 [frames, joints, 4]: x, y, z, w, relative to the parent
    candidates: np.ndarray  # uint32, the frames that can be matched and played on from
    motion: np.ndarray  # float32 [candidates, 5]: moved x, z, turned x, z, length of a step
    fingerprint: int  # the number by which a policy knows its database

    def pose_features(self):
        """Features of the pose in metres and m/s, in the character frame, [frames, 15]."""
        return self._in_metres()[:, :POSE_DIM]

    def trajectory_features(self):
        """Features of the future trajectory in metres, in the character frame, [frames, 12]."""
        return self._in_metres()[:, POSE_DIM:]

    def _in_metres(self):
        still = np.where(self.scale == 0, np.float32(np.inf), self.scale)
        return self.features / still + self.mean

    def world(self, frame):
        """World positions [joints, 3] and rotations [joints, 4] of a frame as it was recorded."""
        positions, rotations = [self.hips[frame]], [self.rotations[frame, 0]]
        for joint in range(1, len(self.names)):
            parent = self.parents[joint]
            at, turned = positions[parent], rotations[parent]
            positions.append(at + rotate(turned, self.offsets[joint]))
            rotations.append(multiply(turned, self.rotations[frame, joint]))
        return np.array(positions), np.array(rotations)


def load(path):
    """Reads a database. Raises ValueError, with a sentence, for what is none."""
    data = Path(path).read_bytes()
    kind, version, checksum, length = check(path, data)
    contents = json.loads(data[32 : 32 + length])
    header, arrays, at = contents["header"], {}, 32 + length
    for name, count in contents["arrays"]:
        arrays[name] = np.frombuffer(data, "<f4", count, at)
        at += 4 * count
    skeleton, frames, clips = header["skeleton"], header["frames"], header["clips"]
    joints = len(skeleton["names"])
    features = arrays["features"].reshape(frames, ROW_STRIDE)
    path = arrays["path"].reshape(frames, 4)
    playable = [np.arange(c["first"], c["first"] + c["frames"] - MIN_FUTURE_FRAMES) for c in clips]
    candidates = np.concatenate(playable).astype("<u4")
    motion = root_motion(path, candidates)
    fingerprint = 0
    for part in (features, candidates, motion):
        fingerprint = zlib.crc32(part.tobytes(), fingerprint)
    return Database(
        names=skeleton["names"],
        parents=np.array([-1 if p is None else p for p in skeleton["parents"]], "<i4"),
        offsets=np.array(skeleton["offsets"], "<f4"),
        roles=header["roles"],
        clips=clips,
        mean=np.array(header["normalisation"]["mean"], "<f4"),
        scale=np.array(header["normalisation"]["scale"], "<f4"),
        features=features[:, :FEATURE_DIM],
        path=path,
        hips=arrays["hips"].reshape(frames, 3),
        rotations=arrays["rotations"].reshape(frames, joints, 4),
        candidates=candidates,
        motion=motion,
        fingerprint=fingerprint,
    )


def check(path, data):
    """The fields of the first 32 bytes, if they are those of a whole database of this version."""
    if len(data) < 32 or data[:8] != b"footwork":
        raise ValueError(f"{path} is not a footwork database")
    kind, version, checksum, length = struct.unpack_from("<8sIIQ", data, 8)
    if kind.rstrip(b"\0") != b"database":
        raise ValueError(f"{path} is a footwork {kind.rstrip(bytes(1)).decode()}, not a database")
    if version != VERSION:
        raise ValueError(f"{path} has format version {version}; this reader reads version {VERSION}")
    if zlib.crc32(data[24:]) != checksum:
        raise ValueError(f"{path} is damaged (its checksum does not match its contents)")
    return kind, version, checksum, length


def to_local(vector, heading):
    """A ground vector [..., 2] of the world in the character frame of a unit heading: left, forward."""
    (x, z), (hx, hz) = vector.T, heading.T
    return np.stack([hz * x - hx * z, hx * x + hz * z], axis=-1)


def root_motion(path, candidates):
    """Of each candidate in its character frame: ground displacement and new heading after a step, and the path's length."""
    heading, then = path[candidates, 2:], path[candidates + FRAMES_PER_STEP]
    length = np.zeros(len(candidates), "<f4")
    for k in range(FRAMES_PER_STEP):
        x, z = (path[candidates + k + 1, :2] - path[candidates + k, :2]).T
        length += np.hypot(x, z)
    moved = to_local(then[:, :2] - path[candidates, :2], heading)
    return np.column_stack([moved, to_local(then[:, 2:], heading), length])


def multiply(a, b):
    """The product of two quaternions x, y, z, w: first b, then a."""
    vector = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(vector, a[3] * b[3] - a[:3] @ b[:3])


def rotate(rotation, vector):
    """A vector rotated by a unit quaternion x, y, z, w."""
    twice = 2 * np.cross(rotation[:3], vector)
    return vector + rotation[3] * twice + np.cross(rotation[:3], twice)


if __name__ == "__main__":
    database = load(sys.argv[1])
    print(f"{len(database.clips)} clips, {len(database.features)} frames, {len(database.names)} joints,")
    print(f"{len(database.candidates)} candidates, fingerprint {database.fingerprint:08x}")
