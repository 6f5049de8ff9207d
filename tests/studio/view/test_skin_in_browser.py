"""The smooth rim and the seam of flat bodies in the browser. Oracles: the nodes, shapely, a moved body."""

import json
from pathlib import Path

import numpy as np
import shapely
from builders import gallery_robot
from view_modules import needs_node, run

SCRIPT = """
import { readFileSync } from "node:fs";
import { Skin, within } from "./view/skin.js";
const { rim, rest, faces, moved } = JSON.parse(readFileSync(given[0]));
const skin = new Skin(new Uint32Array(rim), new Float32Array(rest), new Uint32Array(faces));
const rings = (part, nodes) => part.at(new Float32Array(nodes)).map((ring) => [...ring]);
console.log(JSON.stringify({
  loops: skin.loops, rim: rings(skin.rim, rest), seam: rings(skin.seam, rest),
  movedRim: rings(skin.rim, moved), movedSeam: rings(skin.seam, moved),
  inside: within(rest[0], rest[1], rest, faces) !== null, beside: within(9, 9, rest, faces),
}));
"""


def rings(found: list[list[float]]) -> list[np.ndarray]:
    return [np.array(ring).reshape(-1, 2) for ring in found]


@needs_node
def test_rim_goes_through_its_nodes_and_the_seam_lies_inside(tmp_path: Path) -> None:
    mesh = gallery_robot("starfish").body.mesh
    rest = np.c_[mesh.nodes, np.zeros(len(mesh.nodes))]
    slope = np.array([[1.2, 0.3, 0.0], [-0.4, 0.9, 0.0], [0.0, 0.0, 1.0]])
    shift = np.array([0.01, -0.02, 0.0])
    given = {
        "rim": mesh.boundary.ravel().tolist(),
        "rest": rest.ravel().tolist(),
        "faces": mesh.elements.ravel().tolist(),
        "moved": (rest @ slope.T + shift).ravel().tolist(),
    }
    file = tmp_path / "body.json"
    file.write_text(json.dumps(given))
    found = run(tmp_path, SCRIPT, file)

    assert found["inside"]
    assert found["beside"] is None
    assert sorted(np.concatenate(found["loops"]).tolist()) == np.unique(mesh.boundary).tolist()
    (rim,), (seam,) = rings(found["rim"]), rings(found["seam"])
    assert np.allclose(rim[::4], mesh.nodes[found["loops"][0]], atol=1e-7)

    drawn = shapely.union_all(shapely.polygons(mesh.nodes[mesh.elements]))
    smooth = shapely.Polygon(rim)
    assert smooth.is_valid
    assert smooth.area > 0
    assert smooth.exterior.is_ccw
    assert drawn.hausdorff_distance(smooth) < 0.2 * np.diff(mesh.nodes[mesh.boundary], axis=1).max()
    size = np.ptp(mesh.nodes, axis=0).max()
    away = shapely.distance(smooth.exterior, shapely.points(seam))
    assert np.allclose(away, 0.016 * size, rtol=0.07)
    assert smooth.contains(shapely.Polygon(seam))

    # both hang on the nodes with weights of sum one: any affine motion of these moves them alike
    for still, moved in zip(
        rings(found["rim"] + found["seam"]), rings(found["movedRim"] + found["movedSeam"]), strict=True
    ):
        assert np.allclose(moved, still @ slope[:2, :2].T + shift[:2], atol=1e-6)
