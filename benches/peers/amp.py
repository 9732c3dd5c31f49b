"""AMP in MuJoCo and JAX, beside `footwork train imitate`: a humanoid learns to move like one recording.

python amp.py CLIP [FOOTWORK]

CLIP is a recording of DeepMimic's. Sizes, rates and losses are those of footwork's preset
(`src/train/tasks/imitate.rs`, `src/rl/amp`): the style reward alone, PPO with separate networks, a
discriminator of two moments a step apart. With FOOTWORK, the program, it trains for as many samples too.
"""

import argparse
import json
import os
import subprocess
import tempfile
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax

import results
from imitation import RATE, STEPS, Body, Environments, read_clip

# PPO: `ppo()` in `src/train/tasks/imitate.rs`.
ENVS, ROLLOUT, EPOCHS, MINIBATCH = 512, 16, 4, 2048
HIDDEN, LOG_STD = (256, 128), -2.9
GAMMA, LAMBDA, CLIP, MAX_GRADIENT, EPSILON = 0.97, 0.95, 0.2, 1.0, 1e-5
ACTOR_RATE, CRITIC_RATE = 5e-5, 1e-3
DESIRED_KL, RATE_FACTOR, MIN_RATE, MAX_RATE = 0.02, 1.5, 2e-5, 3e-3
# footwork takes half of the halved square of the critic's error.
VALUE_COEFFICIENT = 0.25
# Share of the newest rollout in the critic's running statistics.
NEWEST = 0.1

# The discriminator: `src/rl/amp`.
DISCRIMINATOR_STEPS, WINDOWS, DISCRIMINATOR_RATE = 8, 1024, 2e-4
GRADIENT_PENALTY, LOGIT_DECAY, LEAST = 5.0, 0.01, 1e-4
REPLAY, REPLAYED_PER_UPDATE = 20_480, 2048

# Of normalised numbers: `src/nn/running_mean_std.rs`.
LARGEST, LEAST_STD = 10.0, 1e-2

EPISODES = 256
STD = float(np.exp(LOG_STD))
SAMPLES = ENVS * ROLLOUT


class Moments(NamedTuple):
    """Mean and variance of all rows so far."""

    mean: jax.Array
    variance: jax.Array
    count: jax.Array


class Discriminator(NamedTuple):
    layers: list
    optimiser: tuple
    moments: Moments
    # A ring of windows of agents, and how many have been put in.
    replay: jax.Array
    seen: jax.Array


class Learner(NamedTuple):
    parameters: dict
    optimiser: tuple
    # Learning rate of the actor.
    rate: jax.Array
    observations: Moments
    # Running mean and mean square of the critic's targets.
    returns: jax.Array
    updates: jax.Array
    discriminator: Discriminator


class Rollout(NamedTuple):
    """`[step][environment]`; `after` is what was observed after a step, before a new episode began."""

    observation: jax.Array
    mean: jax.Array
    action: jax.Array
    after: jax.Array
    fallen: jax.Array
    ended: jax.Array


class Sample(NamedTuple):
    observation: jax.Array
    mean: jax.Array
    action: jax.Array
    advantage: jax.Array
    target: jax.Array


# Running statistics.


def no_moments(width):
    return Moments(jnp.zeros(width), jnp.ones(width), jnp.zeros(()))


def normalise(moments, rows):
    std = jnp.maximum(jnp.sqrt(moments.variance), LEAST_STD)
    return jnp.clip((rows - moments.mean) / std, -LARGEST, LARGEST)


def take_in(moments, rows):
    count = moments.count + len(rows)
    weight = len(rows) / count
    shift = rows.mean(0) - moments.mean
    variance = (1 - weight) * moments.variance + weight * rows.var(0)
    return Moments(
        moments.mean + weight * shift, variance + weight * (1 - weight) * shift**2, count
    )


# The networks.


def network(key, inputs, outputs, last_gain=0.01):
    """Weights that keep the variance through ReLUs; zero biases."""
    widths = [inputs, *HIDDEN, outputs]
    gains = [2**0.5] * len(HIDDEN) + [last_gain]
    return [
        (gain / np.sqrt(a) * jax.random.normal(key, (a, b)), jnp.zeros(b))
        for key, a, b, gain in zip(jax.random.split(key, len(gains)), widths, widths[1:], gains)
    ]


