"""
Friction and hysteresis
=======================

At the end, you have a hysteresis loop: with friction, the cable tension is higher while the winch takes in cable than
while it pays out.
"""

# %%
# Coulomb friction of 0.2 at the via points (capstan law).
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
robot = replace(robot, cables=tuple(replace(cable, friction=0.2) for cable in robot.cables))

# %%
# Load and unload in small steps, each starting from the previous pose.
steps = np.linspace(0.0, 0.03, 16)
there_and_back = np.concatenate([steps, steps[-2::-1]])
cable = next(i for i, cable in enumerate(robot.cables) if cable.winch == "left")


def tension_on_the_way(simulation):
    """Return the tension at the winch at each step [N]."""
    pose, tensions = simulation.rest, []
    for contraction in there_and_back:
        pose = simulation.solve({"left": float(contraction)}, start=pose)
        tensions.append(pose.tensions[cable])
    return np.array(tensions)


tensions = tension_on_the_way(hs.Simulation(robot))

# %%
# The area of the loop is the work lost to friction.
means = (tensions[1:] + tensions[:-1]) / 2
work = float(means @ np.diff(there_and_back))
print(f"friction takes {1e3 * work:.1f} mJ")

# %%
# The loop.
figure = Figure(figsize=(5, 4), layout="constrained")
axes = figure.add_subplot(xlabel="contraction of winch left [mm]", ylabel="tension at the winch [N]")
axes.plot(1e3 * steps, tensions[:16], ".-", label="loading")
axes.plot(1e3 * steps[::-1], tensions[15:], ".-", label="unloading")
axes.legend()
