"""
A gymnasium environment
=======================

At the end, a random policy has run one episode of the reaching task, and you know the observation and action spaces for
your own policy. Needs gymnasium (``pip install -e ".[rl]"``).
"""

# %%
# Any robot is an environment: actions move winches, the reward is minus the mean distance of the markers from
# their goals, in units of the tolerance.
import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs
from hydrostat.training import ReachEnv, ReachOptions

options = ReachOptions(steps=40, incremental=True)
environment = ReachEnv(hs.load_robot("gallery:starfish"), options=options)
print("actions", environment.action_space.shape, "observations", environment.observation_space)

# %%
# One episode of random actions.
environment.action_space.seed(1)
observation, info = environment.reset(seed=0)
rewards, ended = [], False
while not ended:
    observation, reward, terminated, truncated, info = environment.step(environment.action_space.sample())
    rewards.append(float(reward))
    ended = terminated or truncated
steps = len(rewards)
print(f"{steps} steps, mean reward {np.mean(rewards):.3f}")

# %%
# Reward over the episode.
figure = Figure(figsize=(6, 3.5), layout="constrained")
figure.add_subplot(xlabel="step", ylabel="reward").plot(rewards)
