"""
A trained policy
================

At the end, a policy trained by reinforcement learning moves the simulated starfish to a target in ten actions. It runs
without PyTorch.
"""

# %%
# A policy is one file: a small network and its training record. This one comes from
# ``examples/policies/train_starfish.py``; ``hydrostat train`` writes the same file as ``actor.policy``.
import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs
from hydrostat.robot import gallery_folder

file = gallery_folder("starfish").parent / "policies" / "starfish_reach.policy"
policy = hs.learning.PortablePolicy.load(file)
print(policy.facts["task"], policy.facts["sees"], f"error in training {1e3 * policy.facts['error']:.1f} mm")

# %%
# The target: marker positions at contractions that the policy does not see.
robot = hs.load_robot("gallery:starfish")
simulation = hs.Simulation(robot)
least, most = np.array([(-winch.release, winch.travel) for winch in robot.winches]).T
rest, size = np.array([marker.at for marker in robot.markers]), robot.body.mesh.size
goal = np.array(list(simulation.solve([0.02, 0.035, 0.01]).markers.values()))

# %%
# Closed loop: each action follows from contractions, markers and target, and moves each winch by at most a tenth of its
# range.
contractions, pose, errors = np.zeros(len(robot.winches)), simulation.solve({}), []
for _ in range(10):
    markers = np.array(list(pose.markers.values()))
    errors.append(1e3 * np.linalg.norm(markers - goal, axis=1).mean())
    seen = {
        "observation": 2 * (contractions - least) / (most - least) - 1,
        "achieved_goal": ((markers - rest) / size).ravel(),
        "desired_goal": ((goal - rest) / size).ravel(),
    }
    contractions = np.clip(contractions + 0.1 * (most - least) * policy.act(seen), least, most)
    pose = simulation.solve(contractions, start=pose)
error = float(np.linalg.norm(np.array(list(pose.markers.values())) - goal, axis=1).mean())
print(f"{errors[0]:.1f} mm away at rest, {1e3 * error:.2f} mm after ten actions")

# %%
# Error over the actions.
figure = Figure(figsize=(6, 3.5), layout="constrained")
figure.add_subplot(xlabel="action", ylabel="mean error [mm]").plot([*errors, 1e3 * error], marker="o")
