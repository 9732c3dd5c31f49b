"""The plane task and footwork's preset `fast` for it in numbers, and how a training is timed."""

import argparse
from time import perf_counter

import results
from database import POSE

# The task: `src/world/task.rs`, `src/kernels/layout.rs`. Metres and steps.
OBSERVATION, ACTION = POSE + 2, 12
HALF_SIDE, REACH, BONUS, MAX_STEPS = 5.0, 0.5, 1000.0, 200
# The target in an observation is metres times this.
GOAL_SCALE = 0.2

# Learning: `fast()` in `src/train/config.rs`.
ENVS, HORIZON, EPOCHS, MINIBATCH = 256, 16, 3, 512
RATE, EPSILON, GAMMA, LAMBDA, CLIP, MAX_GRADIENT = 2e-3, 1e-5, 0.95, 0.95, 0.2, 1.0
# footwork takes half of the halved square of the critic's error.
VALUE_COEFFICIENT = 0.25
HIDDEN, LOG_STD = (32, 32), 0.0

# Updates between two looks at the success: as footwork, after every 20,000 steps.
UPDATES = 5
LOOK = UPDATES * ENVS * HORIZON
EPISODES, SUCCESS = 1000, 0.95
# With less success in training there is no need to look.
NEAR = 0.5


def options(doc):
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("database")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--steps", type=int, default=1_000_000, help="of the whole training")
    parser.add_argument("--max-time", type=float, default=600, help="seconds of training")
    results.add_option(parser)
    return parser


def race(learn, judge, whole, max_time):
    """Trains for `whole` steps, and on until the evaluation episodes succeed. Returns the steps a second of
    all of it and the seconds until they succeeded, or None.

    `learn` takes `LOOK` steps and returns the success in training, `judge` that of the evaluation
    episodes. Only learning is timed; footwork counts its evaluations and checkpoints too.
    """
    steps, seconds, reached = 0, 0.0, None
    while (reached is None or steps < whole) and seconds < max_time:
        begin = perf_counter()
        trained = learn()
        seconds += perf_counter() - begin
        steps += LOOK
        print(f"{steps:,} steps, {seconds:.1f} s: {trained:.1%} in training", flush=True)
        if reached is None and trained >= NEAR:
            success = judge()
            print(f"{success:.1%} of {EPISODES} episodes", flush=True)
            reached = seconds if success >= SUCCESS else None
    return steps / seconds, reached


def report(args, who, speed, reached):
    results.report(args.json, f"plane, {args.steps:,} steps", who, "steps/s", speed)
    results.report(args.json, f"plane, to {SUCCESS:.0%}", who, "s", reached)
