"""
Gradients by PyTorch
====================

At the end, PyTorch has found the modulus of a body from one pose, by gradients through the equilibrium. Needs PyTorch
(``pip install -e ".[learn]"``).
"""

# %%
# The measured pose is of a robot under its weight, 30 % stiffer than assumed.
from dataclasses import replace

import torch

import hydrostat as hs
from hydrostat.simulation import solve_torch

robot = replace(hs.load_robot("gallery:starfish"), gravity=(0.0, -9.81))
assumed = robot.body.material.young
true = 1.3 * assumed
measured = torch.tensor(hs.Simulation(robot.with_material(young=true)).solve({"left": 0.01}).nodes)

# %%
# LBFGS minimizes the distance of all nodes.
simulation = hs.Simulation(robot)
contractions = torch.tensor([0.0, 0.01, 0.0], dtype=torch.float64)
scale = torch.tensor(1.0, dtype=torch.float64, requires_grad=True)
optimizer = torch.optim.LBFGS([scale], lr=1.0, max_iter=20, line_search_fn="strong_wolfe", tolerance_grad=1e-12)


def closure():
    """Return the squared distance [mm^2] and set its gradient."""
    optimizer.zero_grad()
    pose = solve_torch(simulation, contractions, young=assumed * scale)
    loss = 1e6 * (pose.nodes - measured).square().sum()
    loss.backward()
    return loss


optimizer.step(closure)
young = assumed * scale.item()
print(f"modulus {young / 1e3:.2f} kPa, true {true / 1e3:.2f} kPa, assumed {assumed / 1e3:.2f} kPa")
figure = hs.Simulation(robot.with_material(young=young)).solve({"left": 0.01}).plot()
