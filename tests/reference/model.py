"""What MuJoCo makes of models: our humanoid, those in `models/`, random ones, and the reference's. Writes
model.json: what they are compiled into and, of `models/`, where they have moved after a fifth of a second."""

import json
import os
import re
from pathlib import Path

import mujoco
import numpy as np

from golden import FOLDER

HERE = Path(__file__).parent
OURS = HERE.parents[1] / "src" / "physics" / "humanoid.xml"
MOCAP = Path(os.environ.get("FOOTWORK_MOCAP", HERE.parents[2] / "shared" / "mocap"))
REFERENCE = MOCAP / "humanoid" / "ase" / "amp_humanoid.xml"
KINDS = {0: "free", 1: "ball", 3: "hinge"}
SHAPES = {0: "plane", 2: "sphere", 3: "capsule", 6: "box"}
SIZES = {0: 0, 2: 1, 3: 2, 6: 3}


def numbers(values):
    return [float(f"{value:.9g}") for value in np.ravel(values)]


def matrix(quat):
    out = np.zeros(9)
    mujoco.mju_quat2Mat(out, np.asarray(quat, float))
    return out.reshape(3, 3)


class Facts:
    """A compiled model in our terms: what cannot move is the world, and no body."""

    def __init__(self, model):
        self.m = model
        self.d = mujoco.MjData(self.m)
        mujoco.mj_kinematics(self.m, self.d)
        moving = [b for b in range(self.m.nbody) if self.m.body_weldid[b] != 0]
        self.index = {b: i for i, b in enumerate(moving)}
        touching = [g for g in range(self.m.ngeom) if self.m.geom_contype[g] or self.m.geom_conaffinity[g]]
        self.geoms = touching

    def all(self):
        m = self.m
        return {
            "bodies": [self.body(b) for b in self.index],
            "joints": [self.joint(j) for j in range(m.njnt)],
            "dofs": [self.dof(v) for v in range(m.nv)],
            "geoms": [self.geom(g) for g in self.geoms],
            "pairs": self.pairs(),
            "start": numbers(m.qpos0),
        }

    def seen(self, body, pos, quat):
        """A pose in a body, or in the world if the body cannot move."""
        if body in self.index:
            return numbers([*pos, *quat])
        turn = np.zeros(4)
        mujoco.mju_mulQuat(turn, self.d.xquat[body], np.asarray(quat, float))
        return numbers([*(self.d.xpos[body] + matrix(self.d.xquat[body]) @ pos), *turn])

    def body(self, b):
        m = self.m
        parent = m.body_parentid[b]
        axes = matrix(m.body_iquat[b])
        return {
            "name": m.body(b).name,
            "parent": self.index.get(parent),
            "pose": self.seen(parent, m.body_pos[b], m.body_quat[b]),
            "mass": numbers(m.body_mass[b])[0],
            "com": numbers(m.body_ipos[b]),
            "inertia": numbers(axes @ np.diag(m.body_inertia[b]) @ axes.T),
            "invweight0": numbers(m.body_invweight0[b, 0])[0],
        }

    def joint(self, j):
        m = self.m
        return {
            "name": m.joint(j).name,
            "kind": KINDS[m.jnt_type[j]],
            "body": self.index[m.jnt_bodyid[j]],
            "position": numbers(m.jnt_pos[j]),
            "axis": numbers(m.jnt_axis[j]),
            "range": self.range(j) if m.jnt_limited[j] else None,
            "solver_params": numbers([*m.jnt_solref[j], *m.jnt_solimp[j]]),
            "q": int(m.jnt_qposadr[j]),
            "v": int(m.jnt_dofadr[j]),
        }

    def range(self, j):
        """What the margin leaves of it: before its end a limit acts as one that ends there."""
        low = 0 if self.m.jnt_type[j] == mujoco.mjtJoint.mjJNT_BALL else 1
        return numbers(self.m.jnt_range[j] + self.m.jnt_margin[j] * np.array([low, -1]))

    def dof(self, v):
        m = self.m
        parent = int(m.dof_parentid[v])
        return {
            "body": self.index[m.dof_bodyid[v]],
            "parent": None if parent < 0 else parent,
            "armature": numbers(m.dof_armature[v])[0],
            "invweight0": numbers(m.dof_invweight0[v])[0],
            "spring": self.spring(v),
            "drive": self.drive(v),
        }

    def spring(self, v):
        """Stiffness, damping and rest, if there are any."""
        m, joint = self.m, self.m.dof_jntid[v]
        hinge = m.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE
        rest = m.qpos_spring[m.jnt_qposadr[joint]] if hinge else 0
        spring = [m.jnt_stiffness[joint], m.dof_damping[v]]
        return numbers([*spring, rest]) if any(spring) else None

    def drive(self, v):
        """Stiffness, damping, torque of a unit of the control, limit and range of the control, if there is an
        actuator."""
        m = self.m
        for i in range(m.nu):
            joint = m.actuator_trnid[i, 0]
            axis = int(np.argmax(np.abs(m.actuator_gear[i, :3])))
            if m.jnt_dofadr[joint] + axis != v:
                continue
            affine = m.actuator_biastype[i] == mujoco.mjtBias.mjBIAS_AFFINE
            gear = m.actuator_gear[i, axis]
            bias = m.actuator_biasprm[i, :3] if affine else np.zeros(3)
            assert bias[0] == 0
            limits = [abs(gear) * m.actuator_forcerange[i, 1]] if m.actuator_forcelimited[i] else []
            limits += [m.jnt_actfrcrange[joint, 1]] if m.jnt_actfrclimited[joint] else []
            stiffness = -gear * gear * bias[1]
            return {
                "gains": numbers([stiffness, -gear * gear * bias[2]]),
                "torque": numbers(gear * m.actuator_gainprm[i, 0] - stiffness)[0],
                "limit": float(min(limits)) if limits else None,
                "control": numbers(m.actuator_ctrlrange[i]) if m.actuator_ctrllimited[i] else None,
            }
        return None

    def geom(self, g):
        m = self.m
        body = m.geom_bodyid[g]
        kind = m.geom_type[g]
        return {
            "name": m.geom(g).name,
            "body": self.index.get(body),
            "shape": SHAPES[kind],
            "size": numbers(m.geom_size[g][: SIZES[kind]]),
            "pose": self.seen(body, m.geom_pos[g], m.geom_quat[g]),
            "friction": numbers(m.geom_friction[g, 0])[0],
            "frictionless": bool(m.geom_condim[g] == 1),
            "solver_params": numbers([*m.geom_solref[g], *m.geom_solimp[g]]),
        }

    def pairs(self):
        """Pairs that MuJoCo's default filter lets touch, in its own words; checked by having all touch."""
        m, place = self.m, {g: i for i, g in enumerate(self.geoms)}
        pairs = set()
        for a in self.geoms:
            for b in self.geoms:
                if a < b and self.meet(a, b):
                    pairs.add((place[a], place[b]))
        m.geom_margin[:] = m.body_margin[:] = 100
        mujoco.mj_collision(m, self.d)
        met = {tuple(sorted(place[g] for g in contact.geom)) for contact in self.d.contact}
        assert met <= pairs, met - pairs
        # Only of two boxes that are far apart MuJoCo says nothing, whatever the margin.
        silent = {int(m.geom_type[self.geoms[geom]]) for pair in pairs - met for geom in pair}
        assert silent <= {int(mujoco.mjtGeom.mjGEOM_BOX)}, pairs - met
        return sorted(pairs)

    def meet(self, a, b):
        m = self.m
        bodies = m.geom_bodyid[[a, b]]
        welds = m.body_weldid[bodies]
        above = m.body_weldid[m.body_parentid[welds]]
        if not (m.geom_contype[a] & m.geom_conaffinity[b] or m.geom_contype[b] & m.geom_conaffinity[a]):
            return False
        if welds[0] == welds[1]:
            return False
        if all(welds) and (welds[0] == above[1] or welds[1] == above[0]):
            return False
        signatures = {(min(bodies) << 16) + max(bodies), (max(bodies) << 16) + min(bodies)}
        return not signatures & set(m.exclude_signature.tolist())


