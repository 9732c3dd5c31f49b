"""Golden file of 1,000 rollouts from standing under random targets: `rollouts.f32`.

A row: seconds until the head is lower than 0.8 m, mean and largest vertical contact force on the
feet and on the whole body over 2 seconds, N. Targets are drawn anew for every control step, normal
with deviation 0.3 rad.
"""

from multiprocessing import Pool

import mujoco
import numpy as np

from humanoid import Humanoid, save

SECONDS, SUBSTEPS = 2, 4
FALLEN = 0.8


def rollout(seed):
    rng = np.random.default_rng(seed)
    body = Humanoid()
    model, data = body.model, body.data
    # As exact as training needs, and quicker.
    model.opt.iterations, model.opt.tolerance = 100, 1e-10
    head, feet = model.body("head").id, [model.body(f"{s}_foot").id for s in ("left", "right")]
    on_feet, on_all, fallen = [], [], SECONDS
    for control in range(30 * SECONDS):
        targets = rng.normal(size=len(body.driven)) * 0.3
        for sub in range(SUBSTEPS):
            body.step(targets)
            up = vertical(model, data)
            on_feet.append(up[feet].sum())
            on_all.append(up.sum())
            if fallen == SECONDS and data.xpos[head, 2] < FALLEN:
                fallen = (SUBSTEPS * control + sub + 1) * model.opt.timestep
    return fallen, np.mean(on_feet), np.max(on_feet), np.mean(on_all), np.max(on_all)


def vertical(model, data):
    """Upward force of the ground on every body."""
    up, force = np.zeros(model.nbody), np.zeros(6)
    for i in range(data.ncon):
        contact = data.contact[i]
        first, second = model.geom_bodyid[contact.geom]
        if first == 0:
            mujoco.mj_contactForce(model, data, i, force)
            up[second] += (contact.frame.reshape(3, 3).T @ force[:3])[2]
    return up


if __name__ == "__main__":
    with Pool() as pool:
        save("rollouts.f32", pool.map(rollout, range(1000), chunksize=10))
