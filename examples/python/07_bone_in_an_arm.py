"""
A bone in an arm
================

At the end, one arm of a starfish has a rigid bone, and bends less than before.
"""

# %%
# A part is a region with its own material, or a rigid one with a density. The mesh conforms to it.
from dataclasses import replace

import numpy as np

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
bone = hs.BodyPart(name="bone", shape="capsule", at=(-0.06, 0.018), to=(-0.1, 0.034), radius=0.006, density=1200.0)
stiff = replace(robot, body=robot.body.with_parts((bone,)))

# %%
# The same contraction of the left winch.
rest = np.array(next(marker.at for marker in robot.markers if marker.name == "left"))
soft_pose, stiff_pose = (hs.Simulation(each).solve({"left": 0.012}) for each in (robot, stiff))
soft, with_bone = (float(np.linalg.norm(pose.markers["left"] - rest)) for pose in (soft_pose, stiff_pose))
print(f"tip moves {1e3 * soft:.1f} mm, with the bone {1e3 * with_bone:.1f} mm")

# %%
# Distances within the rigid part do not change.
start, end = np.array(bone.at), np.array(bone.to)
along = (stiff.body.mesh.nodes - start) @ (end - start) / np.sum((end - start) ** 2)
axis = start + np.clip(along, 0.0, 1.0)[:, None] * (end - start)
inside = np.flatnonzero(np.linalg.norm(stiff.body.mesh.nodes - axis, axis=1) < 0.0061)
pair = inside[[along[inside].argmin(), along[inside].argmax()]]
before, after = (
    float(np.linalg.norm(np.diff(nodes[pair], axis=0))) for nodes in (stiff.body.mesh.nodes, stiff_pose.nodes)
)
strain = abs(after / before - 1)
print(f"the bone of {1e3 * before:.1f} mm changes by {100 * strain:.3f} % of its length")
figure = stiff_pose.plot()
