"""Our humanoid in MuJoCo, driven as footwork drives it.

The drives are implicit: their stiffness and damping add to the armature what a step of them resists,
and the rest is an applied force. MuJoCo itself is unmodified.
"""

from pathlib import Path

import mujoco
import numpy as np

from golden import FOLDER

MODEL = Path(__file__).parents[2] / "src" / "physics" / "humanoid.xml"
DT = 1 / 120


class Humanoid:
    def __init__(self, contacts=True, dt=DT, path=MODEL):
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.data = mujoco.MjData(self.model)
        option = self.model.opt
        option.timestep = dt
        option.integrator = mujoco.mjtIntegrator.mjINT_EULER
        option.cone = mujoco.mjtCone.mjCONE_PYRAMIDAL
        option.solver = mujoco.mjtSolver.mjSOL_NEWTON
        option.iterations, option.tolerance = 200, 1e-14
        # MuJoCo 4.0.0 factorises sparse matrices wrongly (its issue 3767).
        option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        option.disableflags |= mujoco.mjtDisableBit.mjDSBL_ACTUATION
        if not contacts:
            option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        self.armature = self.model.dof_armature.copy()
        self._drives()

    def _drives(self):
        m = self.model
        self.kp, self.kd, self.limit = (np.zeros(m.nv) for _ in range(3))
        for i in range(m.nu):
            joint = m.actuator_trnid[i, 0]
            axis = int(np.argmax(np.abs(m.actuator_gear[i, :3])))
            dof = m.jnt_dofadr[joint] + axis
            self.kp[dof] = m.actuator_gainprm[i, 0]
            self.kd[dof] = -m.actuator_biasprm[i, 2]
            self.limit[dof] = m.actuator_forcerange[i, 1]
        self.driven = np.flatnonzero(self.kp)

    def angles(self):
        """The angle, or the part of the rotation vector, of every degree of freedom."""
        m, q = self.model, self.data.qpos
        angles = np.zeros(m.nv)
        for joint in range(m.njnt):
            at, dof = m.jnt_qposadr[joint], m.jnt_dofadr[joint]
            if m.jnt_type[joint] == mujoco.mjtJoint.mjJNT_BALL:
                quat = q[at : at + 4] / np.linalg.norm(q[at : at + 4])
                mujoco.mju_quat2Vel(angles[dof : dof + 3], quat, 1.0)
            elif m.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
                angles[dof] = q[at]
        return angles

    def drive(self, targets):
        """Applies the drives; those that would pass their limit push with just that limit."""
        m, d, dt = self.model, self.data, self.model.opt.timestep
        wanted = np.zeros(m.nv)
        wanted[self.driven] = targets
        force = self.kp * (wanted - self.angles() - dt * d.qvel) - self.kd * d.qvel
        extra = dt * self.kd + dt * dt * self.kp
        m.dof_armature[:] = self.armature + extra
        d.qfrc_applied[:] = force
        flags = m.opt.disableflags
        m.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        mujoco.mj_forward(m, d)
        m.opt.disableflags = flags
        torque = force - extra * d.qacc
        over = (np.abs(torque) > self.limit) & (self.kp > 0)
        m.dof_armature[:] = self.armature + np.where(over, 0, extra)
        d.qfrc_applied[:] = np.where(over, np.copysign(self.limit, torque), force)

    def step(self, targets):
        self.drive(targets)
        mujoco.mj_step(self.model, self.data)

    def mass_matrix(self):
        full = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return full


def random_positions(model, rng, height, beyond=0.0):
    """Joints anywhere in their ranges (`beyond` them by a part of the range), the root anywhere."""
    q = np.zeros(model.nq)
    for joint in range(model.njnt):
        at, kind = model.jnt_qposadr[joint], model.jnt_type[joint]
        low, high = model.jnt_range[joint]
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            q[at : at + 3] = *rng.uniform(-2, 2, 2), rng.uniform(*height)
            q[at + 3 : at + 7] = unit(rng, 4)
        elif kind == mujoco.mjtJoint.mjJNT_BALL:
            angle = rng.uniform(0, high * (1 + beyond))
            q[at] = np.cos(angle / 2)
            q[at + 1 : at + 4] = np.sin(angle / 2) * unit(rng, 3)
        else:
            margin = beyond * (high - low)
            q[at] = rng.uniform(low - margin, high + margin)
    return single(q)


def unit(rng, size):
    vector = rng.normal(size=size)
    return vector / np.linalg.norm(vector)


def single(values):
    """What footwork, which computes in single precision, is given."""
    return np.asarray(values, np.float32).astype(np.float64)


def save(name, rows):
    """Rows of single-precision numbers, little-endian, one after another."""
    rows = np.asarray(rows, np.float32)
    assert np.isfinite(rows).all()
    path = FOLDER / name
    path.write_bytes(rows.astype("<f4").tobytes())
    print(f"{path.name}: {rows.shape[0]} rows of {rows.shape[1]}, {path.stat().st_size} bytes")
