"""
Several equilibria and snap-through
===================================

At the end you know whether a starfish can rest in more than one pose at the same contractions.
"""

# %%
# Bring it there along several loading paths.
import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs

simulation = hs.Simulation(hs.load_robot("gallery:starfish"))
goal = {"left": 0.06, "right": 0.06, "feet": 0.06}
found = hs.find_equilibria(simulation, goal, count=4)
print(*found.lines(), sep="\n")

# %%
# Follow the branch of equilibria past its folds; `share` is the part of the contractions.
branch = hs.continue_branch(simulation, simulation.rest, found.contractions, around_folds=True)
shares = np.array([point.share for point in branch.points])
folds = len(branch.folds)
print(*branch.lines(), sep="\n")

# %%
# Where the curve turns back, the robot snaps.
figure = Figure(figsize=(5, 4), layout="constrained")
axes = figure.add_subplot(xlabel="share of the contractions", ylabel="height of the top tip [mm]")
axes.plot(shares, [1e3 * point.pose.markers["top"][1] for point in branch.points], ".-", markersize=3)
