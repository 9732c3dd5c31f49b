"""The plane under skrl's PPO.

pip install skrl; python skrl_ppo.py [STEPS]
"""

import sys

import torch
from skrl.agents.torch.ppo import PPO, PPO_CFG
from skrl.envs.wrappers.torch import wrap_env
from skrl.memories.torch import RandomMemory
from skrl.models.torch import DeterministicMixin, GaussianMixin, Model
from skrl.trainers.torch import SequentialTrainer
from skrl.utils import set_seed
from torch import nn

import footwork

STEPS = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
ENVS, ROLLOUT = 256, 16
set_seed(1)


def mlp(inputs, outputs):
    return nn.Sequential(nn.Linear(inputs, 32), nn.Tanh(), nn.Linear(32, 32), nn.Tanh(), nn.Linear(32, outputs))


class Policy(GaussianMixin, Model):
    def __init__(self, envs):
        Model.__init__(
            self, observation_space=envs.observation_space, action_space=envs.action_space, device=envs.device
        )
        GaussianMixin.__init__(self)
        self.mean = mlp(self.num_observations, self.num_actions)
        # An action of 1 asks for four standard deviations of the motion: explore by one.
        self.log_std = nn.Parameter(torch.full((self.num_actions,), 0.25).log())

    def compute(self, inputs, role):
        return self.mean(inputs["observations"]), {"log_std": self.log_std}


class Value(DeterministicMixin, Model):
    def __init__(self, envs):
        Model.__init__(
            self, observation_space=envs.observation_space, action_space=envs.action_space, device=envs.device
        )
        DeterministicMixin.__init__(self)
        self.value = mlp(self.num_observations, 1)

    def compute(self, inputs, role):
        return self.value(inputs["observations"]), {}


envs = wrap_env(footwork.make_vec("plane", num_envs=ENVS, seed=1), wrapper="gymnasium")
models = {"policy": Policy(envs), "value": Value(envs)}
cfg = PPO_CFG(
    rollouts=ROLLOUT,
    learning_epochs=3,
    mini_batches=8,
    discount_factor=0.95,
    learning_rate=1e-3,
    grad_norm_clip=1.0,
    time_limit_bootstrap=True,
    # Of the order of the rewards: the bonus for arriving is 1000.
    rewards_shaper=lambda rewards, *_: 0.01 * rewards,
)
cfg.experiment.write_interval = 0
cfg.experiment.checkpoint_interval = 0
agent = PPO(
    models=models,
    memory=RandomMemory(memory_size=ROLLOUT, num_envs=ENVS, device=envs.device),
    observation_space=envs.observation_space,
    action_space=envs.action_space,
    device=envs.device,
    cfg=cfg,
)
SequentialTrainer(env=envs, agents=agent, cfg={"timesteps": STEPS // ENVS, "headless": True}).train()

judged = footwork.make_vec("plane", num_envs=200, seed=2)
observations, _ = judged.reset()
for _ in range(200):
    with torch.no_grad():
        actions = models["policy"].mean(torch.from_numpy(observations)).numpy()
    observations, *_ = judged.step(actions)
print(f"skrl, {STEPS} steps: {judged.statistics()}")
