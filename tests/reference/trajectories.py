"""Golden file of 30 contact-free flights of half a second: `trajectories.f32`.

A row: q, v, targets; q and v after 60 steps towards the same targets.
"""

import numpy as np

from humanoid import Humanoid, random_positions, save, single

rng = np.random.default_rng(8)
body = Humanoid(contacts=False)
model, data = body.model, body.data
rows = []
for _ in range(30):
    start = random_positions(model, rng, (0, 3)), single(rng.normal(size=model.nv))
    data.qpos[:], data.qvel[:] = start
    targets = single(rng.uniform(-1, 1, len(body.driven)))
    for _ in range(60):
        body.step(targets)
    rows.append(np.concatenate([*start, targets, data.qpos, data.qvel]))
save("trajectories.f32", rows)
