"""
Fit a robot to measurements
===========================

At the end, you have the modulus of a simulated twin, fitted to measured markers, with its confidence interval.
"""

# %%
# The twin is 1.6 times as stiff. Masses hung from the left tip determine this; cable lengths alone do not.
from dataclasses import replace

import numpy as np

import hydrostat as hs

robot = replace(hs.load_robot("gallery:starfish"), gravity=(0.0, -9.81))
true = 1.6 * robot.body.material.young
hidden = robot.with_material(young=true)
random = np.random.default_rng(1)
names = tuple(marker.name for marker in robot.markers)
commands = random.uniform(0.0, 0.015, (8, len(robot.winches)))
masses = np.zeros((8, len(names)))
masses[:, names.index("left")] = np.linspace(0.0, 0.03, 8)

# %%
# Measured positions have an error of 0.3 mm.
places = np.zeros((8, len(names), 2))
for row, (command, mass) in enumerate(zip(commands, masses[:, names.index("left")], strict=True)):
    loads = (hs.Load(name="cup", marker="left", mass=float(mass)),) if mass else ()
    pose = hs.Simulation(replace(hidden, loads=loads)).solve(command)
    places[row] = [pose.markers[name] for name in names]
places += 3e-4 * random.standard_normal(places.shape)

# %%
# Fit the modulus. `found.robot` is the fitted robot.
measured = hs.Measurements(commands=commands, markers=names, places=places, masses=masses)
found = hs.identify(robot, measured, fit=("young",))
young = found.robot.body.material.young
print(f"modulus {young / 1e3:.1f} kPa, hidden {true / 1e3:.1f} kPa, assumed {robot.body.material.young / 1e3:.1f} kPa")
figure = hs.Simulation(found.robot).solve(commands[-1]).plot()
