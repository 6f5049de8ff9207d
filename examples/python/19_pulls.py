"""
Tensions instead of contractions
================================

At the end, you know the stiffness curve of an arm: the cable tension for each contraction, and the pose for a
given tension.
"""

# %%
# Tensions at given contractions.
import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
simulation = hs.Simulation(robot)
right = [winch.name for winch in robot.winches].index("right")
cable = next(i for i, cable in enumerate(robot.cables) if cable.winch == "right")
contractions = np.linspace(0.0, 0.03, 13)
poses = [simulation.solve({"right": float(contraction)}) for contraction in contractions]
tensions = np.array([pose.tensions[cable] for pose in poses])

# %%
# Find the pose in which the winch pulls with 3 N.
pulled = hs.solve_pulls(simulation, {"right": 3.0})
taken = float(pulled.contractions[right])
print(f"3 N take in {1e3 * taken:.1f} mm")
error = float(abs(np.interp(taken, contractions, tensions) - 3.0))

# %%
# The curve.
figure = Figure(figsize=(5, 4), layout="constrained")
axes = figure.add_subplot(xlabel="contraction of winch right [mm]", ylabel="tension [N]")
axes.plot(1e3 * contractions, tensions, ".-")
axes.plot(1e3 * taken, 3.0, "o", label="3 N")
axes.legend()
