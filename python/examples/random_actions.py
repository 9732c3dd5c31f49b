"""Random actions in a thousand environments: how fast they are, and how rarely they arrive.

python random_actions.py [TASK]
"""

import sys
import time

import gymnasium
from gymnasium.wrappers.vector import RecordEpisodeStatistics

task = sys.argv[1] if len(sys.argv) > 1 else "plane"
envs = gymnasium.make_vec(f"footwork/{task.capitalize()}-v0", num_envs=1024)
envs = RecordEpisodeStatistics(envs)
envs.action_space.seed(0)
observations, infos = envs.reset(seed=0)

start, steps = time.perf_counter(), 0
while time.perf_counter() - start < 5.0:
    actions = envs.action_space.sample()
    observations, rewards, terminations, truncations, infos = envs.step(actions)
    steps += envs.num_envs

rate = steps / (time.perf_counter() - start)
print(f"{task}: {rate:,.0f} steps/s, sampling of the actions included")
print(f"{envs.episode_count} episodes ended; means: {envs.unwrapped.statistics()}")
envs.close()
