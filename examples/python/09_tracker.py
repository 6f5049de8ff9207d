"""
Track a moving target at 50 Hz
==============================

At the end, an arm follows a target that swings twice in four seconds: one pose for each update.
"""

# %%
# Each update takes one step toward the target. Winches are limited to 0.1 m/s.
import time

import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs

simulation = hs.Simulation(hs.load_robot("gallery:starfish"))
tracker = hs.Tracker(simulation, limits=hs.Limits(rate=0.1))
swing = np.sin(np.linspace(0.0, 2 * np.pi, 200)) ** 2
targets = np.array([-0.128, 0.041]) + swing[:, None] * [0.025, 0.011]
began = time.process_time()
updates = [tracker.update({"left": tuple(target)}, seconds=1 / 50) for target in targets]
print(f"{1e3 * (time.process_time() - began) / len(targets):.1f} ms an update")

# %%
# Error after the first second.
places = np.array([update.pose.markers["left"] for update in updates])
error = float(np.median(np.linalg.norm(places - targets, axis=1)[50:]))
print(f"median error {1e6 * error:.0f} µm")

# %%
# Target and tip.
figure = Figure(figsize=(6, 3.5), layout="constrained")
axes = figure.add_subplot(xlabel="time [s]", ylabel="height [mm]")
axes.plot(np.arange(200) / 50, 1e3 * targets[:, 1], color="gray", label="target")
axes.plot(np.arange(200) / 50, 1e3 * places[:, 1], ".", markersize=3, label="tip")
axes.legend()