def output(layers, x):
    *hidden, (weights, biases) = layers
    for w, b in hidden:
        x = jax.nn.relu(x @ w + b)
    return x @ weights + biases


def value(parameters, observation):
    """In units of the critic's running statistics."""
    return output(parameters["critic"], observation)[..., 0]


def logit(layers, windows):
    return output(layers, windows)[..., 0]


ADAM = optax.chain(optax.clip_by_global_norm(MAX_GRADIENT), optax.scale_by_adam(eps=EPSILON))


def novice(seed, rest_action, width):
    """A learner whose first actions are near an action of rest."""
    actor, critic, discriminator = jax.random.split(jax.random.key(seed), 3)
    *hidden, (weights, _) = network(actor, width, len(rest_action))
    parameters = {
        "actor": [*hidden, (weights, jnp.asarray(rest_action, jnp.float32))],
        "critic": network(critic, width, 1),
    }
    layers = network(discriminator, 2 * width, 1, last_gain=1)
    return Learner(
        parameters=parameters,
        optimiser=ADAM.init(parameters),
        rate=jnp.array(ACTOR_RATE),
        observations=no_moments(width),
        returns=jnp.array([0.0, 1.0]),
        updates=jnp.array(0),
        discriminator=Discriminator(
            layers=layers,
            optimiser=ADAM.init(layers),
            moments=no_moments(2 * width),
            replay=jnp.zeros((REPLAY, 2 * width)),
            seen=jnp.array(0),
        ),
    )


# Acting.


@jax.jit
def mean_action(actor, moments, observation):
    return output(actor, normalise(moments, observation))


@jax.jit
def act(actor, moments, observation, key):
    mean = output(actor, normalise(moments, observation))
    return mean, mean + STD * jax.random.normal(key, mean.shape)


def targets(body, action):
    return body.offset + body.scale * np.clip(action, -1, 1)


def rollout(envs, learner, key):
    actor, moments = learner.parameters["actor"], learner.observations
    steps = []
    for key in jax.random.split(key, ROLLOUT):
        observation = envs.observation
        mean, action = act(actor, moments, observation, key)
        steps.append((observation, mean, action, *envs.step(targets(envs.body, action))))
    return Rollout(*zip(*steps))


# PPO.


def advantages(reward, fallen, ended, now, after):
    """Generalised."""

    def back(sum, step):
        reward, fallen, ended, now, after = step
        after = jnp.where(fallen, 0.0, after)
        sum = jnp.where(ended, 0.0, sum)
        sum = reward + GAMMA * after - now + GAMMA * LAMBDA * sum
        return sum, sum

    steps = (reward, fallen, ended, now, after)
    return jax.lax.scan(back, jnp.zeros(ENVS), steps, reverse=True)[1]


def deviation(moments):
    return jnp.sqrt(jnp.maximum(moments[1] - moments[0] ** 2, 1e-6))


def squared_noise(action, mean):
    return jnp.sum(((action - mean) / STD) ** 2, axis=-1)


def loss(parameters, sample):
    """Also the KL divergence of the new policy from the old."""
    mean = output(parameters["actor"], sample.observation)
    change = squared_noise(sample.action, sample.mean) - squared_noise(sample.action, mean)
    ratio = jnp.exp(0.5 * change)
    clipped = jnp.clip(ratio, 1 - CLIP, 1 + CLIP)
    surrogate = jnp.minimum(ratio * sample.advantage, clipped * sample.advantage)
    error = value(parameters, sample.observation) - sample.target
    kl = 0.5 * jnp.mean(squared_noise(sample.mean, mean))
    return VALUE_COEFFICIENT * jnp.mean(error**2) - jnp.mean(surrogate), kl


