"""Has a trained policy of the simulated humanoid act in MuJoCo: a policy that lives on errors of our own
simulator falls there.

    python3 -m venv reference && reference/bin/pip install --requirement tests/reference/requirements.txt
    reference/bin/python tests/reference/policy.py RUN/checkpoints/last.ckpt
    reference/bin/python tests/reference/policy.py RUN/checkpoints/last.ckpt --rate 120 --episodes 256 --jobs 2
    reference/bin/python tests/reference/policy.py RUN/checkpoints/last.ckpt --check

RUN is the folder of a training run whose policy observes its body alone, as those of the task `imitate` do.
Episodes start from states in which the checkpoint left its environments, and end with a fall or after
10 s. Of a policy that falls often, such states are falls already: `--starts` names another checkpoint, of
one that does not, whose states to take. Actions are the policy's means, 30 a second. `--rate` is that of
the physics, Hz; `--seed` draws the starts; `--jobs` is how many processes share the work. Prints one JSON
object: the part of the episodes without a fall, the speed of the root over the ground, m/s, and the mean
length of an episode, s.

`--check` instead compares single observations and steps with what the checkpoint's environments saw, as
the discriminator keeps it for replay: pairs of observations a control step apart, so many as `--episodes`.
The JSON object then holds `observation`, the largest difference of any number between an observation
and that of the same state in MuJoCo: rounding, if the script observes as our environments do; and three
pairs of root mean square differences, of the pelvis' height, m, and of the joints' speeds, rad/s. `step` is
between MuJoCo and our environments after the control step; those added to the mean action a random part
that the checkpoint does not tell. `noise` is what such a random part alone makes of the step in
MuJoCo: `step` should be hardly more. `still` is between the two observations of a pair, for scale.
"""

import argparse
import json
import struct
import zlib
from functools import cache, partial
from multiprocessing import Pool
from pathlib import Path

import mujoco
import numpy as np

from humanoid import Humanoid

CONTROL_RATE, SECONDS = 30, 10
MIN_HEAD, MIN_PELVIS, MIN_BODY = 0.9, 0.5, 0.15
FEET = "right_foot", "left_foot"
KEYS = "right_hand", "left_hand", *FEET
CLEARANCE = 1e-3
VERSION = 6


def read(path):
    """Header and arrays of a checkpoint; arrays are called `section/array`."""
    data = Path(path).read_bytes()
    magic, kind, version, checksum = struct.unpack_from("<8s8sII", data)
    if magic != b"footwork" or kind.rstrip(b"\0") != b"checkpt":
        raise SystemExit(f"{path} is not a footwork checkpoint")
    if version != VERSION:
        raise SystemExit(f"{path} has format version {version}; this script reads {VERSION}")
    if zlib.crc32(data[24:]) != checksum:
        raise SystemExit(f"{path} is damaged: its checksum does not match its contents")
    (length,) = struct.unpack_from("<Q", data, 24)
    contents = json.loads(data[32 : 32 + length])
    at, arrays = 32 + length, {}
    for name, words in contents["arrays"]:
        arrays[name] = np.frombuffer(data, "<f4", words, at)
        at += 4 * words
    return contents["header"], arrays


class Policy:
    """Observations to mean actions."""

    def __init__(self, header, arrays):
        own = header["policy"]
        inputs, self.action = own["observation"]["vector"], own["action"]
        widths = [inputs, *own["network"]["hidden"], self.action]
        flat, at = arrays["policy/parameters"].astype(float), 0
        self.layers = []
        for rows, columns in zip(widths, widths[1:]):
            weights = flat[at : at + rows * columns].reshape(rows, columns)
            at += rows * columns
            self.layers.append((weights, flat[at : at + columns]))
            at += columns
        self.deviation = np.exp(flat[-self.action :])
        self.activate = {"relu": lambda x: np.maximum(x, 0), "tanh": np.tanh}[own["network"]["activation"]]
        self.mean, self.std = np.zeros(inputs), np.ones(inputs)
        self.clip = np.inf
        if own["normalized"]:
            self.mean, variance = arrays["policy/normalizer.moments"].astype(float).reshape(2, inputs)
            self.std, self.clip = np.maximum(np.sqrt(variance), 0.01), 10

    def __call__(self, observation):
        x = np.clip((observation - self.mean) / self.std, -self.clip, self.clip)
        for weights, biases in self.layers[:-1]:
            x = self.activate(x @ weights + biases)
        weights, biases = self.layers[-1]
        return x @ weights + biases


