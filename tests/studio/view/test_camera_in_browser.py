"""Cameras of the view. Oracle: what goes to the screen and comes back is where it was; views as in Blender."""

from pathlib import Path

import pytest
from view_modules import needs_node, run

SCRIPT = """
import { Camera } from "./view/camera.js";
const camera = new Camera();
camera.resize(800, 500);
const box = new Float32Array([-0.1, -0.02, 0, 0.1, -0.02, 0, 0.1, 0.02, 0.3, -0.1, 0.02, 0.3]);
const corners = () => [0, 3, 6, 9].map((i) => camera.project(box[i], box[i + 1], box[i + 2], [0, 0, 0]).slice());
const found = { round: [], views: {}, fits: [], kept: [] };
for (const [flat, parallel] of [[true, false], [false, true], [false, false]]) {
  camera.parallel = parallel;
  camera.begin(flat);
  camera.fit([box], [80, 40, 40, 60]);
  if (!flat) camera.orbit(37, -12);
  camera.fit([box], [80, 40, 40, 60]);
  found.fits.push(corners());
  const point = [0.03, 0.01, flat ? 0 : 0.12];
  const [x, y] = camera.project(...point, [0, 0, 0]);
  found.round.push(Math.hypot(...camera.facing(x, y, point).map((value, k) => value - point[k])));
  const before = camera.facing(700, 100, camera.target.toArray());
  camera.zoom(700, 100, 0.6);
  const after = camera.project(...before, [0, 0, 0]);
  found.kept.push(Math.hypot(after[0] - 700, after[1] - 100));
}
for (const name of ["front", "side", "top"]) {
  camera.look(name, 0);
  const halfway = camera.turn(110);
  const more = camera.turn(1000);
  found.views[name] = { toward: camera.toward.toArray(), up: camera.up.toArray(), halfway, more };
}
console.log(JSON.stringify(found));
"""


@needs_node
def test_camera(tmp_path: Path) -> None:
    found = run(tmp_path, SCRIPT)
    assert max(found["round"]) < 1e-12
    assert max(found["kept"]) < 1e-6
    for corners in found["fits"]:
        for x, y, depth in corners:
            assert 79 <= x <= 761
            assert 39 <= y <= 441
            assert -1 < depth < 1
    views = {"front": ((0, -1, 0), (0, 0, 1)), "side": ((1, 0, 0), (0, 0, 1)), "top": ((0, 0, 1), (0, 1, 0))}
    for name, (toward, up) in views.items():
        seen = found["views"][name]
        assert seen["toward"] == pytest.approx(toward, abs=1e-12)
        assert seen["up"] == pytest.approx(up, abs=1e-12)
        assert seen["halfway"]
        assert not seen["more"]
