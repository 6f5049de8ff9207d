"""
Several equilibria and snap-through
===================================

At the end, you know whether a starfish has more than one stable pose at the same contractions.
"""

# %%
# Follow the branch of equilibria from rest to full travel, past its folds.
import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs

simulation = hs.Simulation(hs.load_robot("gallery:starfish"))
full = {"left": 0.06, "right": 0.06, "feet": 0.06}
branch = hs.continue_branch(simulation, simulation.rest, full, around_folds=True)
folds = len(branch.folds)
print(*branch.lines(), sep="\n")

# %%
# Between the folds, two poses are stable. Several loading paths find both.
found = hs.find_equilibria(simulation, {winch: 0.93 * travel for winch, travel in full.items()}, count=6)
stable = len(found.poses)
print(*found.lines(), sep="\n")

# %%
# Where the curve turns back, the robot snaps through.
shares = np.array([point.share for point in branch.points])
heights = np.array([1e3 * point.pose.markers["right"][1] for point in branch.points])
near = shares > 0.88
figure = Figure(figsize=(5, 4), layout="constrained")
axes = figure.add_subplot(xlabel="share of full travel", ylabel="height of the right tip [mm]")
axes.plot(shares[near], heights[near], ".-", markersize=3)
axes.axvline(0.93, color="gray", linestyle="--")
