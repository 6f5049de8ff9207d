"""
Loads and compliance
====================

At the end, you have the compliance of an arm's tip in a pose, a load that confirms it, and the force that reaches
a target.
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
# 0.5 N is beyond the linear range. A load drive makes the force [N] a control that you set or the solver finds.
load = hs.Load(name="thread", marker="left", force=(0.0, -1.0), drive="thread")
drive = hs.LoadDrive(name="thread", min=0.0, max=2.0)
pulled = hs.Simulation(replace(robot, loads=(load,), drives=(drive,)))
figure = pulled.solve({"left": 0.012, "thread": 0.5}).plot()
found = hs.solve_ik(pulled, {"left": pose.markers["left"] + (0.0, -0.005)})
taken, pull = 1e3 * found.pose.contractions["left"], found.pose.drives["thread"]
print(f"tip 5 mm lower: winch {taken:.1f} mm, thread {pull:.2f} N")
