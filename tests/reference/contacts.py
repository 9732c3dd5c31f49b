"""Golden file of 1,000 states of the humanoid with contacts and limits: `contacts.f32`.

A row: q, v, targets; number of contacts and of limits, acceleration, net contact force per body.
"""

import mujoco
import numpy as np

from humanoid import Humanoid, random_positions, save, single

rng = np.random.default_rng(7)
body = Humanoid()
model, data = body.model, body.data


def net_forces():
    """Contact force on every body, in the world's frame."""
    net, force = np.zeros((model.nbody, 3)), np.zeros(6)
    for i in range(data.ncon):
        contact = data.contact[i]
        mujoco.mj_contactForce(model, data, i, force)
        world = contact.frame.reshape(3, 3).T @ force[:3]
        net[model.geom_bodyid[contact.geom[0]]] -= world
        net[model.geom_bodyid[contact.geom[1]]] += world
    return net[1:]


rows = []
while len(rows) < 1000:
    data.qpos[:] = random_positions(model, rng, (0, 1), beyond=0.05)
    mujoco.mj_kinematics(model, data)
    # Set down so that the lowest body lies a little in the ground.
    mujoco.mj_collision(model, data)
    low = min((data.contact[i].dist for i in range(data.ncon)), default=0)
    data.qpos[2] += -low - rng.uniform(0, 0.03) if low < 0 else 0
    data.qpos[:] = single(data.qpos)
    data.qvel[:] = single(rng.normal(size=model.nv))
    targets = single(rng.uniform(-1, 1, len(body.driven)))
    body.drive(targets)
    mujoco.mj_forward(model, data)
    if data.ncon == 0:
        continue
    limits = int((data.efc_type == mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT).sum())
    rows.append(
        np.concatenate(
            [data.qpos, data.qvel, targets, [data.ncon, limits], data.qacc, net_forces().ravel()]
        )
    )
save("contacts.f32", rows)
