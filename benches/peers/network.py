"""The paper's obstacle network on the CPU, in GFLOP/s.

Its numbers are `paper_obstacles()` in `src/train/config.rs`, its form `src/ppo/network.rs`.

python network.py
"""

import argparse
from itertools import pairwise
from math import prod
from time import perf_counter

import jax
import jax.numpy as jnp
import numpy as np
import torch
from torch import nn

import results

CELLS, MAPS, GOAL, ACTION = 16, 2, 17, 12
# Filters and size; stride 1, no padding.
CONVOLUTIONS = [(16, 4), (32, 3)]
SIGHT, HIDDEN = 128, (256, 128)
BATCHES = [256, 1024]
SECONDS = 3


def layers():
    """Shapes of the weights, and at how many places of a sample each is applied.

    [height][width][inputs][outputs] or [inputs][outputs].
    """
    side, inputs, found = CELLS, MAPS, []
    for filters, size in CONVOLUTIONS:
        side -= size - 1
        found.append(((size, size, inputs, filters), side * side))
        inputs = filters
    widths = [side * side * inputs, SIGHT]
    joined = [SIGHT + GOAL, *HIDDEN, ACTION]
    dense = [*pairwise(widths), *pairwise(joined)]
    return found + [(shape, 1) for shape in dense]


def operations():
    """Of a sample forward: two for each weight at each place."""
    return sum(2 * places * prod(shape) for shape, places in layers())


# JAX.


def jax_answer(parameters, maps, goal):
    x = maps
    convolutions = len(CONVOLUTIONS)
    for weights, biases in parameters[:convolutions]:
        x = jax.lax.conv_general_dilated(
            x, weights, (1, 1), "VALID", dimension_numbers=("NHWC", "HWIO", "NHWC")
        )
        x = jax.nn.relu(x + biases)
    sight, *hidden, last = parameters[convolutions:]
    x = jax.nn.relu(x.reshape(len(x), -1) @ sight[0] + sight[1])
    x = jnp.concatenate([goal, x], axis=1)
    for weights, biases in hidden:
        x = jax.nn.relu(x @ weights + biases)
    return x @ last[0] + last[1]


def jax_passes(maps, goal):
    keys = jax.random.split(jax.random.key(0), len(layers()))
    parameters = [
        (jax.random.normal(key, shape) / prod(shape[:-1]) ** 0.5, jnp.zeros(shape[-1]))
        for key, (shape, _) in zip(keys, layers())
    ]
    maps, goal = jnp.asarray(maps), jnp.asarray(goal)
    forward = jax.jit(jax_answer)
    backward = jax.jit(jax.grad(lambda *inputs: jnp.mean(jax_answer(*inputs) ** 2)))
    return {
        "forward": lambda: jax.block_until_ready(forward(parameters, maps, goal)),
        "training": lambda: jax.block_until_ready(backward(parameters, maps, goal)),
    }


# PyTorch.


class Network(nn.Module):
    def __init__(self):
        super().__init__()
        shapes = [shape for shape, _ in layers()]
        filters, dense = shapes[: len(CONVOLUTIONS)], shapes[len(CONVOLUTIONS) :]
        self.convolutions = nn.ModuleList(
            nn.Conv2d(inputs, outputs, size) for size, _, inputs, outputs in filters
        )
        dense = [nn.Linear(*shape) for shape in dense]
        self.sight, *hidden, self.last = dense
        self.hidden = nn.ModuleList(hidden)

    def forward(self, maps, goal):
        x = maps
        for layer in self.convolutions:
            x = layer(x).relu()
        x = torch.cat([goal, self.sight(x.flatten(1)).relu()], 1)
        for layer in self.hidden:
            x = layer(x).relu()
        return self.last(x)


def torch_passes(maps, goal):
    torch.manual_seed(0)
    network = Network()
    maps = torch.from_numpy(maps).permute(0, 3, 1, 2).contiguous()
    goal = torch.from_numpy(goal)

    def training():
        network.zero_grad()
        network(maps, goal).square().mean().backward()

    return {"forward": torch.no_grad()(lambda: network(maps, goal)), "training": training}


def best(run):
    """Seconds of the quickest run, after one to warm up."""
    run()
    seconds, end = [], perf_counter() + SECONDS
    while perf_counter() < end:
        begin = perf_counter()
        run()
        seconds.append(perf_counter() - begin)
    return min(seconds)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    results.add_option(parser)
    args = parser.parse_args()
    random = np.random.default_rng(0)
    for batch in BATCHES:
        maps = (random.random((batch, CELLS, CELLS, MAPS)) < 0.5).astype(np.float32)
        goal = random.standard_normal((batch, GOAL), dtype=np.float32)
        for who, passes in {"JAX": jax_passes, "PyTorch": torch_passes}.items():
            for name, run in passes(maps, goal).items():
                # Backward a layer takes as many again for its weights and for its input.
                work = batch * operations() * (3 if name == "training" else 1)
                what = f"network, {name}, batch {batch}"
                results.report(args.json, what, who, "GFLOP/s", work / best(run) / 1e9)


if __name__ == "__main__":
    main()
