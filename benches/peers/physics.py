"""Throughput of MuJoCo's C engine on the humanoid, beside `footwork sim` on the CPU and on lavapipe.

physics.py FOOTWORK [--envs N] [--seconds S] [--threads T]

Both play random targets for the drives, normal with a standard deviation of 0.5 rad, drawn anew 30 times a second, at
120 steps a second, from standing. MuJoCo steps a batch (`mujoco.batch`) on its own threads, with its implicit
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
import numpy as np
from mujoco.batch import Batch

MODEL = Path(__file__).parents[2] / "src" / "physics" / "humanoid.xml"
SUBSTEPS = 4


def mujoco_per_s(model, envs, seconds, threads, rng):
    targets = rng.normal(size=(int(30 * seconds), envs, model.nu)) * 0.5
    batch = Batch(model, nsim=envs, nthread=threads)
    ctrl = batch.bind("ctrl")
    begin = time.perf_counter()
    for of_step in targets:
        ctrl[:] = of_step
        batch.step(nstep=SUBSTEPS)
    return envs * len(targets) / (time.perf_counter() - begin)


def footwork_per_s(binary, device, envs, seconds, threads):
    command = [binary, "sim", "--device", device, "--json"]
    command += ["--envs", str(envs), "--seconds", str(seconds)]
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads), "LP_NUM_THREADS": str(threads)}
    output = subprocess.run(command, env=environment, check=True, capture_output=True).stdout
    return json.loads(output)["control_steps_per_s"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("footwork")
    parser.add_argument("--envs", type=int, default=256)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    model.opt.timestep = 1 / 120
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    rng = np.random.default_rng(1)
    size = arguments.envs, arguments.seconds, arguments.threads
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
