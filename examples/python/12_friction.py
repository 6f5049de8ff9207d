"""
Friction and hysteresis
=======================

At the end you have a hysteresis loop: with friction in its cables a starfish rests elsewhere on the way back.
"""

# %%
# Coulomb friction of 0.2 at the via points (capstan law).
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
robot = replace(robot, cables=tuple(replace(cable, friction=0.2) for cable in robot.cables))
simulation = hs.Simulation(robot)

# %%
# Load and unload in small steps, each from the pose before.
steps = np.linspace(0.0, 0.03, 16)
pose, heights = simulation.rest, []
for contraction in np.concatenate([steps, steps[::-1]]):
    pose = simulation.solve({"left": float(contraction)}, start=pose)
    heights.append(1e3 * pose.markers["left"][1])
up, down = np.array(heights[: len(steps)]), np.array(heights[len(steps) :])[::-1]
width = float(np.abs(up - down).max())
print(f"loading and unloading differ by up to {width:.1f} mm")

# %%
# The loop.
figure = Figure(figsize=(5, 4), layout="constrained")
axes = figure.add_subplot(xlabel="contraction of winch left [mm]", ylabel="height of the left tip [mm]")
axes.plot(1e3 * steps, up, ".-", label="loading")
axes.plot(1e3 * steps, down, ".-", label="unloading")
axes.legend()
