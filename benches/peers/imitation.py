"""The task `imitate` in MuJoCo.

MuJoCo's C engine steps a batch of humanoids on all cores (`mujoco.batch`). What a body observes is computed
in JAX from positions and velocities: the kinematics that MuJoCo leaves behind are those before the
last substep, and new ones cost it a collision detection.
"""

import json
from functools import partial
from pathlib import Path
from typing import NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from mujoco.batch import Batch
from scipy.spatial.transform import Rotation, Slerp

MODEL = Path(__file__).parents[2] / "src" / "physics" / "humanoid.xml"

# The task: `src/env/humanoid/task/rules.rs`, `src/env/humanoid/recorded.rs`. Hertz, seconds, metres, m/s.
RATE, SUBSTEPS, SECONDS = 30, 4, 10
MIN_HEAD, MIN_PELVIS, MIN_BODY, MAX_SPEED = 0.9, 0.5, 0.15, 1e3
STARTS, CLEARANCE = 4096, 1e-3
STEPS = RATE * SECONDS
FEET = "right_foot", "left_foot"
KEYS = "right_hand", "left_hand", *FEET

# A frame of DeepMimic's: its duration, the root's position and rotation, then these joints.
LIMBS = ["hip", "knee", "ankle", "shoulder", "elbow"]
JOINTS = ["abdomen", "neck", *(f"{side}_{part}" for side in ["right", "left"] for part in LIMBS)]
# Its y is up and its z to the right; here z is up and -y to the right. Quaternions begin with w.
UPRIGHT, SIGNS = [0, 1, 3, 2], [1, 1, -1, 1]


class Body:
    """The humanoid as a policy sees and moves it."""

    def __init__(self):
        m = self.model = mujoco.MjModel.from_xml_path(str(MODEL))
        m.opt.timestep = 1 / (RATE * SUBSTEPS)
        # footwork's solver; here it is quicker than the default.
        m.opt.solver, m.opt.iterations = mujoco.mjtSolver.mjSOL_PGS, 20
        # MuJoCo 4.0.0 factorises sparse matrices wrongly (its issue 3767).
        m.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        # What diverges is to end as a fall, not to stand up again.
        m.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self.make_drives_implicit()
        self.joint_of = {int(body): joint for joint, body in enumerate(m.jnt_bodyid)}
        self.pelvis, self.head = m.body("pelvis").id, m.body("head").id
        self.keys = [m.body(name).id for name in KEYS]
        self.soles = [m.geom(name).id for name in FEET]
        self.others = [b for b in range(1, m.nbody) if m.body(b).name not in FEET]
        self.offset, self.scale = self.action_scale()

    def make_drives_implicit(self):
        """Adds to the armature what drives resist of a step, as footwork does.

        MuJoCo's own implicit integrators know the damping only, and constraints are solved without it.
        """
        m, dt = self.model, self.model.opt.timestep
        m.actuator_biasprm[:, 2] -= dt * m.actuator_gainprm[:, 0]
        # Drives come in the order of the degrees of freedom.
        m.dof_armature[6:] -= dt * m.actuator_biasprm[:, 2]
        # Explicit limits of the torque would make them jump from one limit to the other; footwork's drives, whose
        # limits are implicit, hardly ever get there.
        m.actuator_forcelimited[:] = 0

    def is_ball(self, joint):
        return self.model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_BALL

    def rotations(self):
        """Where quaternions are among the positions, and the angular velocities that belong to them."""
        m = self.model
        balls = [j for j in range(1, m.njnt) if self.is_ball(j)]
        return [(3, 3), *((m.jnt_qposadr[j], m.jnt_dofadr[j]) for j in balls)]

    def action_scale(self):
        """Targets of the drives at the action zero, and by how much one more of it changes them."""
        m = self.model
        joints = m.actuator_trnid[:, 0]
        (low, high), ball = m.jnt_range[joints].T, self.is_ball(joints)
        offset = np.where(ball, 0, 0.5 * (low + high))
        scale = np.where(ball, np.minimum(1.2 * high, np.pi), 0.7 * (high - low))
        return offset.astype(np.float32), scale.astype(np.float32)

    def rest_action(self, q):
        """Actions, `[n][nu]`, whose targets are positions `[n][nq]`."""
        m = self.model
        targets = np.zeros((len(q), m.nv))
        targets[:, m.jnt_dofadr] = q[:, m.jnt_qposadr]
        for at, dof in self.rotations():
            targets[:, dof : dof + 3] = rotation(q, at).as_rotvec()
        return (targets[:, 6:] - self.offset) / self.scale

    def kinematics(self, q):
        """Rotations of the joints, then positions and rotations of the bodies, from positions `[nq][n]`."""
        m = self.model
        joints, places = {}, {0: jnp.zeros((3, 1))}
        rotations = {0: jnp.eye(3)[..., None]}
        for body in range(1, m.nbody):
            parent, joint = m.body_parentid[body], self.joint_of.get(body)
            at = m.jnt_qposadr[joint] if joint is not None else None
            places[body] = places[parent] + turn(rotations[parent], m.body_pos[body][:, None])
            rotations[body] = rotations[parent]
            if body == self.pelvis:
                places[body], rotations[body] = q[:3], matrix(q[3:7])
            elif joint is not None:
                ball = self.is_ball(joint)
                joints[joint] = matrix(q[at : at + 4] if ball else about(m.jnt_axis[joint], q[at]))
                rotations[body] = product(rotations[parent], joints[joint])
        return joints, places, rotations

    def observe(self, q, v):
        """Observations of the bodies by themselves, `[n][105]`, and whether they have fallen, at positions
        `[n][nq]` and velocities `[n][nv]`."""
        m, q, v = self.model, jnp.asarray(q, jnp.float32).T, jnp.asarray(v, jnp.float32).T
        joints, places, rotations = self.kinematics(q)
        root = rotations[self.pelvis]
        heading = upright(root)
        out = [q[2:3], *sixes(product(heading, root))]
        out += [turn(heading, v[:3]), turn(heading, turn(root, v[3:6]))]
        for joint in range(1, m.njnt):
            at = m.jnt_qposadr[joint]
            out += sixes(joints[joint]) if self.is_ball(joint) else [q[at : at + 1]]
        below = q[:3] * np.array([[1], [1], [0]])
        out += [v[6:], *(turn(heading, places[key] - below) for key in self.keys)]
        return jnp.concatenate(out).T, ~self.stands(places, v)

    def stands(self, places, v):
        """Whether bodies have neither fallen nor diverged; comparisons with NaN are false."""
        heights = jnp.stack([places[body][2] for body in self.others])
        up = (places[self.head][2] >= MIN_HEAD) & (places[self.pelvis][2] >= MIN_PELVIS)
        return up & (heights.min(0) >= MIN_BODY) & (jnp.abs(v).max(0) < MAX_SPEED)

    def lowest(self, q):
        """Height of the lowest corner of the feet, `[n]`."""
        m = self.model
        _, places, rotations = self.kinematics(jnp.asarray(q, jnp.float32).T)
        heights = []
        for sole in self.soles:
            body, up = m.geom_bodyid[sole], rotations[m.geom_bodyid[sole]][2]
            reach = m.geom_pos[sole] @ up - m.geom_size[sole] @ jnp.abs(up)
            heights.append(places[body][2] + reach)
        return np.asarray(jnp.min(jnp.stack(heights), axis=0))


