"""
Motion and settling
===================

At the end, you see how an arm swings after its winch stops, and when it has settled.
"""

# %%
# Take in 20 mm within 0.2 s, then hold. Viscosity damps the swing.
import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
robot = robot.with_material(viscosity=60.0)
simulation = hs.Simulation(robot)
left = np.array([winch.name == "left" for winch in robot.winches])
profile = hs.ContractionProfile(times=np.array([0.0, 0.2]), values=np.array([0.0 * left, 0.02 * left]))
motion = [(state.time, state.markers["left"][1]) for state in simulation.play(profile, 1.5, 0.01)]

# %%
# The motion ends at the static equilibrium.
times, heights = np.array(motion).T
rest = simulation.solve({"left": 0.02}).markers["left"][1]
off = float(abs(heights[-1] - rest))
settled = times[np.flatnonzero(np.abs(heights - rest) > 1e-3).max() + 1]
print(f"settled to 1 mm after {settled:.2f} s; {1e3 * off:.3f} mm off statics at the end")

# %%
# Height of the tip.
figure = Figure(figsize=(6, 3.5), layout="constrained")
axes = figure.add_subplot(xlabel="time [s]", ylabel="height of the left tip [mm]")
axes.plot(times, 1e3 * heights, label="motion")
axes.axhline(1e3 * rest, color="gray", linestyle="--", label="static equilibrium")
axes.legend()
