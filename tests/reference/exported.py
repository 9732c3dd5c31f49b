"""Has an exported policy move its exported model in MuJoCo, by nothing but the two files: what the policy observes and
does is in its file's metadata, and how the model is driven in the model.

    footwork export RUN --format onnx --out policy.onnx
    footwork export RUN --format mjcf --out body.xml
    reference/bin/python tests/reference/exported.py policy.onnx body.xml --push 2 4

The policy must observe its body alone, as those of the tasks `stand` and `imitate` do. Episodes begin near the
model's own start, each joint turned by up to `--spread` rad about each of its axes; `--push` pushes the body `torso`
every 1 to 2 s by an impulse between the two, N s, in any horizontal direction, as training to stand does. Episodes end
with a fall, or after the task's time. `--film` writes the positions of the first episode, a row a step, as text. Prints
one JSON object: the part of the episodes without a fall, and the mean length of an episode, s.
"""

import argparse
import json

import mujoco
import numpy as np
import onnxruntime


class Body:
    """A model of one character in MuJoCo, seen as exported policies describe it."""

    def __init__(self, path):
        self.model = mujoco.MjModel.from_xml_path(path)
        self.data = mujoco.MjData(self.model)
        self.substeps = int(self.model.numeric("substeps").data[0])
        self.step_s = self.substeps * self.model.opt.timestep
        # The first body hangs on the world by the only free joint.
        self.root = 1
        assert self.model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE

    def begin(self, rng, spread):
        m, d = self.model, self.data
        mujoco.mj_resetData(m, d)
        turn = np.zeros(m.nv)
        turn[6:] = rng.uniform(-spread, spread, m.nv - 6)
        mujoco.mj_integratePos(m, d.qpos, turn, 1.0)
        mujoco.mj_forward(m, d)
        # Out of the ground, if it is in it.
        depth = min((contact.dist for contact in d.contact), default=0.0)
        d.qpos[2] += max(-depth, 0.0)
        mujoco.mj_forward(m, d)

    def step(self):
        for _ in range(self.substeps):
            mujoco.mj_step(self.model, self.data)
        # Positions of bodies are those before the last step otherwise.
        mujoco.mj_kinematics(self.model, self.data)

    def quantities(self):
        """All that is observed, by name."""
        m, d = self.model, self.data
        root = d.xmat[self.root].reshape(3, 3)
        x, y = root[:2, 0] / np.hypot(*root[:2, 0])
        heading = np.array([[x, y, 0], [-y, x, 0], [0, 0, 1]])
        at = d.xpos[self.root]
        below = np.array([*at[:2], 0])
        found = {
            "root_height": at[2:],
            "root_rotation": two_axes(heading @ root),
            "root_velocity": heading @ d.qvel[:3],
            "root_angular_velocity": heading @ root @ d.qvel[3:6],
            "joint_velocities": d.qvel[6:],
        }
        for joint in range(1, m.njnt):
            q = d.qpos[m.jnt_qposadr[joint] :]
            ball = m.jnt_type[joint] == mujoco.mjtJoint.mjJNT_BALL
            found[m.joint(joint).name] = two_axes(matrix(q[:4])) if ball else q[:1]
        for body in range(1, m.nbody):
            found[m.body(body).name + "_position"] = heading @ (d.xpos[body] - below)
        return found

    def fallen(self, least):
        """Whether a body is below the height that is allowed for it, m."""
        height = {self.model.body(b).name: self.data.xpos[b, 2] for b in range(1, self.model.nbody)}
        height["any body but the feet"] = min(at for name, at in height.items() if "foot" not in name)
        return not np.isfinite(self.data.qpos).all() or any(height[name] < least[name] for name in least)


def matrix(quat):
    out = np.zeros(9)
    mujoco.mju_quat2Mat(out, quat / np.linalg.norm(quat))
    return out.reshape(3, 3)


def two_axes(turn):
    """Where a rotation takes the axes x and z."""
    return np.concatenate([turn[:, 0], turn[:, 2]])


class Policy:
    """A network, and what it says of itself."""

    def __init__(self, path):
        self.session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
        self.about = json.loads(self.session.get_modelmeta().custom_metadata_map["footwork"])
        if len(self.about["inputs"]) != 1:
            raise SystemExit("the policy is given more than what it observes: export one of the task stand or imitate")
        (self.input,) = self.about["inputs"]
        (self.output,) = [port for port in self.about["outputs"] if port["name"] == "targets"]
        self.elements = [element for part in self.output["parts"] for element in part["elements"]]

    def observation(self, quantities):
        row = []
        for part in self.input["parts"]:
            if part["name"] not in quantities:
                raise SystemExit(f"the policy observes more than its body: {part['meaning']}")
            value = np.asarray(quantities[part["name"]])
            assert value.size == len(part["elements"]), part
            row.append((value - np.array(part.get("mean", 0))) * np.array(part.get("scale", 1)))
        return np.concatenate(row).astype(np.float32)[None]

    def __call__(self, quantities):
        """Targets of the drives by their names."""
        feed = {self.input["name"]: self.observation(quantities)}
        (targets,) = self.session.run([self.output["name"]], feed)
        return dict(zip(self.elements, targets[0], strict=True))


class Pushes:
    """Impulses of one step's length, every 1 to 2 s."""

    def __init__(self, body, rng, impulse):
        self.body, self.rng, self.impulse = body, rng, impulse
        self.torso = body.model.body("torso").id
        self.next = 0
        self.draw()

    def draw(self):
        self.next += round(self.rng.uniform(1, 2) / self.body.step_s)

    def push(self, step):
        force = np.zeros(6)
        if step == self.next:
            angle = self.rng.uniform(0, 2 * np.pi)
            size = self.rng.uniform(*self.impulse) / self.body.step_s
            force[:2] = size * np.cos(angle), size * np.sin(angle)
            self.draw()
        self.body.data.xfrc_applied[self.torso] = force


def episode(policy, body, rng, args):
    """Steps, whether it fell, and the positions before each step."""
    rules = policy.about["episode"]
    body.begin(rng, args.spread)
    pushes = Pushes(body, rng, args.push) if args.push else None
    ctrl = [body.model.actuator(name).id for name in policy.elements]
    steps, film = round(rules["episode_s"] / body.step_s), []
    for step in range(steps):
        film.append(body.data.qpos.copy())
        targets = policy(body.quantities())
        body.data.ctrl[ctrl] = [targets[name] for name in policy.elements]
        if pushes:
            pushes.push(step)
        body.step()
        if body.fallen(rules["falls_below_m"]):
            return step + 1, True, film
    return steps, False, film


def main(args):
    policy, body = Policy(args.policy), Body(args.model)
    if abs(policy.about["step_s"] - body.step_s) > 1e-6:
        raise SystemExit(f"the policy's step is {policy.about['step_s']} s, that of the model {body.step_s} s")
    rng = np.random.default_rng(args.seed)
    ends = [episode(policy, body, rng, args) for _ in range(args.episodes)]
    if args.film:
        np.savetxt(args.film, ends[0][2])
    return {
        "episodes": args.episodes,
        "survival": round(1 - np.mean([fallen for _, fallen, _ in ends]), 4),
        "mean_episode_s": round(float(np.mean([steps for steps, _, _ in ends])) * body.step_s, 3),
    }


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("policy")
    parser.add_argument("model")
    parser.add_argument("--episodes", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--spread", type=float, default=0.08)
    parser.add_argument("--push", type=float, nargs=2)
    parser.add_argument("--film")
    print(json.dumps(main(parser.parse_args())))