# Rotations of bodies side by side: matrices are `[3][3][n]`, vectors `[3][n]`.


def matrix(quaternion):
    w, x, y, z = quaternion / jnp.linalg.norm(quaternion, axis=0)
    return jnp.stack(
        [
            jnp.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)]),
            jnp.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)]),
            jnp.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]),
        ]
    )


def about(axis, angle):
    """The quaternion of a rotation about an axis."""
    half = 0.5 * angle
    return jnp.stack([jnp.cos(half), *(jnp.sin(half) * number for number in axis)])


def turn(rotation, vector):
    return sum(rotation[:, k] * vector[k] for k in range(3))


def product(one, other):
    return sum(one[:, k, None] * other[None, k] for k in range(3))


def sixes(rotation):
    """Where a rotation takes the axes x and z."""
    return [rotation[:, 0], rotation[:, 2]]


def upright(root):
    """Takes the direction in which a root faces to x."""
    x, y = root[0, 0], root[1, 0]
    length = jnp.hypot(x, y)
    x, y = jnp.where(length > 1e-6, jnp.stack([x, y]) / length, jnp.array([[1.0], [0.0]]))
    zero = jnp.zeros_like(x)
    return jnp.stack(
        [jnp.stack([x, y, zero]), jnp.stack([-y, x, zero]), jnp.stack([zero, zero, zero + 1])]
    )


# Recordings.


class Clip(NamedTuple):
    """A recording of the body at `RATE`: positions and velocities."""

    q: np.ndarray
    v: np.ndarray

    def seconds(self):
        return (len(self.q) - 1) / RATE

    def speed(self):
        """Mean speed of the root over the ground."""
        return np.hypot(*np.diff(self.q[:, :2], axis=0).T).sum() / self.seconds()


def rotation(q, at):
    return Rotation.from_quat(q[:, at : at + 4], scalar_first=True)


def between(body, times, q, wanted):
    """Positions at wanted times from those at others."""
    out = np.column_stack([np.interp(wanted, times, column) for column in q.T])
    for at, _ in body.rotations():
        out[:, at : at + 4] = Slerp(times, rotation(q, at))(wanted).as_quat(scalar_first=True)
    return out


def read_clip(path, body):
    """A recording of DeepMimic's on the ground: as `src/physics/deepmimic.rs`."""
    frames = np.array(json.loads(Path(path).read_text())["Frames"])
    times = np.cumsum(frames[:, 0]) - frames[:, 0]
    wanted = np.arange(int(times[-1] * RATE + 1e-2) + 1) / RATE
    q = between(body, times, positions(body, frames[:, 1:]), np.minimum(wanted, times[-1]))
    q = within_ranges(body, q)
    q[:, :2] -= q[0, :2]
    q[:, 2] -= body.lowest(q).min()
    return Clip(q, velocities(body, q))


