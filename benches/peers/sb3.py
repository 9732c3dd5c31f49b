"""Stable-Baselines3's PPO on the plane task: worlds in NumPy, search by Faiss.

python sb3.py DATABASE
"""

import numpy as np
from gymnasium.spaces import Box
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

import plane
from database import PLAYED, POSE, load
from search import PRODUCTS, Flat


class Plane:
    """Worlds side by side: `src/kernels/{reset,observe,query,step}.rs`."""

    def __init__(self, database, search, count, seed, spread=1):
        self.database, self.search = database, search
        self.random = np.random.default_rng(seed)
        self.frame, self.age, self.limit = np.zeros((3, count), np.int64)
        self.place, self.heading, self.target = np.zeros((3, count), np.complex64)
        self.begin(np.arange(count), spread)

    def begin(self, envs, spread=1):
        """New episodes, their limits up to `spread` early."""
        self.frame[envs] = self.random.choice(self.database.candidates, len(envs))
        self.age[envs] = 0
        self.limit[envs] = plane.MAX_STEPS - self.random.integers(spread, size=len(envs))
        self.place[envs] = 0
        self.heading[envs] = np.exp(1j * self.random.uniform(-np.pi, np.pi, len(envs)))
        while len(envs):
            z, x = self.random.uniform(-plane.HALF_SIDE, plane.HALF_SIDE, (2, len(envs)))
            self.target[envs] = z + 1j * x
            envs = envs[np.abs(self.target[envs]) <= plane.REACH]

    def observe(self):
        goal = plane.GOAL_SCALE * self.heading.conj() * (self.target - self.place)
        return np.column_stack([self.pose(), goal.imag, goal.real])

    def pose(self):
        return self.database.features[self.frame, :POSE]

    def play(self, action):
        """One step. Returns rewards, who arrived, and who is out of steps."""
        match = self.search(np.concatenate([self.pose(), action], axis=1))
        self.frame = self.database.candidates[match] + PLAYED
        self.place += self.heading * self.database.moved[match]
        self.heading *= self.database.turned[match]
        self.heading /= np.abs(self.heading)
        self.age += 1
        distance = np.abs(self.target - self.place)
        reached = distance <= plane.REACH
        reward = np.exp(-distance) + plane.BONUS * reached
        return reward, reached, ~reached & (self.age >= self.limit)

    def keep(self, envs):
        """Goes on with these worlds alone."""
        for name in ("frame", "age", "place", "heading", "target", "limit"):
            setattr(self, name, getattr(self, name)[envs])


class Worlds(VecEnv):
    """The same in the form that Stable-Baselines3 asks for."""

    # It insists on bounds; actions never come near these.
    BOUND = 100.0

    def __init__(self, database, search, seed):
        self.plane = Plane(database, search, plane.ENVS, seed, spread=plane.MAX_STEPS)
        self.forget()
        super().__init__(
            plane.ENVS,
            Box(-np.inf, np.inf, (plane.OBSERVATION,)),
            Box(-self.BOUND, self.BOUND, (plane.ACTION,)),
        )

    def forget(self):
        """Counts episodes anew."""
        self.episodes = self.successes = 0

    def reset(self):
        return self.plane.observe()

    def step_async(self, actions):
        self.actions = actions

    def step_wait(self):
        reward, reached, late = self.plane.play(self.actions)
        ended = np.flatnonzero(reached | late)
        self.episodes += len(ended)
        self.successes += np.count_nonzero(reached)
        infos = [{}] * self.num_envs
        last = self.plane.observe()
        for env in np.flatnonzero(late):
            infos[env] = {"TimeLimit.truncated": True, "terminal_observation": last[env]}
        self.plane.begin(ended)
        return self.plane.observe(), reward, reached | late, infos

    def close(self):
        pass

    def get_attr(self, name, indices=None):
        # The one attribute it asks for is how to render: not at all.
        return [None] * self.num_envs

    def set_attr(self, name, value, indices=None):
        raise NotImplementedError

    def env_method(self, name, *args, indices=None, **kwargs):
        raise NotImplementedError

    def env_is_wrapped(self, wrapper, indices=None):
        return [False] * self.num_envs


def evaluate(model, database, search):
    """Success of the mean action over fixed episodes, each run to its end."""
    worlds = Plane(database, search, plane.EPISODES, seed=0)
    successes = 0
    while len(worlds.frame):
        action, _ = model.predict(worlds.observe(), deterministic=True)
        _, reached, late = worlds.play(action)
        successes += np.count_nonzero(reached)
        worlds.keep(~(reached | late))
    return successes / plane.EPISODES


def main():
    args = plane.options(__doc__).parse_args()
    database = load(args.database)
    search = Flat(database.rows, PRODUCTS)
    worlds = Worlds(database, search, args.seed)
    model = PPO(
        "MlpPolicy",
        # Its own way to keep the critic's targets near one.
        VecNormalize(worlds, norm_obs=False, gamma=plane.GAMMA),
        learning_rate=plane.RATE,
        n_steps=plane.HORIZON,
        batch_size=plane.MINIBATCH,
        n_epochs=plane.EPOCHS,
        gamma=plane.GAMMA,
        gae_lambda=plane.LAMBDA,
        clip_range=plane.CLIP,
        ent_coef=0.0,
        vf_coef=plane.VALUE_COEFFICIENT,
        max_grad_norm=plane.MAX_GRADIENT,
        policy_kwargs={
            "net_arch": list(plane.HIDDEN),
            "log_std_init": plane.LOG_STD,
            "optimizer_kwargs": {"eps": plane.EPSILON},
        },
        seed=args.seed,
        device="cpu",
    )

    def learn():
        worlds.forget()
        model.learn(plane.LOOK, reset_num_timesteps=False)
        return worlds.successes / max(worlds.episodes, 1)

    outcome = plane.race(learn, lambda: evaluate(model, database, search), args.steps, args.max_time)
    plane.report(args, "Stable-Baselines3", *outcome)


if __name__ == "__main__":
    main()
