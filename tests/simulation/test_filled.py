"""Flat and filled. Oracles: mirror symmetry (a pair pulls in the plane), statics in space by hand."""

from dataclasses import replace

import numpy as np
import pytest

from hydrostat.robot import CableSide, gallery_folder, inflated_robot, load_robot
from hydrostat.simulation import Simulation, solve_stuffed_motion

ROBOT = load_robot(gallery_folder("starfish"))
PULLED = np.array([0.0, 0.02, 0.01])


@pytest.mark.parametrize("face", ["pairs", "middle"])
def test_cables_on_both_faces_or_between_them_keep_a_body_flat(face: str, unchecked: None) -> None:
    found = solve_stuffed_motion(ROBOT, [PULLED], face)
    assert 0.0 <= found.out <= 1e-3
    assert found.face is CableSide(face)
    assert found.warning is None
    assert "The flat model does not hold" in (replace(found, out=0.3 * found.moved).warning or "")


def test_one_face_curls_it_and_the_most_of_all_poses_is_told(unchecked: None) -> None:
    found = solve_stuffed_motion(ROBOT, [0.5 * PULLED, PULLED], "front")
    assert 1e-2 <= found.out <= 0.1
    assert found.face is CableSide.FRONT
    assert f"cables on the front: they bend the stuffed body {1e3 * found.out:.0f} mm out" in (found.warning or "")
    assert replace(found, out=0.2 * found.moved).warning is None
    flat, solid = Simulation(ROBOT).solve(PULLED), Simulation(inflated_robot(ROBOT, "front")).solve(PULLED)
    assert found.out == pytest.approx(max(abs(place[2]) for place in solid.markers.values()))
    assert found.tension == pytest.approx(solid.tensions.max())
    moved = max(np.linalg.norm(flat.markers[marker.name] - marker.at) for marker in ROBOT.markers)
    assert found.moved == pytest.approx(moved)
    # Towards the side that is sewn, as a strip bends to the side of its cable.
    assert max(solid.markers.values(), key=lambda place: abs(place[2]))[2] > 0