class World:
    """The humanoid in MuJoCo as the policy sees and moves it."""

    def __init__(self, rate):
        if rate % CONTROL_RATE:
            raise SystemExit(f"--rate must be a multiple of {CONTROL_RATE}")
        self.substeps = rate // CONTROL_RATE
        self.body = Humanoid(dt=1 / rate)
        m = self.model = self.body.model
        self.data = self.body.data
        # As exact as training needs, and quicker.
        m.opt.iterations, m.opt.tolerance = 100, 1e-10
        self.pelvis, self.head = m.body("pelvis").id, m.body("head").id
        self.keys = [m.body(name).id for name in KEYS]
        feet = [m.body(name).id for name in FEET]
        self.others = [b for b in range(1, m.nbody) if b not in feet]
        self.soles = [m.geom(name).id for name in FEET]
        self.offset, self.scale = self.action_scale()

    def action_scale(self):
        """Targets of the drives at the action zero, and of how much one is more."""
        offsets, scales = [], []
        for dof in self.body.driven:
            joint = self.model.dof_jntid[dof]
            low, high = self.model.jnt_range[joint]
            if self.model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
                offsets.append(0.5 * (low + high))
                scales.append(0.7 * (high - low))
            else:
                offsets.append(0.0)
                scales.append(min(1.2 * high, np.pi))
        return np.array(offsets), np.array(scales)

    def begin(self, q, v):
        """Begins at a state."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:], self.data.qvel[:] = q, v
        mujoco.mj_kinematics(self.model, self.data)

    def begin_above(self, q, v):
        """Begins at a state, lifted out of the ground."""
        self.begin(q, v)
        self.data.qpos[2] += max(CLEARANCE - self.lowest(), 0)
        mujoco.mj_kinematics(self.model, self.data)

    def lowest(self):
        """Height of the lowest corner of the feet."""
        reach = [np.abs(self.data.geom_xmat[g].reshape(3, 3)[2]) @ self.model.geom_size[g] for g in self.soles]
        return np.min(self.data.geom_xpos[self.soles, 2] - reach)

    def act(self, action):
        """A control step."""
        targets = self.offset + self.scale * np.clip(action, -1, 1)
        for _ in range(self.substeps):
            self.body.step(targets)
        mujoco.mj_kinematics(self.model, self.data)

    def fallen(self):
        height = self.data.xpos[:, 2]
        return (
            not np.isfinite(self.data.qpos).all()
            or height[self.head] < MIN_HEAD
            or height[self.pelvis] < MIN_PELVIS
            or height[self.others].min() < MIN_BODY
        )

    def observe(self):
        """What the body observes of itself."""
        m, d = self.model, self.data
        root = d.xmat[self.pelvis].reshape(3, 3)
        ahead = root[:2, 0]
        length = np.hypot(*ahead)
        x, y = ahead / length if length > 1e-6 else (1.0, 0.0)
        heading = np.array([[x, y, 0], [-y, x, 0], [0, 0, 1]])
        out = [d.xpos[self.pelvis, 2:], *sixes(heading @ root)]
        out += [heading @ d.qvel[:3], heading @ root @ d.qvel[3:6]]
        for joint in range(1, m.njnt):
            at = m.jnt_qposadr[joint]
            if m.jnt_type[joint] == mujoco.mjtJoint.mjJNT_BALL:
                turn = np.zeros(9)
                mujoco.mju_quat2Mat(turn, d.qpos[at : at + 4] / np.linalg.norm(d.qpos[at : at + 4]))
                out += sixes(turn.reshape(3, 3))
            else:
                out.append(d.qpos[at : at + 1])
        out.append(d.qvel[6:])
        below = np.array([*d.xpos[self.pelvis, :2], 0])
        out += [heading @ (d.xpos[key] - below) for key in self.keys]
        return np.concatenate(out)

    def state(self, observation):
        """The state, at the world's origin and heading along x, that an observation is of."""
        m, rest = self.model, list(observation)

        def take(count):
            taken = np.array(rest[:count])
            del rest[:count]
            return taken

        q, v = np.zeros(m.nq), np.zeros(m.nv)
        q[2] = take(1)[0]
        q[3:7] = quaternion(take(6))
        v[:3], angular = take(3), take(3)
        root = np.zeros(9)
        mujoco.mju_quat2Mat(root, q[3:7])
        v[3:6] = root.reshape(3, 3).T @ angular
        for joint in range(1, m.njnt):
            at = m.jnt_qposadr[joint]
            if m.jnt_type[joint] == mujoco.mjtJoint.mjJNT_BALL:
                q[at : at + 4] = quaternion(take(6))
            else:
                q[at] = take(1)[0]
        v[6:] = take(m.nv - 6)
        return q, v


