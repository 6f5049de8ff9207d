"""
Loads and compliance
====================

At the end you have the compliance of an arm's tip in a pose, and a hung mass that confirms it.
"""

# %%
# dx/dF of each marker at an equilibrium [m/N], exact.
from dataclasses import replace

import numpy as np

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
simulation = hs.Simulation(robot)
pose = simulation.solve({"left": 0.012})
names = [marker.name for marker in robot.markers]
compliance = hs.marker_compliance(simulation, pose)[names.index("left")]
print("mm per N:", *np.round(1e3 * compliance, 1))

# %%
# Pull the tip down by 10 mN and compare.
force = np.array([0.0, -0.01])
load = hs.Load(name="thread", marker="left", force=tuple(force))
pulled = hs.Simulation(replace(robot, loads=(load,))).solve({"left": 0.012})
moved = pulled.markers["left"] - pose.markers["left"]
error = float(np.linalg.norm(moved - compliance @ force) / np.linalg.norm(moved))
print(f"moved {1e3 * np.linalg.norm(moved):.3f} mm, predicted to {100 * error:.1f} %")

# %%
# 0.5 N is no longer small.
load = hs.Load(name="thread", marker="left", force=(0.0, -0.5))
figure = hs.Simulation(replace(robot, loads=(load,))).solve({"left": 0.012}).plot()
