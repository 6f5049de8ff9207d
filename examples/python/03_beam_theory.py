"""
A bar against beam theory
=========================

At the end, you have the tip deflection of a clamped bar, and its deviation from Timoshenko beam theory.
"""

# %%
# A drawing of 200 mm by 20 mm, clamped on the left, in plane stress, with quadratic elements.
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

import hydrostat as hs

svg = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 20"><path d="M0 0 H200 V20 H0 Z"/></svg>'
toml = """
format = 1
name = "bar"
[body]
outline = "bar.svg"
size = "200 mm"
element_size = "10 mm"
thickness = "20 mm"
material = "polyester fibre"
elements = "quadratic"
plane = "stress"
[[pin]]
box = [[-101, -11], [-99, 11]]
stiffness = "1 MN/m"
[[marker]]
name = "tip"
at = [100, 0]
"""
with tempfile.TemporaryDirectory() as folder:
    (Path(folder) / "bar.svg").write_text(svg, encoding="utf-8")
    (Path(folder) / "robot.toml").write_text(toml, encoding="utf-8")
    robot = hs.load_robot(folder)

# %%
# A small force at the tip.
force, length, side = 1e-3, 0.2, 0.02
loaded = replace(robot, loads=(hs.Load(name="weight", marker="tip", force=(0.0, -force)),))
pose = hs.Simulation(loaded).solve([])
moved = float(robot.markers[0].at[1] - pose.markers["tip"][1])

# %%
# Timoshenko: F L³ / (3 E I) + F L / (5/6 G A).
young, poisson = robot.body.material.young, robot.body.material.poisson
shear = young / (2 * (1 + poisson))
beam = force * length**3 / (3 * young * side**4 / 12) + force * length / (5 / 6 * shear * side**2)
ratio = moved / beam
print(f"tip moves {1e3 * moved:.3f} mm, beam theory {1e3 * beam:.3f} mm, ratio {ratio:.3f}")

# %%
# A force 50 times as large bends it beyond the theory of small displacements.
heavy = replace(robot, loads=(hs.Load(name="weight", marker="tip", force=(0.0, -50 * force)),))
figure = hs.Simulation(heavy).solve(np.zeros(0)).plot()