def adapted(rate, kl):
    lower, higher = (rate / RATE_FACTOR, rate * RATE_FACTOR)
    rate = jnp.where(kl > 2 * DESIRED_KL, lower, jnp.where(kl < 0.5 * DESIRED_KL, higher, rate))
    return jnp.clip(rate, MIN_RATE, MAX_RATE)


def descend(state, sample):
    parameters, optimiser, rate = state
    gradient, kl = jax.grad(loss, has_aux=True)(parameters, sample)
    rate = adapted(rate, kl)
    change, optimiser = ADAM.update(gradient, optimiser)
    rates = {"actor": rate, "critic": CRITIC_RATE}
    change = {
        name: jax.tree.map(lambda number: -rates[name] * number, own)
        for name, own in change.items()
    }
    return (optax.apply_updates(parameters, change), optimiser, rate), kl


def epoch(state, key, samples):
    order = jax.random.permutation(key, SAMPLES).reshape(-1, MINIBATCH)
    return jax.lax.scan(
        lambda state, rows: descend(state, jax.tree.map(lambda column: column[rows], samples)),
        state,
        order,
    )


def learn(learner, played, reward, key):
    """Actor and critic after all epochs, and the mean KL divergence of the last one's minibatches."""
    parameters, moments = learner.parameters, learner.observations
    observation = normalise(moments, played.observation)

    def real(observation):
        return value(parameters, observation) * deviation(learner.returns) + learner.returns[0]

    now, after = real(observation), real(normalise(moments, played.after))
    advantage = advantages(reward, played.fallen, played.ended, now, after)
    target = advantage + now
    updates = learner.updates + 1
    share = jnp.maximum(NEWEST, 1 / updates)
    newest = jnp.array([jnp.mean(target), jnp.mean(target**2)])
    returns = (1 - share) * learner.returns + share * newest
    samples = Sample(
        observation=observation,
        mean=played.mean,
        action=played.action,
        advantage=(advantage - jnp.mean(advantage)) / (jnp.std(advantage) + 1e-6),
        target=(target - returns[0]) / deviation(returns),
    )
    samples = jax.tree.map(side_by_side, samples)
    (parameters, optimiser, rate), kl = jax.lax.scan(
        lambda state, key: epoch(state, key, samples),
        (parameters, learner.optimiser, learner.rate),
        jax.random.split(key, EPOCHS),
    )
    learner = learner._replace(
        parameters=parameters,
        optimiser=optimiser,
        rate=rate,
        observations=take_in(moments, side_by_side(played.observation)),
        returns=returns,
        updates=updates,
    )
    return learner, jnp.mean(kl[-1])


def side_by_side(column):
    """Steps and environments as one axis."""
    return column.reshape(SAMPLES, *column.shape[2:])


# The discriminator.


def style_reward(discriminator, windows):
    """-log of the probability of having been taken for an agent."""
    out = logit(discriminator.layers, normalise(discriminator.moments, windows))
    return -jnp.log(jnp.maximum(1 - jax.nn.sigmoid(out), LEAST))


def tell_apart(layers, recorded, agents):
    """Binary cross-entropy, with a penalty on the slope at recorded windows and a decay of the last layer. Also the
    share of agents' windows that are known as such."""
    real, slopes = jax.vjp(lambda windows: logit(layers, windows), recorded)
    fake = logit(layers, agents)
    entropy = jnp.mean(jax.nn.softplus(-real)) + jnp.mean(jax.nn.softplus(fake))
    (slope,) = slopes(jnp.ones_like(real))
    penalty = jnp.mean(jnp.sum(slope**2, axis=-1))
    decay = jnp.sum(layers[-1][0] ** 2)
    total = 0.5 * entropy + GRADIENT_PENALTY * penalty + 0.5 * LOGIT_DECAY * decay
    return total, jnp.mean(fake < 0)


def drawn(key, rows, count, below=None):
    return rows[jax.random.randint(key, (count,), 0, len(rows) if below is None else below)]


def keep(discriminator, fresh, key):
    """Puts windows into the replay, in place of the oldest."""
    kept = drawn(key, fresh, REPLAYED_PER_UPDATE)
    at = discriminator.seen % REPLAY
    replay = jax.lax.dynamic_update_slice(discriminator.replay, kept, (at, 0))
    return discriminator._replace(replay=replay, seen=discriminator.seen + len(kept))


