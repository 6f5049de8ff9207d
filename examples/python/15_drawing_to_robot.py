"""
From a drawing to a robot
=========================

At the end, a drawing is a meshed robot with a pin, a marker and a pose, ready for a design.
"""

# %%
# Overlapping shapes are one body.
import tempfile
from pathlib import Path

import hydrostat as hs

svg = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 260 270">
  <circle cx="130" cy="55" r="42"/>
  <rect x="15" y="92" width="230" height="38" rx="19"/>
  <rect x="92" y="80" width="76" height="120" rx="36"/>
  <rect x="94" y="150" width="38" height="110" rx="19" transform="rotate(18 113 160)"/>
  <rect x="128" y="150" width="38" height="110" rx="19" transform="rotate(-18 147 160)"/>
</svg>"""
with tempfile.TemporaryDirectory() as folder:
    drawing = Path(folder) / "gingerbread.svg"
    drawing.write_text(svg, encoding="utf-8")
    robot = hs.new_robot(drawing, size=0.24, thickness=0.04)

# %%
# Save it with ``hs.save_robot(robot, "gingerbread")`` and edit its robot.toml, or open it in the studio.
nodes = len(robot.body.mesh.nodes)
size = float(robot.body.mesh.size)
print(f"{nodes} nodes, {1e3 * size:.0f} mm, poses: {', '.join(robot.poses)}")
figure = hs.draw_rest(robot)