def sixes(matrix):
    """Where a rotation takes the axes x and z."""
    return [matrix[:, 0], matrix[:, 2]]


def quaternion(six):
    x, z = six[:3], six[3:]
    out = np.zeros(4)
    mujoco.mju_mat2Quat(out, np.stack([x, np.cross(z, x), z], axis=1).ravel())
    return out


def starts(arrays, model):
    """The states `[n][nq + nv]` of the environments."""
    width = model.nq + model.nv
    groups = [name for name in arrays if name.startswith("envs.") and name.endswith("/state")]
    if not groups or any(arrays[name].size % width for name in groups):
        raise SystemExit("the checkpoint has no environments of one humanoid alone")
    return np.concatenate([arrays[name].astype(float).reshape(width, -1).T for name in groups])


def episode(path, rate, state):
    """Control steps, whether it fell, and the root's way over the ground."""
    policy, world = made(path, rate)
    world.begin_above(state[: world.model.nq], state[world.model.nq :])
    way = []
    for step in range(SECONDS * CONTROL_RATE):
        before = world.data.qpos[:2].copy()
        world.act(policy(world.observe()))
        way.append(np.hypot(*(world.data.qpos[:2] - before)))
        if world.fallen():
            return step + 1, True, sum(way)
    return len(way), False, sum(way)


@cache
def made(path, rate):
    """Policy and world, once a process."""
    return Policy(*read(path)), World(rate)


def run(args):
    header, arrays = read(args.checkpoint)
    world = World(args.rate)
    observed = header["policy"]["observation"]
    if observed["grid"] or observed["vector"] != world.observe().size:
        raise SystemExit("the policy observes more than its body: train one with the task imitate")
    states = starts(read(args.starts)[1] if args.starts else arrays, world.model)
    rng = np.random.default_rng(args.seed)
    chosen = rng.choice(len(states), args.episodes, replace=args.episodes > len(states))
    own = partial(episode, args.checkpoint, args.rate)
    if args.jobs > 1:
        with Pool(args.jobs) as pool:
            ends = pool.map(own, states[chosen], chunksize=1)
    else:
        ends = [own(state) for state in states[chosen]]
    steps, fallen, way = (np.array(column, float) for column in zip(*ends))
    return {
        "rate": args.rate,
        "episodes": args.episodes,
        "survival": round(1 - fallen.mean(), 4),
        "mean_speed": round(way.sum() / steps.sum() * CONTROL_RATE, 4),
        "mean_episode_s": round(steps.mean() / CONTROL_RATE, 3),
    }


def check(args):
    """Against the pairs of observations that the discriminator keeps for replay."""
    header, arrays = read(args.checkpoint)
    policy, world = Policy(header, arrays), World(args.rate)
    size, joints = world.observe().size, world.model.nv - 6
    kept = arrays.get("learner/discriminator.replay.windows")
    if kept is None or kept.size % (2 * size):
        raise SystemExit("the checkpoint keeps no pairs of observations: train one with the task imitate")
    # Room that is not filled yet holds zeros.
    pairs = kept.reshape(-1, 2, size)[kept.reshape(-1, 2, size)[:, 0, 0] != 0].astype(float)
    rng = np.random.default_rng(args.seed)
    pairs = pairs[rng.choice(len(pairs), min(args.episodes, len(pairs)), replace=False)]
    largest, squares = 0.0, {"step": [], "noise": [], "still": []}

    def square(one, other):
        """Mean squares of the differences of the pelvis' height and of the joints' speeds."""
        delta = (one - other) ** 2
        # Behind the joints' speeds come only the hands' and feet's positions.
        end = size - 3 * len(KEYS)
        return delta[0], delta[end - joints : end].mean()

    for now, then in pairs:
        state = world.state(now)

        def after(action):
            world.begin(*state)
            world.act(action)
            return world.observe()

        world.begin(*state)
        largest = max(largest, np.abs(world.observe() - now).max())
        mean = policy(now)
        plain = after(mean)
        squares["step"].append(square(plain, then))
        squares["noise"].append(square(plain, after(mean + policy.deviation * rng.normal(size=mean.size))))
        squares["still"].append(square(now, then))
    differences = {name: np.sqrt(np.mean(rows, axis=0)).round(5).tolist() for name, rows in squares.items()}
    return {"rate": args.rate, "pairs": len(pairs), "observation": float(f"{largest:.3g}"), **differences}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint", type=Path)
    parser.add_argument("--rate", type=int, default=480)
    parser.add_argument("--episodes", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--starts", type=Path)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--check", action="store_true")
    args = parser.parse_args()
    print(json.dumps((check if args.check else run)(args)))
