"""
Grasp and pull-out force
========================

At the end, you know how hard a starfish holds a ball: the force that pulls it out.
"""

# %%
# At rest, the ball lies between two arms and touches neither. Contact is on; the friction coefficient is 0.8.
from dataclasses import replace

import numpy as np

import hydrostat as hs

robot = replace(hs.load_robot("gallery:starfish"), contact=hs.Contact(distance=1e-3))
ball = hs.Obstacle(name="ball", shape="sphere", at=(0.055, 0.055), radius=0.018, mass=0.02, friction=0.8)

# %%
# Close the arm, let the ball settle, then pull in steps of 3 mm.
options = hs.grasp.PullOptions(direction=(1.0, 0.0), step=3e-3)
pull = hs.grasp.pull_out(robot, ball, {"right": 0.055}, options)
print(f"largest force {pull.peak:.2f} N, {pull.status}")

# %%
# The pull balances the contact forces.
error = float(np.abs(pull.forces + pull.contact @ options.direction).max())
print(f"forces balance to {error:.1e} N")
figure = hs.plot.draw_pull(robot, pull)
