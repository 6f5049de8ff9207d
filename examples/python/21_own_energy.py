"""
Your own energy
===============

At the end, a spring that you wrote holds the tip of an arm in every simulation.
"""

# %%
# An energy has a value, a gradient and a Hessian, for each of its terms. This one has one term: a spring from one node
# to a fixed point.
from dataclasses import replace

import numpy as np

import hydrostat as hs


class Spring(hs.Energy):
    """Spring of no length: k/2 |x - place|^2."""

    has_constant_hessian = True

    def __init__(self, node, place, stiffness):
        self.stencils = np.array([[node]])
        self.node, self.place, self.stiffest = node, np.array(place), stiffness

    def value(self, nodes, controls):
        """Return the energy [J]."""
        return 0.5 * self.stiffest * float(np.sum((nodes[self.node] - self.place) ** 2))

    def gradient(self, nodes, controls):
        """Return dE/dx [N], (terms, corners, dim)."""
        return self.stiffest * (nodes[self.node] - self.place)[None, None, :]

    def hessian(self, nodes, controls):
        """Return d2E/dx2 [N/m], (terms, corners x dim, corners x dim)."""
        return self.stiffest * np.eye(nodes.shape[1])[None]


# %%
# Check it by finite differences, then give it to a simulation. Inverse kinematics and dynamics include it, too.
robot = hs.load_robot("gallery:starfish")
rest = robot.body.mesh.nodes
tip = int(np.argmin(rest[:, 0]))
spring = Spring(tip, rest[tip] + [0.0, 0.05], 5.0)
hs.testing.check_energy(spring, rest + 0.01, np.zeros(3))
pose = hs.Simulation(robot, energies=[spring]).solve({})

# %%
# As a check, apply the spring force as a load, without the spring. The pose is the same.
force = spring.stiffest * (spring.place - pose.nodes[tip])
pulled = hs.Load(name="hand", at=tuple(rest[tip]), force=tuple(force))
loaded = hs.Simulation(replace(robot, loads=(pulled,))).solve({})
error = float(np.linalg.norm(loaded.nodes - pose.nodes, axis=1).max())
moved = float(np.linalg.norm(pose.nodes[tip] - rest[tip]))
print(f"the spring pulls {np.linalg.norm(force):.2f} N, the tip moves {1e3 * moved:.1f} mm, {1e9 * error:.2g} nm apart")
figure = pose.plot()