class Random:
    """A small model with what a file may say in many ways."""

    def __init__(self, seed):
        self.rng = np.random.default_rng(seed)
        self.radian = bool(self.rng.integers(2))
        self.count = 0
        self.joints, self.bodies = [], []

    def chance(self, part):
        return self.rng.random() < part

    def vector(self, n, size=0.5):
        return " ".join(f"{x:.4g}" for x in self.rng.normal(0, size, n))

    def positive(self, n, low, high):
        return " ".join(f"{x:.4g}" for x in self.rng.uniform(low, high, n))

    def angles(self, degrees):
        return " ".join(f"{np.radians(x) if self.radian else x:.4g}" for x in degrees)

    def name(self):
        self.count += 1
        return f"n{self.count}"

    def klass(self, part):
        return f' class="{self.rng.choice(["outer", "inner", "main"])}"' if self.chance(part) else ""

    def orientation(self):
        return self.rng.choice(
            [
                "",
                f'quat="{self.vector(4)}"',
                f'euler="{self.angles(self.rng.uniform(-180, 180, 3))}"',
                f'axisangle="{self.vector(3)} {self.angles(self.rng.uniform(-180, 180, 1))}"',
                f'xyaxes="{self.vector(6)}"',
                f'zaxis="{self.vector(3)}"',
            ]
        )

    def geom(self):
        kind = self.rng.choice(["sphere", "capsule", "box"])
        place = f'pos="{self.vector(3)}" {self.orientation()}'
        if kind != "sphere" and self.chance(0.4):
            place = f'fromto="{self.vector(6)}"'
        size = self.positive({"sphere": 1, "capsule": 2, "box": 3}[kind], 0.02, 0.2)
        extra = self.rng.choice(
            ['mass=".7"', 'density="300"', 'friction=".4"', 'condim="1"', 'contype="2"', 'conaffinity="3"', 'contype="0" conaffinity="0"', 'solref=".03"', 'solimp=".8 .9"', ""]
        )
        return f'<geom name="{self.name()}"{self.klass(0.2)} type="{kind}" size="{size}" {place} {extra}/>'

    def joint(self, kind):
        name = self.name()
        self.joints.append((name, kind))
        low, high = self.rng.uniform(-90, 0), self.rng.uniform(10, 90)
        limits = self.angles([0 if kind == "ball" else low, high])
        limited = self.rng.choice(['limited="true"', 'limited="false"', ""])
        bound = f'range="{limits}" {limited}' if self.chance(0.6) else ""
        axis = f'axis="{self.vector(3)}"' if kind == "hinge" and self.chance(0.8) else ""
        extra = self.rng.choice(['armature=".3"', 'solreflimit=".03 .8"', 'solimplimit=".5 .9 .01"', ""])
        return f'<joint name="{name}"{self.klass(0.2)} type="{kind}" pos="{self.vector(3, 0.1)}" {axis} {bound} {extra}/>'

    def inertial(self):
        moments = 'diaginertia=".2 .25 .3" ' + self.orientation()
        if self.chance(0.5):
            moments = 'fullinertia=".2 .25 .3 .01 -.02 .03"'
        return f'<inertial pos="{self.vector(3, 0.1)}" mass="{self.positive(1, 0.1, 3)}" {moments}/>'

    def body(self, depth, free=False, still=False):
        name = self.name()
        self.bodies.append(name)
        childclass = f' childclass="{self.rng.choice(["outer", "inner"])}"' if self.chance(0.3) else ""
        lines = [f'<body name="{name}"{childclass} pos="{self.vector(3)}" {self.orientation()}>']
        kinds = [] if still else [["hinge"], ["ball"], ["hinge", "hinge"], ["hinge", "ball"], ["hinge"] * 3, []][self.rng.integers(6)]
        if free:
            lines.append(f'<freejoint name="{self.name()}"/>')
        else:
            lines += [self.joint(kind) for kind in kinds]
        lines += [self.geom() for _ in range(self.rng.integers(1, 3))]
        if self.chance(0.3):
            lines.append(self.inertial())
        if depth > 0:
            lines += [self.body(depth - 1) for _ in range(self.rng.integers(1, 3))]
        return "\n".join([*lines, "</body>"])

    def actuators(self):
        for name, kind in self.joints:
            if self.chance(0.6):
                axis = self.rng.integers(3) if kind == "ball" else 0
                gear = " ".join("1" if i == axis else "0" for i in range(3))
                rest = self.rng.choice(['kv="2"', 'forcerange="-5 5"', ""])
                yield f'<position joint="{name}"{self.klass(0.5)} gear="{gear}" kp="{self.positive(1, 1, 100)}" {rest}/>'

    def xml(self):
        world = ['<geom name="ground" type="plane" size="1 1 1"/>', self.geom()]
        world += [self.body(2, free=True), self.body(1), self.body(1, still=True)]
        pair = self.rng.choice(self.bodies, 2, replace=False)
        unit = "radian" if self.radian else "degree"
        masses = self.rng.choice(["auto", "true"])
        world, actuators = "\n".join(world), "\n".join(self.actuators())
        inner = '<geom solref=".01 .7" condim="1"/><position kv="3" forcerange="-7 7"/><joint axis="0 1 0"/>'
        return f"""<mujoco>
<compiler angle="{unit}" inertiafromgeom="{masses}"/>
<default><geom friction=".7 .1"/><joint armature=".02"/>
<default class="outer"><geom density="500" solimp=".7 .8 .01 .4 3"/><joint solreflimit=".05 2"/>
<default class="inner">{inner}</default></default></default>
<worldbody>{world}</worldbody>
<contact><exclude body1="{pair[0]}" body2="{pair[1]}"/></contact>
<actuator>{actuators}</actuator>
</mujoco>"""


