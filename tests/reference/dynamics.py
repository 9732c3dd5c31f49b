"""Golden file of 1,000 random states of the humanoid without contact: `dynamics.f32`.

A row: q, v, targets, probe; places of the bodies, mass matrix times probe, bias, acceleration.
"""

import mujoco
import numpy as np

from humanoid import Humanoid, random_positions, save, single

rng = np.random.default_rng(6)
body = Humanoid(contacts=False)
model, data = body.model, body.data
rows = []
for _ in range(1000):
    data.qpos[:] = random_positions(model, rng, (0, 3))
    data.qvel[:] = single(rng.normal(size=model.nv) * 3)
    targets = single(rng.uniform(-1, 1, len(body.driven)))
    probe = single(rng.normal(size=model.nv))
    body.drive(targets)
    mujoco.mj_forward(model, data)
    acceleration = data.qacc.copy()
    model.dof_armature[:] = body.armature
    mujoco.mj_forward(model, data)
    rows.append(
        np.concatenate(
            [data.qpos, data.qvel, targets, probe, data.xpos[1:].ravel()]
            + [body.mass_matrix() @ probe, data.qfrc_bias, acceleration]
        )
    )
save("dynamics.f32", rows)
