"""Flat and filled. Oracles: mirror symmetry (a pair pulls in the plane), statics in space by hand."""

import numpy as np
import pytest

from hydrostat.robot import Face, gallery_folder, inflated_robot, load_robot
from hydrostat.simulation import Simulation, filled_motion

ROBOT = load_robot(gallery_folder("starfish"))
PULLED = np.array([0.0, 0.02, 0.01])


@pytest.mark.parametrize(("face", "least", "most"), [("pairs", 0.0, 1e-3), ("middle", 0.0, 1e-3), ("front", 1e-2, 0.1)])
def test_pairs_keep_a_body_flat_and_one_face_curls_it(face: str, least: float, most: float, unchecked: None) -> None:
    found = filled_motion(ROBOT, [PULLED], face)
    assert least <= found.out <= most
    assert found.face is Face(face)


def test_the_most_of_all_poses_is_told(unchecked: None) -> None:
    found = filled_motion(ROBOT, [0.5 * PULLED, PULLED], "front")
    flat, solid = Simulation(ROBOT).solve(PULLED), Simulation(inflated_robot(ROBOT, "front")).solve(PULLED)
    assert found.out == pytest.approx(max(abs(place[2]) for place in solid.markers.values()))
    assert found.tension == pytest.approx(solid.tensions.max())
    moved = max(np.linalg.norm(flat.markers[marker.name] - marker.at) for marker in ROBOT.markers)
    assert found.moved == pytest.approx(moved)
    # Towards the side that is sewn, as a strip bends to the side of its cable.
    assert max(solid.markers.values(), key=lambda place: abs(place[2]))[2] > 0
