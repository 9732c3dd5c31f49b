"""Throughput of MuJoCo's C engine on the humanoid, beside `footwork sim` on the CPU and on lavapipe.

physics.py FOOTWORK [--worlds N] [--seconds S] [--threads T]

Both play random targets for the drives, normal with 0.5 rad deviation, drawn anew 30 times a second, at
120 steps a second, from standing. MuJoCo rolls out natively on its own threads, with its implicit
integrator (explicit drives of this stiffness explode at this step) and its default solver; all take turns,
three times each, and the medians are compared.
"""

import argparse
import json
import os
import statistics
import subprocess
import time
from pathlib import Path

import mujoco
import mujoco.rollout
import numpy as np

MODEL = Path(__file__).parents[2] / "src" / "body" / "humanoid.xml"
SUBSTEPS = 4


def mujoco_per_s(model, worlds, seconds, threads, rng):
    steps = int(30 * seconds)
    ctrl = rng.normal(size=(worlds, steps, model.nu)) * 0.5
    ctrl = np.repeat(ctrl, SUBSTEPS, axis=1)
    data = [mujoco.MjData(model) for _ in range(threads)]
    mujoco.mj_resetData(model, data[0])
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    state = np.zeros(size)
    mujoco.mj_getState(model, data[0], state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    begun = time.perf_counter()
    with mujoco.rollout.Rollout(nthread=threads) as rollout:
        rollout.rollout(model, data, np.tile(state, (worlds, 1)), ctrl)
    return worlds * steps / (time.perf_counter() - begun)


def footwork_per_s(binary, device, worlds, seconds, threads):
    command = [binary, "sim", "--device", device, "--json"]
    command += ["--worlds", str(worlds), "--seconds", str(seconds)]
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads), "LP_NUM_THREADS": str(threads)}
    output = subprocess.run(command, env=environment, check=True, capture_output=True).stdout
    return json.loads(output)["control_steps_per_s"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("footwork")
    parser.add_argument("--worlds", type=int, default=256)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    model.opt.timestep = 1 / 120
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    rng = np.random.default_rng(1)
    size = arguments.worlds, arguments.seconds, arguments.threads
    rates = {"MuJoCo": [], "cpu": [], "lavapipe": []}
    for _ in range(3):
        rates["MuJoCo"].append(mujoco_per_s(model, *size, rng))
        for device in ["cpu", "lavapipe"]:
            rates[device].append(footwork_per_s(arguments.footwork, device, *size))
        print(", ".join(f"{who} {rate[-1]:.0f}" for who, rate in rates.items()), "control steps/s")
    medians = {who: statistics.median(rate) for who, rate in rates.items()}
    for who, median in medians.items():
        print(f"{who}: {median:.0f} control steps/s, {median / medians['MuJoCo']:.2f} times MuJoCo's")


if __name__ == "__main__":
    main()
