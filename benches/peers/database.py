"""Reads a footwork database file (`src/container.rs`, `src/motion/database.rs`) into NumPy arrays."""

import json
import zlib
from typing import NamedTuple

import numpy as np

FEATURE, POSE = 27, 15
# Floats of a feature row in the file.
PADDED = 28
# Frames at a clip's end that are never matched, and frames played from a match.
TAIL, PLAYED = 30, 6


class Database(NamedTuple):
    """Ground vectors are complex numbers z + ix, so that turning is a multiplication."""

    # Normalised features of every frame.
    features: np.ndarray
    # Frames that can be matched.
    candidates: np.ndarray
    # Root motion of the frames played from each candidate, in its character frame (left is
    # imaginary, forward real): metres, and the new forward direction.
    moved: np.ndarray
    turned: np.ndarray

    @property
    def rows(self):
        """Features of the candidates."""
        return np.ascontiguousarray(self.features[self.candidates])


def load(path):
    header, arrays = read(path)
    features = arrays["features"].reshape(-1, PADDED)[:, :FEATURE]
    x, z, heading_x, heading_z = arrays["path"].reshape(-1, 4).T
    clips = [(clip["first"], clip["frames"] - TAIL) for clip in header["clips"]]
    candidates = np.concatenate([np.arange(first, first + count) for first, count in clips])
    place, heading = z + 1j * x, heading_z + 1j * heading_x
    after, to_local = candidates + PLAYED, heading[candidates].conj()
    return Database(
        features=np.ascontiguousarray(features),
        candidates=candidates,
        moved=to_local * (place[after] - place[candidates]),
        turned=to_local * heading[after],
    )


def read(path):
    """Header and arrays of a file as it was stored."""
    with open(path, "rb") as file:
        prefix, rest = file.read(24), file.read()
    if prefix[:16] != b"footworkdatabase":
        raise SystemExit(f"{path} is not a footwork database")
    if zlib.crc32(rest) != int.from_bytes(prefix[20:], "little"):
        raise SystemExit(f"{path} is damaged")
    length = int.from_bytes(rest[:8], "little")
    contents = json.loads(rest[8 : 8 + length])
    arrays, at = {}, 8 + length
    for name, count in contents["arrays"]:
        arrays[name] = np.frombuffer(rest, "<f4", count, at)
        at += 4 * count
    return contents["header"], arrays
