"""Golden file of pairs of shapes and of the contacts that MuJoCo finds between them: `collide.json`.

A case: its pair, what is special about it, the sizes, places and quaternions (w, x, y, z) of both shapes, all in
single precision, and the contacts: place, normal, first tangent, distance.

python collide.py [cases of a pair]
"""

import json
import sys

import mujoco
import numpy as np

from golden import FOLDER

KINDS = ["plane", "sphere", "capsule", "box"]
PAIRS = [(a, b) for i, a in enumerate(KINDS) for b in KINDS[max(i, 1) :]]
STILL = np.array([1.0, 0, 0, 0])

rng = np.random.default_rng(3)


def single(values):
    return np.asarray(values, np.float32).astype(np.float64)


class Pair:
    """Two geoms whose sizes, places and turns can be set."""

    def __init__(self, first, second):
        self.names = f"{first} {second}"
        self.model = mujoco.MjModel.from_xml_string(
            f"""<mujoco><worldbody>
            <body mocap="true"><geom type="{first}" size="1 1 1"/></body>
            <body><freejoint/><geom type="{second}" size="1 1 1" mass="1"/></body>
            </worldbody></mujoco>"""
        )
        self.model.geom_rbound[:] = np.where(self.model.geom_rbound > 0, 10, 0)
        self.data = mujoco.MjData(self.model)

    def contacts(self, sizes, places, turns):
        m, d = self.model, self.data
        for geom, size in enumerate(sizes):
            m.geom_size[geom, : len(size)] = size
        d.mocap_pos[0], d.mocap_quat[0] = places[0], turns[0]
        d.qpos[:3], d.qpos[3:] = places[1], turns[1]
        mujoco.mj_kinematics(m, d)
        mujoco.mj_collision(m, d)
        touching = [c for c in d.contact if c.dist < 0]
        return np.array([[*c.pos, *c.frame[:6], c.dist] for c in touching]).reshape(-1, 10)


def unit(*shape):
    vector = rng.normal(size=(*shape, 3))
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def about(axis, angle):
    return np.array([np.cos(angle / 2), *(np.sin(angle / 2) * np.asarray(axis))])


def times(a, b):
    product = np.zeros(4)
    mujoco.mju_mulQuat(product, a, b)
    return product


def rotated(turn, vector):
    result = np.zeros(3)
    mujoco.mju_rotVecQuat(result, np.asarray(vector, float), turn)
    return result


def any_turn():
    turn = rng.normal(size=4)
    return turn / np.linalg.norm(turn)


def size_of(kind):
    if kind == "plane":
        return np.array([1.0, 1, 1])
    size = rng.uniform(0.05, 0.3, 3)
    return {"sphere": size[:1], "capsule": np.array([size[0] / 2, size[1]]), "box": size}[kind]


def reach(kind, size):
    return {"plane": 0, "sphere": size[0], "capsule": size.sum(), "box": np.linalg.norm(size)}[kind]


def anyhow(kinds, sizes):
    """Anywhere near."""
    turns = any_turn(), any_turn()
    offset = unit() * rng.uniform(0, 1) * sum(map(reach, kinds, sizes))
    return offset, turns


def aligned(kinds, sizes):
    """As often as not turned alike, faces or axes side by side."""
    base = [STILL, any_turn()][rng.integers(2)]
    offset = rng.uniform(-1, 1, 3) * 0.7 * sum(map(reach, kinds, sizes))
    quarter = about(np.eye(3)[rng.integers(3)], np.pi / 2 * rng.integers(4))
    return rotated(base, offset), (base, times(base, quarter))


def almost_aligned(kinds, sizes):
    """Tilted from that by 1e-7 to 0.1 rad."""
    offset, (first, second) = aligned(kinds, sizes)
    return offset, (first, times(second, about(unit(), 10 ** rng.uniform(-7, -1))))


def balanced(kinds, sizes):
    """Turned about one axis alone: edges on faces."""
    offset, (first, second) = aligned(kinds, sizes)
    return offset, (first, times(second, about(np.eye(3)[rng.integers(3)], rng.uniform(-np.pi, np.pi))))


def inside(kinds, sizes):
    """Centres within the other shape."""
    turns = any_turn(), any_turn()
    return unit() * rng.uniform(0, 0.3) * min(map(np.min, sizes)), turns


WAYS = [anyhow, anyhow, aligned, almost_aligned, balanced, inside]


def touching(pair, sizes, places, turns):
    """The second moved along the normal until the deepest contact is at most 1e-4 deep."""
    contacts = pair.contacts(sizes, places, turns)
    if len(contacts):
        deepest = contacts[contacts[:, 9].argmin()]
        moved = places[1] - deepest[3:6] * (deepest[9] + rng.uniform(1e-5, 1e-4))
        places = places[0], single(moved)
    return places


def settled(pair, contacts, sizes, places, turns):
    """Whether the contacts stay where they are when the input's last digit changes: MuJoCo decides by signs of
    numbers that may be nothing but rounding, as of a capsule that lies along a box."""
    for _ in range(16):
        near = places[0], places[1] + rng.uniform(-1e-7, 1e-7, 3)
        moved = pair.contacts(sizes, near, (turns[0], turns[1] + rng.uniform(-1e-7, 1e-7, 4)))
        if len(moved) != len(contacts):
            return False
        for contact in contacts:
            if np.linalg.norm(moved[:, :3] - contact[:3], axis=1).min() > 0.003:
                return False
    return True


def case(pair, kinds):
    way = WAYS[rng.integers(len(WAYS))]
    sizes = [single(size_of(kind)) for kind in kinds]
    if kinds[0] == kinds[1] and rng.integers(3) == 0:
        sizes[1] = sizes[0]
    offset, turns = way(kinds, sizes)
    start = rng.uniform(-0.5, 0.5, 3)
    turns = [single(turn) for turn in turns]
    places = single(start), single(start + offset)
    close = rng.integers(4) == 0
    if close:
        places = touching(pair, sizes, places, turns)
    contacts = pair.contacts(sizes, places, turns)
    # Those apart are one in ten.
    if not (len(contacts) or rng.integers(10) == 0) or not settled(pair, contacts, sizes, places, turns):
        return None
    return {
        "pair": pair.names,
        "way": way.__name__ + ", touching" * bool(close),
        "sizes": sizes,
        "places": places,
        "turns": turns,
        "contacts": contacts,
    }


def plain(value):
    """Numbers with as many digits as single precision needs."""
    if isinstance(value, np.ndarray):
        return [float(str(number)) for number in value.astype(np.float32).ravel()]
    raise TypeError(value)


def main(count=60):
    cases = []
    for kinds in PAIRS:
        pair, found = Pair(*kinds), []
        while len(found) < count:
            found += filter(None, [case(pair, kinds)])
        cases += found
    lines = [json.dumps(case, default=plain, separators=(",", ":")) for case in cases]
    path = FOLDER / "collide.json"
    path.write_text("[\n" + ",\n".join(lines) + "\n]\n")
    print(f"{path.name}: {len(cases)} cases, {path.stat().st_size} bytes")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
