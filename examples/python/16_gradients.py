"""
Exact gradients by the adjoint
==============================

At the end, you know how a marker's error changes with every contraction, every point of every cable and the material,
at the cost of one linear solve.
"""

# %%
# L is half the squared distance of one marker from its target.
import numpy as np

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
simulation = hs.Simulation(robot)
names = [marker.name for marker in robot.markers]
target = np.array(robot.poses["wave"].targets["left"])


def loss(contraction):
    """Return L at a contraction of the left winch, and the pose."""
    pose = simulation.solve({"left": contraction})
    return 0.5 * float(np.sum((pose.markers["left"] - target) ** 2)), pose


# %%
# dL/dx at the nodes, then the adjoint.
_, pose = loss(0.02)
errors = np.zeros((len(names), 2))
errors[names.index("left")] = pose.markers["left"] - target
gradient = simulation.adjoint(pose, simulation.marker_anchors.matrix(len(pose.nodes)).T @ errors)
left = [winch.name for winch in robot.winches].index("left")

# %%
# Compare with a central difference.
step = 1e-6
difference = (loss(0.02 + step)[0] - loss(0.02 - step)[0]) / (2 * step)
error = float(abs(gradient.contractions[left] / difference - 1))
print(f"dL/da = {gradient.contractions[left]:.6g} m, difference {difference:.6g} m, relative {error:.1e}")
print("dL/d points of the left cable [m]:", gradient.routes[1].round(5).tolist())
figure = pose.plot()
