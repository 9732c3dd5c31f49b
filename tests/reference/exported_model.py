"""Has MuJoCo read exported models: `exported_model.py FILE.xml ...`.

A humanoid alone must be what it was exported from, `src/physics/humanoid.xml`, number for number. Others, of which there
is no such file, must hold as many bodies and actuators as theirs, and stand or lie on the ground after a second.
"""

import sys

import mujoco
import numpy as np

from model import OURS, Facts

CLOSE = 2e-6


def compare(told, found, wanted):
    assert type(found) is type(wanted), f"{told}: {found} instead of {wanted}"
    if isinstance(wanted, dict):
        for key in wanted:
            compare(f"{told}, {key}", found[key], wanted[key])
    elif isinstance(wanted, list) and not all(isinstance(value, float) for value in wanted):
        assert len(found) == len(wanted), f"{told}: {len(found)} instead of {len(wanted)}"
        for index, (one, other) in enumerate(zip(found, wanted)):
            compare(f"{told} {index}", one, other)
    elif isinstance(wanted, (list, float)):
        away = np.abs(np.subtract(found, wanted)).max(initial=0)
        assert away <= CLOSE * np.abs(wanted).max(initial=1e-3), f"{told}: {found} instead of {wanted}"
    else:
        assert found == wanted, f"{told}: {found} instead of {wanted}"


def settle(path, model, humanoid):
    humanoids = model.nu // humanoid.nu
    others = model.nbody - 1 - humanoids * (humanoid.nbody - 1)
    assert humanoids and model.nu == humanoids * humanoid.nu and others in (0, 1), path
    data = mujoco.MjData(model)
    while data.time < 1:
        mujoco.mj_step(model, data)
    height = data.xpos[1:, 2]
    assert np.isfinite(data.qpos).all() and height.min() > -0.05 and height.max() < 2, path


def main(paths):
    humanoid = mujoco.MjModel.from_xml_path(str(OURS))
    for path in paths:
        model = mujoco.MjModel.from_xml_path(path)
        assert model.opt.timestep * model.numeric("substeps").data[0] == 1 / 30, path
        if (model.nbody, model.nu) == (humanoid.nbody, humanoid.nu):
            compare(path, Facts(model).all(), Facts(humanoid).all())
        else:
            settle(path, model, humanoid)


if __name__ == "__main__":
    main(sys.argv[1:])
