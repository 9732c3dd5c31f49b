"""PPO on the plane task in JAX, compiled whole: worlds, search and learning.

python jax_ppo.py DATABASE

In the manner of PureJaxRL; critic, advantages and weights at the start as in `src/ppo`.
"""

from time import perf_counter
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax

import plane
import results
from database import PLAYED, POSE, load

# Rows of a block of the search: its scores stay in the cache.
BLOCK = 1024
# Draws of a target; hardly ever are all of them too near.
DRAWS = 4
# Share of the newest rollout in the critic's running statistics.
NEWEST = 0.1
HALF_LOG_TAU = 0.5 * np.log(2 * np.pi)


class Motion(NamedTuple):
    """The database; ground vectors are complex as there."""

    poses: jax.Array
    candidates: jax.Array
    moved: jax.Array
    turned: jax.Array
    # The candidates' features, then minus half their squared length: [block][number][row].
    blocks: jax.Array


class Worlds(NamedTuple):
    """Side by side: `src/kernels/{reset,observe,query,step}.rs`."""

    frame: jax.Array
    place: jax.Array
    heading: jax.Array
    target: jax.Array
    age: jax.Array
    limit: jax.Array


class Learner(NamedTuple):
    parameters: dict
    optimiser: tuple
    # Running mean and mean square of the critic's targets.
    moments: jax.Array
    updates: jax.Array
    worlds: Worlds
    key: jax.Array


class Sample(NamedTuple):
    observation: jax.Array
    action: jax.Array
    log_prob: jax.Array
    advantage: jax.Array
    target: jax.Array


# The worlds.


def motion_of(database):
    rows = database.rows
    rows = np.column_stack([rows, -0.5 * np.sum(rows**2, axis=1)])
    rows = np.pad(rows, ((0, -len(rows) % BLOCK), (0, 0)))
    # What fills the last block is never the best.
    rows[len(database.candidates) :, -1] = -np.inf
    blocks = rows.reshape(-1, BLOCK, rows.shape[1]).transpose(0, 2, 1)
    poses = database.features[:, :POSE]
    arrays = (poses, database.candidates, database.moved, database.turned, blocks)
    return Motion(*map(jnp.asarray, arrays))


def nearest(motion, queries):
    """Places of the nearest candidates: those of the greatest q.f - |f|^2 / 2."""
    queries = jnp.pad(queries, ((0, 0), (0, 1)), constant_values=1)
    best = jax.lax.map(lambda block: jnp.max(queries @ block, axis=1), motion.blocks)
    block = jnp.argmax(best, axis=0)
    scores = jnp.einsum("qd,qdr->qr", queries, motion.blocks[block])
    return block * BLOCK + jnp.argmax(scores, axis=1)


def begin(motion, key, count, spread=1):
    """New episodes, their limits up to `spread` early."""
    frames, headings, targets, limits = jax.random.split(key, 4)
    angle = jax.random.uniform(headings, (count,), maxval=2 * np.pi)
    x, z = jax.random.uniform(
        targets, (2, DRAWS, count), minval=-plane.HALF_SIDE, maxval=plane.HALF_SIDE
    )
    drawn = z + 1j * x
    first = jnp.argmax(jnp.abs(drawn) > plane.REACH, axis=0)
    return Worlds(
        frame=jax.random.choice(frames, motion.candidates, (count,)),
        place=jnp.zeros(count, jnp.complex64),
        heading=jnp.exp(1j * angle),
        target=drawn[first, jnp.arange(count)],
        age=jnp.zeros(count, jnp.int32),
        limit=plane.MAX_STEPS - jax.random.randint(limits, (count,), 0, spread),
    )


def observe(motion, worlds):
    goal = plane.GOAL_SCALE * worlds.heading.conj() * (worlds.target - worlds.place)
    return jnp.column_stack([motion.poses[worlds.frame], goal.imag, goal.real])


