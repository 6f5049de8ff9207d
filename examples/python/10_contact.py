"""
Contact with an obstacle
========================

At the end, a ball stops an arm of a starfish, and you know the contact force.
"""

# %%
# Obstacles are rigid. `Contact` sets the distance at which contact forces begin.
from dataclasses import replace

import numpy as np

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
ball = hs.Obstacle(name="ball", shape="sphere", at=(-0.095, 0.085), radius=0.025)
touching = replace(robot, contact=hs.Contact(), obstacles=(ball,))

# %%
# The winch pulls the arm up against the ball. Each contact patch has a force [N].
simulation = hs.Simulation(touching)
pose = simulation.solve({"left": 0.025})
patches = hs.find_contacts(simulation, pose)
print(f"{len(patches)} contact, {np.linalg.norm(patches[0].force):.2f} N")

# %%
# No node enters the ball.
gap = float(np.linalg.norm(pose.nodes - np.array(ball.at), axis=1).min() - 0.025)
print(f"nearest node: {1e3 * gap:.2f} mm from the ball")
figure = pose.plot()
