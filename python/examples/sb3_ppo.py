"""The plane under Stable-Baselines3's PPO.

pip install stable-baselines3; python sb3_ppo.py [STEPS]
"""

import sys

import numpy as np
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

import footwork
from footwork.sb3 import SB3VecEnv

steps = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
envs = footwork.make_vec("plane", num_envs=256, seed=1)
model = PPO(
    "MlpPolicy",
    # The bonus for arriving is 1000.
    VecNormalize(SB3VecEnv(envs), norm_obs=False, gamma=0.95),
    n_steps=16,
    batch_size=512,
    n_epochs=3,
    learning_rate=1e-3,
    gamma=0.95,
    # An action of 1 asks for four standard deviations of the motion: explore by one.
    policy_kwargs={"log_std_init": np.log(0.25), "net_arch": [32, 32]},
    seed=1,
    device="cpu",
)
model.learn(steps)

judged = footwork.make_vec("plane", num_envs=200, seed=2)
observations, _ = judged.reset()
for _ in range(200):
    actions, _ = model.predict(observations, deterministic=True)
    observations, *_ = judged.step(actions)
print(f"Stable-Baselines3, {steps} steps: {judged.statistics()}")
