"""
A trajectory through poses
==========================

At the end, one smooth trajectory connects two poses within the speed and acceleration limits of the winches.
"""

# %%
# From rest through both poses and back.
import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
simulation = hs.Simulation(robot)
up = hs.solve_ik(simulation, {"left": (-0.103, 0.052)}).pose
wide = hs.solve_ik(simulation, {"right": (0.107, 0.05)}).pose
found = hs.solve_ik_trajectory(simulation, [up, wide, simulation.rest], speed=0.05, acceleration=0.2)
print(*found.lines(), sep="\n")

# %%
# Contraction of each winch.
profile = found.profile()
times = np.linspace(0.0, found.seconds, 300)
contractions = np.array([profile.at(time) for time in times])
fastest = float(np.abs(np.diff(contractions, axis=0)).max() / (times[1] - times[0]))
print(f"fastest winch: {1e3 * fastest:.1f} mm/s of 50 mm/s allowed")
figure = Figure(figsize=(6, 3.5), layout="constrained")
axes = figure.add_subplot(xlabel="time [s]", ylabel="contraction [mm]")
for winch, column in zip(robot.winches, contractions.T, strict=True):
    axes.plot(times, 1e3 * column, label=winch.name)
axes.legend()
