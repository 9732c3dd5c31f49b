"""Steps a second of a batch with random actions, as `footwork bench --filter environment` measures them in Rust.

python throughput.py [--task plane] [--envs 1024] [--seconds 5]
"""

import argparse
import time

import numpy as np

import footwork


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--task", default="plane", choices=footwork.TASKS)
    parser.add_argument("--envs", type=int, default=1024)
    parser.add_argument("--seconds", type=float, default=5.0)
    args = parser.parse_args()

    settings = {"curriculum": False} if args.task == "obstacles" else {}
    envs = footwork.make_vec(args.task, args.envs, seed=1, task=settings)
    # Of standard deviation 1 to the environments, and drawn beforehand, as there.
    random = np.random.default_rng(1)
    shape = (16, *envs.action_space.shape)
    actions = random.normal(scale=1 / envs.batch.action_scale, size=shape).astype(np.float32)
    envs.reset()

    def rate(seconds: float) -> float:
        start, steps = time.perf_counter(), 0
        while (elapsed := time.perf_counter() - start) < seconds:
            envs.step(actions[steps % len(actions)])
            steps += 1
        return steps * envs.num_envs / elapsed

    rate(0.2)
    rounds = [rate(args.seconds / 5) for _ in range(5)]
    print(f"{args.task}, {args.envs} environments: {np.median(rounds):,.0f} steps/s (of five rounds the median)")


if __name__ == "__main__":
    main()