def normalise_by(discriminator, recorded, fresh, key):
    """Lets windows of both sides into the running statistics."""
    moments = discriminator.moments
    for key, rows in zip(jax.random.split(key), [recorded, fresh]):
        moments = take_in(moments, drawn(key, rows, REPLAYED_PER_UPDATE))
    return discriminator._replace(moments=moments)


def remember(discriminator, recorded, fresh, key):
    """Takes windows into the running statistics and the replay."""
    keys = jax.random.split(key)
    return keep(normalise_by(discriminator, recorded, fresh, keys[0]), fresh, keys[1])


def learn_to_tell(discriminator, recorded, fresh, key):
    """The discriminator after its gradient steps, and the share of agents' windows that it knew as such."""
    # The first gradient step needs statistics and a replay; later ones judge before they remember.
    first = discriminator.seen == 0
    key, remembering = jax.random.split(key)

    def remember_if(when, discriminator):
        return jax.lax.cond(
            when, lambda own: remember(own, recorded, fresh, remembering), lambda own: own, discriminator
        )

    discriminator = remember_if(first, discriminator)
    replayed = jnp.minimum(discriminator.seen, REPLAY)

    def step(state, key):
        layers, optimiser = state
        keys = jax.random.split(key, 3)
        agents = [
            drawn(keys[1], fresh, WINDOWS // 2),
            drawn(keys[2], discriminator.replay, WINDOWS // 2, replayed),
        ]
        sides = drawn(keys[0], recorded, WINDOWS), jnp.concatenate(agents)
        sides = [normalise(discriminator.moments, rows) for rows in sides]
        gradient, known = jax.grad(tell_apart, has_aux=True)(layers, *sides)
        change, optimiser = ADAM.update(gradient, optimiser)
        change = jax.tree.map(lambda number: -DISCRIMINATOR_RATE * number, change)
        return (optax.apply_updates(layers, change), optimiser), known

    state = discriminator.layers, discriminator.optimiser
    (layers, optimiser), known = jax.lax.scan(step, state, jax.random.split(key, DISCRIMINATOR_STEPS))
    discriminator = discriminator._replace(layers=layers, optimiser=optimiser)
    return remember_if(~first, discriminator), jnp.mean(known)


# Training.


@partial(jax.jit, donate_argnums=0)
def update(learner, played, recorded, key):
    """What is learned from a rollout, and figures of it."""
    learning, telling = jax.random.split(key)
    played = Rollout(*map(jnp.stack, played))
    windows = side_by_side(jnp.concatenate([played.observation, played.after], axis=-1))
    reward = style_reward(learner.discriminator, windows)
    learner, kl = learn(learner, played, reward.reshape(ROLLOUT, ENVS), learning)
    discriminator, known = learn_to_tell(learner.discriminator, recorded, windows, telling)
    figures = {
        "style reward": jnp.mean(reward),
        "KL": kl,
        "rate": learner.rate,
        "agents known": known,
        "falls": jnp.sum(played.fallen),
        "ends": jnp.sum(played.ended),
    }
    return learner._replace(discriminator=discriminator), figures


def evaluate(learner, body, clip, threads):
    """Survival of the mean action over a whole episode, and its speed as a share of the recording's."""
    envs = Environments(body, clip, EPISODES, threads, seed=0, staggered=False)
    actor, moments = learner.parameters["actor"], learner.observations
    running, way, steps = np.full(EPISODES, True), 0.0, 0
    for _ in range(STEPS):
        before = envs.q[:, :2].copy()
        action = mean_action(actor, moments, envs.observation)
        _, fallen, ended = envs.step(targets(body, action))
        running &= ~np.asarray(fallen)
        # Those that have ended are at a start again.
        on = running & ~np.asarray(ended)
        way += np.hypot(*(envs.q[:, :2] - before)[on].T).sum()
        steps += on.sum()
    return running.mean(), way * RATE / max(steps, 1) / clip.speed()


class Peer:
    """A training in MuJoCo and JAX."""

    def __init__(self, args):
        self.args, self.body = args, Body()
        self.clip = read_clip(args.clip, self.body)
        self.envs = Environments(self.body, self.clip, ENVS, args.threads, args.seed)
        moments, _ = jax.jit(self.body.observe)(self.clip.q, self.clip.v)
        self.recorded = jnp.concatenate([moments[:-1], moments[1:]], axis=-1)
        rest = self.body.rest_action(self.clip.q).mean(0)
        self.learner = novice(args.seed, rest, moments.shape[1])
        self.key = jax.random.key(args.seed)

    def update(self):
        self.key, playing, learning = jax.random.split(self.key, 3)
        played = rollout(self.envs, self.learner, playing)
        acted = perf_counter()
        self.learner, figures = update(self.learner, played, self.recorded, learning)
        return {name: float(figure) for name, figure in figures.items()}, acted

    def train(self):
        """Trains. Returns the samples a second of all updates but the first, which compiles."""
        seconds = playing = updates = 0
        while updates * SAMPLES < self.args.steps:
            begin = perf_counter()
            figures, acted = self.update()
            if updates:
                seconds += perf_counter() - begin
                playing += acted - begin
            updates += 1
            self.look(updates, seconds, playing, figures)
        return (updates - 1) * SAMPLES / seconds

    def look(self, updates, seconds, playing, figures):
        """Reports progress now and then, and evaluates the policy as often as was asked for."""
        samples = updates * SAMPLES
        if updates % 16 == 0:
            shown = ", ".join(f"{name} {figure:.3g}" for name, figure in figures.items())
            print(f"{samples:,} samples, {seconds:.0f} s, {playing:.0f} s of it playing: {shown}", flush=True)
        every = self.args.evaluate_every
        if every and samples // every != (samples - SAMPLES) // every:
            self.evaluate()

    def evaluate(self):
        survival, speed = evaluate(self.learner, self.body, self.clip, self.args.threads)
        lasting = f"{survival:.1%} of {EPISODES} episodes last {STEPS // RATE} s"
        print(f"{lasting}, at {speed:.2f} of the recording's speed", flush=True)
        return survival


def footwork(args):
    """Samples a second of all updates but the first, and survival, of footwork's own training."""
    environment = {**os.environ, "RAYON_NUM_THREADS": str(args.threads)}
    with tempfile.TemporaryDirectory() as folder:
        command = [args.footwork, "train", "imitate", "--device", "cpu", "--data", args.clip]
        command += ["--steps", f"{args.steps}", "--seed", f"{args.seed}", "--out", folder]
        subprocess.run(command, env=environment, check=True)
        rows = [json.loads(line) for line in Path(folder, "metrics.jsonl").read_text().splitlines()]
        summary = json.loads(Path(folder, "summary.json").read_text())
    first, last = rows[0], rows[-1]
    speed = (last["steps"] - first["steps"]) / (last["wall_s"] - first["wall_s"])
    return speed, summary["survival"]


def options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("clip", help="a recording of DeepMimic's")
    parser.add_argument("footwork", nargs="?", help="the program; without it, it is left out")
    parser.add_argument("--steps", type=int, default=2_500_000, help="samples of a training")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="of the physics")
    parser.add_argument("--evaluate-every", type=int, default=0, help="so many samples as well as at the end")
    results.add_option(parser)
    return parser


def main():
    args = options().parse_args()
    peer = Peer(args)
    measured = {"MuJoCo and JAX": (peer.train(), peer.evaluate())}
    if args.footwork:
        measured[results.OURS] = footwork(args)
    for who, (speed, survival) in measured.items():
        what = f"imitate, {args.steps:,} samples"
        results.report(args.json, what, who, "samples/s", speed)
        results.report(args.json, f"{what}, survival", who, "%", 100 * survival)
    if args.footwork:
        ours, theirs = measured[results.OURS][0], measured["MuJoCo and JAX"][0]
        print(f"footwork: {ours / theirs:.2f} times the samples/s of MuJoCo and JAX")


if __name__ == "__main__":
    main()