def positions(body, numbers):
    """The humanoid's positions, `[frame][nq]`, in frames of DeepMimic's."""
    m = body.model
    q = np.zeros((len(numbers), m.nq))
    q[:, :3] = numbers[:, [0, 2, 1]] * SIGNS[1:]
    q[:, 3:7] = numbers[:, 3:7][:, UPRIGHT] * SIGNS
    taken = 7
    for name in JOINTS:
        joint = m.joint(name).id
        at = m.jnt_qposadr[joint]
        if body.is_ball(joint):
            q[:, at : at + 4] = numbers[:, taken : taken + 4][:, UPRIGHT] * SIGNS
            taken += 4
        else:
            # Hinges turn about z there, which is -y here.
            q[:, at] = -numbers[:, taken]
            taken += 1
    return q


def within_ranges(body, q):
    m = body.model
    for joint in range(1, m.njnt):
        at, (low, high) = m.jnt_qposadr[joint], m.jnt_range[joint]
        if body.is_ball(joint):
            vector = rotation(q, at).as_rotvec()
            angle = np.linalg.norm(vector, axis=1, keepdims=True)
            vector *= np.minimum(1, high / np.maximum(angle, 1e-9))
            q[:, at : at + 4] = Rotation.from_rotvec(vector).as_quat(scalar_first=True)
        else:
            q[:, at] = np.clip(q[:, at], low, high)
    return q


def velocities(body, q):
    """Differences of the frames on either side, one-sided at the ends."""
    m, frames = body.model, np.arange(len(q))
    before, after = np.maximum(frames - 1, 0), np.minimum(frames + 1, len(q) - 1)
    rate = RATE / (after - before)[:, None]
    v = np.zeros((len(q), m.nv))
    difference = (q[after] - q[before]) * rate
    v[:, m.jnt_dofadr] = difference[:, m.jnt_qposadr]
    v[:, :3] = difference[:, :3]
    for at, dof in body.rotations():
        turned = rotation(q[before], at).inv() * rotation(q[after], at)
        v[:, dof : dof + 3] = turned.as_rotvec() * rate
    return v


def start_states(body, clip, rng):
    """Positions and velocities at random times of a recording, lifted out of the ground."""
    frame = rng.uniform(0, len(clip.q) - 1, STARTS)
    q = between(body, np.arange(len(clip.q)), clip.q, frame)
    before = frame.astype(int)
    share = (frame - before)[:, None]
    v = (1 - share) * clip.v[before] + share * clip.v[before + 1]
    q[:, 2] += np.maximum(CLEARANCE - body.lowest(q), 0)
    return q, v


# Environments.


@partial(jax.jit, static_argnums=0)
def arrive(body, before, q, v, age, limit, starts, chosen):
    """The outcome of a step: the observation after it, falls and ends, and the observation that the next step
    begins with. Of bodies that have diverged nothing new is observed."""
    after, fallen = body.observe(q, v)
    sound = jnp.isfinite(after).all(1, keepdims=True)
    after = jnp.where(sound, after, before)
    ended = fallen | (age >= limit)
    return after, fallen, ended, jnp.where(ended[:, None], starts[chosen], after)


class Environments:
    """Bodies side by side, each in an episode of its own."""

    def __init__(self, body, clip, envs, threads, seed, staggered=True):
        self.body, self.rng = body, np.random.default_rng(seed)
        self.starts = start_states(body, clip, self.rng)
        self.start_observations = jax.jit(body.observe)(*self.starts)[0]
        self.batch = Batch(body.model, nsim=envs, nthread=threads)
        names = ["qpos", "qvel", "ctrl", "qacc_warmstart"]
        self.q, self.v, self.targets, self.warm_start = map(self.batch.bind, names)
        self.age = np.zeros(envs, np.int32)
        # The first episodes have all lengths.
        early = self.rng.integers(STEPS, size=envs) if staggered else 0
        self.limit = np.full(envs, STEPS, np.int32) - np.int32(early)
        chosen = self.draw()
        self.begin(np.arange(envs), chosen)
        self.observation = self.start_observations[chosen]

    def draw(self):
        return self.rng.integers(STARTS, size=len(self.age))

    def begin(self, which, chosen):
        self.q[which], self.v[which] = (state[chosen] for state in self.starts)
        self.warm_start[which] = 0

    def step(self, targets):
        """Plays a step with targets for the drives. Returns the observation after it, which bodies have fallen and
        which episodes have ended."""
        self.targets[:] = targets
        self.batch.step(nstep=SUBSTEPS)
        self.age += 1
        chosen = self.draw()
        states = np.float32(self.q), np.float32(self.v)
        after, fallen, ended, self.observation = arrive(
            self.body, self.observation, *states, self.age, self.limit, self.start_observations, chosen
        )
        which = np.flatnonzero(ended)
        self.begin(which, chosen[which])
        self.age[which], self.limit[which] = 0, STEPS
        return after, fallen, ended
