"""What hides what in space, and what is under the pointer. Oracle: a cube, whose faces one can count."""

from pathlib import Path

import pytest
from numpy import cos, hypot, sin
from view_modules import needs_node, run

SCRIPT = """
import { Camera } from "./view/camera.js";
import { Cover } from "./view/cover.js";
import { pick, restOf } from "./view/pick.js";
const corners = [...Array(8).keys()].flatMap((i) => [(i & 1) - 0.5, ((i >> 1) & 1) - 0.5, (i >> 2) - 0.5]);
const nodes = new Float32Array(corners);
const quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
const faces = new Uint32Array(quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]));
const camera = new Camera();
camera.parallel = true;
camera.begin(false);
camera.resize(800, 500);
camera.look("front", 0);
camera.turn(1000);
camera.fit([nodes], [50, 50, 50, 50]);
const cover = new Cover(faces, 8);
const at = (...place) => { const s = camera.project(...place, [0, 0, 0]); return cover.layers(...s); };
const found = {};
cover.see(nodes, camera, null);
found.whole = { before: at(0.1, -2, 0.2), skin: at(0.1, -0.5, 0.2), inside: at(0.1, 0, 0.2) };
Object.assign(found.whole, { behind: at(0.1, 2, 0.2), beside: at(0.9, 2, 0.2) });
const cut = [0, -1, 0, 0.25]; // keeps y > -0.25
cover.see(nodes, camera, cut);
found.cut = { inside: at(0.1, 0, 0.2), behind: at(0.1, 2, 0.2) };
camera.azimuth = 0.4; camera.elevation = 0.3; camera.place();
cover.see(nodes, camera, null);
let length = 0;
cover.outline((ax, ay, bx, by) => (length += Math.hypot(bx - ax, by - ay)));
found.outline = length / camera.meter;
camera.azimuth = 0; camera.elevation = 0; camera.place();
const rest = nodes.map((value, i) => value + (i % 3 === 0 ? 3 : 0));
const spot = (...place) => camera.project(...place, [0, 0, 0]).slice(0, 2);
const [x, y] = spot(0.1, 0, 0.2);
const points = new Float32Array([0.1, 0, -0.5, 0.1, 0, 0.5]);
const view = { camera, nodes, rest, faces, cut: null, dots: [], lines: [], areas: [], points };
found.body = pick(view, x, y);
found.beside = pick(view, ...spot(1, 0, 1));
view.cut = cut;
found.section = pick(view, x, y);
view.lines = [{ key: "cable:0", first: 0, count: 2 }];
found.line = pick(view, x + 4, y);
view.dots = [
  { key: "marker:tip", look: "marker", x: x + 8, y, depth: 0, place: [0.1, 0, 0.2] },
  { key: "", look: "pin", x, y, depth: 0 },
];
found.dot = pick(view, x, y);
found.off = pick(view, x - 8, y).key;
found.rest = restOf([0.2, 0.1, 0], nodes, rest);
console.log(JSON.stringify(found));
"""


@needs_node
def test_cube(tmp_path: Path) -> None:
    found = run(tmp_path, SCRIPT)
    assert found["whole"] == {"before": 0, "skin": 0, "inside": 1, "behind": 2, "beside": 0}
    assert found["cut"] == {"inside": 0, "behind": 1}

    # six edges of a cube are its outline; each is as long as a turned unit vector looks
    x, y, z = hypot(cos(0.4), sin(0.4) * sin(0.3)), hypot(sin(0.4), cos(0.4) * sin(0.3)), cos(0.3)
    assert found["outline"] == pytest.approx(2 * (x + y + z), rel=1e-4)

    assert found["body"]["key"] == "body"
    assert found["body"]["world"] == pytest.approx([0.1, -0.5, 0.2], abs=1e-6)
    assert found["body"]["rest"] == pytest.approx([3.1, -0.5, 0.2], abs=1e-6)
    assert found["beside"]["key"] == ""
    assert found["beside"]["rest"] is None
    assert found["section"]["key"] == "body"
    assert found["section"]["world"] == pytest.approx([0.1, -0.25, 0.2], abs=1e-6)
    assert found["section"]["rest"] == pytest.approx([3.1, -0.25, 0.2], abs=1e-6)
    assert found["line"]["key"] == "cable:0"
    assert found["line"]["world"] == pytest.approx([0.1, 0.0, 0.2], abs=1e-6)
    assert found["dot"]["key"] == "marker:tip"
    assert found["off"] == "body"
    assert found["rest"] == pytest.approx([3.2, 0.1, 0.0], abs=1e-6)
