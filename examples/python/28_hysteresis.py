"""
Hysteresis of a filling
=======================

At the end, you have the hysteresis loop of a stuffed arm, and the bend that the arm keeps when you release it.
"""

# %%
# `with_hysteresis` adds the assumed sliders of polyester fiber to the material.
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs

plain = hs.load_robot("gallery:starfish")
body = replace(plain.body, material=plain.body.material.with_hysteresis())
robot = replace(plain, body=body)

# %%
# Pull and release in small steps. Each solve starts from the previous pose, because the pose depends on its history.
steps = np.linspace(0.0, 0.03, 11)
pulled_and_released = np.concatenate([steps, steps[-2::-1]])
cable = next(i for i, cable in enumerate(robot.cables) if cable.winch == "left")


def pull_and_release(simulation):
    """Return the tension [N] and the place of the tip [m] at each step."""
    pose, tensions, tips = simulation.rest, [], []
    for contraction in pulled_and_released:
        pose = simulation.solve({"left": float(contraction)}, start=pose)
        tensions.append(pose.tensions[cable])
        tips.append(pose.markers["left"])
    return np.array(tensions), np.array(tips)


tensions, tips = pull_and_release(hs.Simulation(robot))
without, elastic_tips = pull_and_release(hs.Simulation(plain))

# %%
# The area of the loop is the work lost in the filling. The arm does not return to its rest position.
work = (tensions[1:] + tensions[:-1]) / 2 * np.diff(pulled_and_released)
moves = 1e3 * np.linalg.norm(tips - tips[0], axis=1)
print(f"{work.sum() / work[:10].sum():.0%} of the work is lost; the tip keeps {moves[-1]:.1f} of {moves.max():.1f} mm")

# %%
# The loop, and the tension without hysteresis.
figure = Figure(figsize=(5, 4), layout="constrained")
axes = figure.add_subplot(xlabel="contraction of winch left [mm]", ylabel="tension [N]")
axes.plot(1e3 * steps, tensions[:11], ".-", label="loading")
axes.plot(1e3 * steps[::-1], tensions[10:], ".-", label="unloading")
axes.plot(1e3 * steps, without[:11], "k:", label="without hysteresis")
axes.legend()