def moved(model):
    """Where a model is after a fifth of a second of steady controls, some of them beyond their ranges, without
    contacts."""
    model.opt.timestep = 1e-4
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    data = mujoco.MjData(model)
    data.ctrl[:] = [0.7 * (-1) ** i for i in range(model.nu)]
    for _ in range(2000):
        mujoco.mj_step(model, data)
    return {"controls": numbers(data.ctrl), "q": numbers(data.qpos), "v": numbers(data.qvel)}


def main():
    compiled = mujoco.MjModel.from_xml_string
    models = {"humanoid": {"facts": Facts(compiled(OURS.read_text())).all()}}
    for path in sorted((HERE / "models").glob("*.xml")):
        if "<mujocoinclude>" not in path.read_text():
            from_file = mujoco.MjModel.from_xml_path
            models[path.stem] = {
                "facts": Facts(from_file(str(path))).all(),
                "moved": moved(from_file(str(path))),
            }
    # Others' model is compared with and not kept. Its floor is painted with a material that the file lacks.
    if REFERENCE.is_file() and FOLDER != HERE:
        reference = re.sub(' material="[a-z]*"', "", REFERENCE.read_text())
        models["reference"] = {"facts": Facts(compiled(reference)).all()}
    for seed in (1, 2):
        xml = Random(seed).xml()
        models[f"random {seed}"] = {"xml": xml, "facts": Facts(compiled(xml)).all()}
    (FOLDER / "model.json").write_text(json.dumps(models, separators=(",", ":")))


if __name__ == "__main__":
    main()
