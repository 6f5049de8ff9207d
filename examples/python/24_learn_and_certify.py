"""
Sample, learn and certify
=========================

At the end, a small network solves inverse kinematics, and the simulator verifies its solution. Needs PyTorch
(``pip install -e ".[learn]"``).
"""

# %%
# Sample poses with exact Jacobians.
import tempfile
from pathlib import Path

import numpy as np

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
with tempfile.TemporaryDirectory() as folder:
    hs.learning.sample_robot(hs.learning.SamplePlan(robot=robot, count=100), Path(folder))
    samples = hs.learning.Samples.read(folder)
print(samples)

# %%
# Train the networks: half a minute here, minutes with the defaults.
options = hs.learning.LearnOptions(members=2, width=48, steps=600, inverse_steps=300)
model = hs.learning.learn_model(samples, options=options)

# %%
# Solve for a target. The network predicts its error; the simulator verifies it.
simulation = hs.Simulation(robot)
answer = model.solve({"left": (-0.105, 0.052)})
sure = hs.learning.verify(simulation, model, answer)
exact = hs.learning.verify(simulation, model, answer, steps=2)
pose = simulation.solve(exact.contractions)
left = float(np.linalg.norm(pose.markers["left"] - [-0.105, 0.052]))
print(f"network {1e3 * sure.certified['left']:.2f} mm off, after two exact steps {1e3 * left:.3f} mm")
figure = pose.plot()
