"""
Workspace of an arm
===================

At the end, you have the region that the left arm of a starfish reaches, from 400 equilibria.
"""

# %%
# Draw random contractions of all winches between 0 and full travel, and solve them in one call.
import numpy as np
from matplotlib.figure import Figure
from scipy.spatial import ConvexHull

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
simulation = hs.Simulation(robot)
travel = np.array([winch.travel for winch in robot.winches])
contractions = np.random.default_rng(0).random((400, len(travel))) * travel
batch = simulation.solve_batch(contractions, jacobians=False)

# %%
# The hull of the tip positions is the workspace.
names = [marker.name for marker in robot.markers]
places = 1e3 * batch.markers[:, names.index("left")]
area = float(ConvexHull(places).volume) / 100.0
print(f"workspace of the left arm: {area:.1f} cm²")

# %%
# Color shows the contraction of the left winch.
figure = Figure(figsize=(6, 2.6), layout="constrained")
axes = figure.add_subplot(xlabel="x [mm]", ylabel="y [mm]", aspect="equal", title="Workspace of the left arm")
left = [winch.name for winch in robot.winches].index("left")
dots = axes.scatter(places[:, 0], places[:, 1], c=1e3 * contractions[:, left], s=8)
figure.colorbar(dots, label="contraction of\nwinch left [mm]", shrink=0.8)