def play(motion, worlds, action):
    """One step. Returns worlds, rewards, who arrived, and who is out of steps."""
    match = nearest(motion, jnp.column_stack([motion.poses[worlds.frame], action]))
    heading = worlds.heading * motion.turned[match]
    worlds = worlds._replace(
        frame=motion.candidates[match] + PLAYED,
        place=worlds.place + worlds.heading * motion.moved[match],
        heading=heading / jnp.abs(heading),
        age=worlds.age + 1,
    )
    distance = jnp.abs(worlds.target - worlds.place)
    reached = distance <= plane.REACH
    reward = jnp.exp(-distance) + plane.BONUS * reached
    return worlds, reward, reached, ~reached & (worlds.age >= worlds.limit)


# The networks.


def network(key, outputs):
    """Weights of unit gain, nearly none in the last layer; zero biases."""
    widths = [plane.OBSERVATION, *plane.HIDDEN, outputs]
    gains = [1.0] * len(plane.HIDDEN) + [0.01]
    return [
        (gain / np.sqrt(a) * jax.random.normal(key, (a, b)), jnp.zeros(b))
        for key, a, b, gain in zip(jax.random.split(key, len(gains)), widths, widths[1:], gains)
    ]


def answer(layers, x):
    *hidden, (weights, biases) = layers
    for w, b in hidden:
        x = jnp.tanh(x @ w + b)
    return x @ weights + biases


def value(parameters, observation):
    """In units of the critic's running statistics."""
    return answer(parameters["critic"], observation)[..., 0]


def log_prob(parameters, observation, action):
    log_std = parameters["log_std"]
    noise = (action - answer(parameters["actor"], observation)) * jnp.exp(-log_std)
    return jnp.sum(-0.5 * noise**2 - log_std - HALF_LOG_TAU, axis=-1)


# Learning.

ADAM = optax.chain(
    optax.clip_by_global_norm(plane.MAX_GRADIENT), optax.adam(plane.RATE, eps=plane.EPSILON)
)


def novice(motion, seed):
    worlds, actor, critic, key = jax.random.split(jax.random.key(seed), 4)
    parameters = {
        "actor": network(actor, plane.ACTION),
        "critic": network(critic, 1),
        "log_std": jnp.full(plane.ACTION, plane.LOG_STD),
    }
    return Learner(
        parameters=parameters,
        optimiser=ADAM.init(parameters),
        moments=jnp.array([0.0, 1.0]),
        updates=jnp.array(0),
        worlds=begin(motion, worlds, plane.ENVS, spread=plane.MAX_STEPS),
        key=key,
    )


def rollout(motion, parameters, worlds, key):
    """Plays `HORIZON` steps; what was seen comes as [step][world]."""

    def step(worlds, key):
        noises, episodes = jax.random.split(key)
        observation = observe(motion, worlds)
        mean = answer(parameters["actor"], observation)
        noise = jax.random.normal(noises, mean.shape)
        action = mean + jnp.exp(parameters["log_std"]) * noise
        worlds, reward, reached, late = play(motion, worlds, action)
        last = observe(motion, worlds)
        ended = reached | late
        fresh = begin(motion, episodes, plane.ENVS)
        worlds = jax.tree.map(lambda new, old: jnp.where(ended, new, old), fresh, worlds)
        return worlds, (observation, action, reward, reached, late, last)

    return jax.lax.scan(step, worlds, jax.random.split(key, plane.HORIZON))


def advantages(reward, reached, late, now, after):
    """Generalised; `after` is of the state a step led to, before a new episode began."""

    def back(sum, step):
        reward, reached, late, now, after = step
        sum = jnp.where(reached | late, 0.0, sum)
        after = jnp.where(reached, 0.0, after)
        sum = reward + plane.GAMMA * after - now + plane.GAMMA * plane.LAMBDA * sum
        return sum, sum

    steps = (reward, reached, late, now, after)
    return jax.lax.scan(back, jnp.zeros(plane.ENVS), steps, reverse=True)[1]


def deviation(moments):
    return jnp.sqrt(jnp.maximum(moments[1] - moments[0] ** 2, 1e-6))


