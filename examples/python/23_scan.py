"""
From a scan to a robot
======================

At the end, a scan with a hole and flipped triangles is a closed, meshed body.
"""

# %%
# A scan of an ellipsoid: points and triangles, some of them missing and some flipped.
import tempfile
from pathlib import Path

import numpy as np

import hydrostat as hs

radii, rows, columns = np.array([0.06, 0.025, 0.025]), 24, 48
polar, around = np.meshgrid(np.linspace(0.01, np.pi - 0.01, rows), np.linspace(0, 2 * np.pi, columns, endpoint=False))
points = radii * np.stack([np.cos(polar), np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around)], axis=-1)
corner = np.arange(rows * columns).reshape(columns, rows)
right = np.roll(corner, -1, axis=0)
quads = [corner[:, :-1], right[:, :-1], right[:, 1:], corner[:, 1:]]
triangles = np.stack([quads[i] for i in (0, 1, 3, 3, 1, 2)], axis=-1).reshape(-1, 3)
random = np.random.default_rng(0)
triangles = triangles[random.permutation(len(triangles))[12:]]
triangles[:200] = triangles[:200, ::-1]

# %%
# Import repairs it: `robot.body.healing` lists the defects.
lines = ["OFF", f"{points.size // 3} {len(triangles)} 0"]
lines += [" ".join(f"{value:.6f}" for value in point) for point in points.reshape(-1, 3)]
lines += [" ".join(map(str, [3, *triangle])) for triangle in triangles]
with tempfile.TemporaryDirectory() as folder:
    scan = Path(folder) / "ellipsoid.off"
    scan.write_text("\n".join(lines), encoding="utf-8")
    robot = hs.new_robot(scan, size=0.12)
print(*robot.body.healing.lines(), sep="\n")

# %%
# Compare with the volume of the ellipsoid.
true = 4 / 3 * np.pi * float(radii.prod())
volume = float(robot.body.mesh.volumes.sum())
print(f"{1e6 * volume:.1f} mL, ellipsoid {1e6 * true:.1f} mL")
figure = hs.draw_rest(robot)
