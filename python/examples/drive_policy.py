"""A policy trained in a few seconds, then driven by hand: it arrives in nearly all of 200 episodes.

python drive_policy.py [RUN]
"""

import sys
import tempfile

import numpy as np

import footwork

if len(sys.argv) > 1:
    run = sys.argv[1]
else:
    run = footwork.train("plane", tempfile.mkdtemp() + "/plane", stop_at_success=0.99)["run"]
policy = footwork.Policy.load(run)

envs = policy.make_vec(num_envs=200, seed=1)
observations, _ = envs.reset()
arrived = np.full(envs.num_envs, np.nan)  # of the first episode of each environment
while np.isnan(arrived).any():
    observations, rewards, terminations, truncations, infos = envs.step(policy(observations))
    for row in np.flatnonzero(terminations | truncations):
        if np.isnan(arrived[row]):
            arrived[row] = infos["final_info"]["success"][row]
print(f"{policy}: {100 * arrived.mean():.1f} % of {envs.num_envs} episodes succeed")