def loss(parameters, sample):
    change = log_prob(parameters, sample.observation, sample.action) - sample.log_prob
    ratio = jnp.exp(change)
    clipped = jnp.clip(ratio, 1 - plane.CLIP, 1 + plane.CLIP)
    surrogate = jnp.minimum(ratio * sample.advantage, clipped * sample.advantage)
    error = value(parameters, sample.observation) - sample.target
    return plane.VALUE_COEFFICIENT * jnp.mean(error**2) - jnp.mean(surrogate)


def descend(state, sample):
    parameters, optimiser = state
    change, optimiser = ADAM.update(jax.grad(loss)(parameters, sample), optimiser)
    return (optax.apply_updates(parameters, change), optimiser), None


def epoch(state, key, samples):
    order = jax.random.permutation(key, plane.ENVS * plane.HORIZON)
    order = order.reshape(-1, plane.MINIBATCH)
    minibatches = jax.tree.map(lambda column: column[order], samples)
    return jax.lax.scan(descend, state, minibatches)


def update(motion, learner):
    """One rollout and what is learned from it. Returns also how many episodes ended and arrived."""
    key, playing, shuffling = jax.random.split(learner.key, 3)
    parameters, moments = learner.parameters, learner.moments
    worlds, seen = rollout(motion, parameters, learner.worlds, playing)
    observation, action, reward, reached, late, last = seen

    def real(observation):
        return value(parameters, observation) * deviation(moments) + moments[0]

    now = real(observation)
    advantage = advantages(reward, reached, late, now, real(last))
    target = advantage + now
    updates = learner.updates + 1
    share = jnp.maximum(NEWEST, 1 / updates)
    newest = jnp.array([jnp.mean(target), jnp.mean(target**2)])
    moments = (1 - share) * moments + share * newest
    samples = Sample(
        observation=observation,
        action=action,
        log_prob=log_prob(parameters, observation, action),
        advantage=(advantage - jnp.mean(advantage)) / (jnp.std(advantage) + 1e-6),
        target=(target - moments[0]) / deviation(moments),
    )
    # Steps and worlds become one axis.
    samples = jax.tree.map(lambda column: column.reshape(-1, *column.shape[2:]), samples)
    (parameters, optimiser), _ = jax.lax.scan(
        lambda state, key: epoch(state, key, samples),
        (parameters, learner.optimiser),
        jax.random.split(shuffling, plane.EPOCHS),
    )
    learner = Learner(parameters, optimiser, moments, updates, worlds, key)
    return learner, (jnp.sum(reached | late), jnp.sum(reached))


def look(motion, learner):
    """Updates up to the next look at the success, and that of their episodes."""
    learner, (ended, reached) = jax.lax.scan(
        lambda learner, _: update(motion, learner), learner, length=plane.UPDATES
    )
    return learner, jnp.sum(reached) / jnp.maximum(jnp.sum(ended), 1)


def evaluate(motion, parameters):
    """Success of the mean action over fixed episodes, each run to its end."""

    def step(state):
        worlds, running, arrived = state
        action = answer(parameters["actor"], observe(motion, worlds))
        worlds, _, reached, late = play(motion, worlds, action)
        return worlds, running & ~(reached | late), arrived | (running & reached)

    worlds = begin(motion, jax.random.key(0), plane.EPISODES)
    everyone = jnp.full(plane.EPISODES, True)
    state = (worlds, everyone, ~everyone)
    return jnp.mean(jax.lax.while_loop(lambda state: jnp.any(state[1]), step, state)[2])


def main():
    args = plane.options(__doc__).parse_args()
    motion = motion_of(load(args.database))
    learner = novice(motion, args.seed)
    start = perf_counter()
    compiled = jax.jit(look).lower(motion, learner).compile()
    results.report(args.json, "plane, compiling", "JAX", "s", perf_counter() - start)
    judge = jax.jit(evaluate)

    def learn():
        nonlocal learner
        learner, success = compiled(motion, learner)
        return float(success)

    outcome = plane.race(learn, lambda: float(judge(motion, learner.parameters)), args.steps, args.max_time)
    plane.report(args, "JAX", *outcome)


if __name__ == "__main__":
    main()
