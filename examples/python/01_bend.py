"""
Bend a starfish with one winch
==============================

At the end, you have the static equilibrium of a starfish whose left winch takes in 12 mm of cable, its picture, and how
far the tip of its arm moved.
"""

# %%
# A robot is data: body, pins, winches, cables, markers. Yours is a folder: ``hs.load_robot("my_robot")``.
import numpy as np

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
simulation = hs.Simulation(robot)

# %%
# Solve for the equilibrium. Contractions are lengths of cable taken in [m].
pose = simulation.solve({"left": 0.012})
rest = next(marker.at for marker in robot.markers if marker.name == "left")
travel = float(np.linalg.norm(pose.markers["left"] - rest))
print(f"left arm moves {1e3 * travel:.1f} mm, {pose.result.status}")

# %%
# Draw it. In a notebook ``pose`` alone shows the picture.
figure = pose.plot()
