"""The plane under TorchRL's PPO.

pip install torchrl; python torchrl_ppo.py [STEPS]
"""

import sys

import torch
from tensordict.nn import TensorDictModule
from torch import nn
from torchrl.collectors import Collector
from torchrl.envs import GymWrapper
from torchrl.modules import IndependentNormal, ProbabilisticActor, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

import footwork

STEPS = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
ENVS, ROLLOUT, MINIBATCH, EPOCHS = 256, 16, 512, 3
# Of the order of the rewards: the bonus for arriving is 1000.
REWARD_SCALE = 0.01
torch.manual_seed(1)


def mlp(inputs, outputs):
    return nn.Sequential(nn.Linear(inputs, 32), nn.Tanh(), nn.Linear(32, 32), nn.Tanh(), nn.Linear(32, outputs))


class Gaussian(nn.Module):
    """A mean that depends on the observation, and a standard deviation that does not."""

    def __init__(self, inputs, outputs):
        super().__init__()
        self.mean = mlp(inputs, outputs)
        # An action of 1 asks for four standard deviations of the motion: explore by one.
        self.log_std = nn.Parameter(torch.full((outputs,), 0.25).log())

    def forward(self, observation):
        mean = self.mean(observation)
        return mean, self.log_std.exp().expand_as(mean)


envs = footwork.make_vec("plane", num_envs=ENVS, seed=1)
inputs, outputs = envs.single_observation_space.shape[0], envs.single_action_space.shape[0]
actor = ProbabilisticActor(
    TensorDictModule(Gaussian(inputs, outputs), in_keys=["observation"], out_keys=["loc", "scale"]),
    in_keys=["loc", "scale"],
    distribution_class=IndependentNormal,
    return_log_prob=True,
)
critic = ValueOperator(mlp(inputs, 1), in_keys=["observation"])
advantages = GAE(gamma=0.95, lmbda=0.95, value_network=critic)
loss = ClipPPOLoss(actor, critic, clip_epsilon=0.2, entropy_coeff=0.0)
optimizer = torch.optim.Adam(loss.parameters(), lr=1e-3)

collector = Collector(GymWrapper(envs), actor, frames_per_batch=ENVS * ROLLOUT, total_frames=STEPS)
for rollout in collector:
    rollout["next", "reward"] *= REWARD_SCALE
    for _ in range(EPOCHS):
        with torch.no_grad():
            advantages(rollout)
        samples = rollout.reshape(-1)
        for rows in torch.randperm(len(samples)).split(MINIBATCH):
            losses = loss(samples[rows])
            optimizer.zero_grad()
            (losses["loss_objective"] + losses["loss_critic"]).backward()
            nn.utils.clip_grad_norm_(loss.parameters(), 1.0)
            optimizer.step()
collector.shutdown()

judged = footwork.make_vec("plane", num_envs=200, seed=2)
observations, _ = judged.reset()
mean = actor.module[0].module.mean
for _ in range(200):
    with torch.no_grad():
        actions = mean(torch.from_numpy(observations)).numpy()
    observations, *_ = judged.step(actions)
print(f"TorchRL, {STEPS} steps: {judged.statistics()}")
