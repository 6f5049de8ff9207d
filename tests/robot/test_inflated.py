"""Filled bodies. Oracles: the volume of an ellipse, mirror symmetry, the skin itself."""

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.errors import InputError
from hydrostat.robot import CableSide, Robot, gallery_folder, inflated_robot, load_robot


@pytest.fixture(scope="module")
def starfish() -> Robot:
    return load_robot(gallery_folder("starfish"))


@pytest.fixture(scope="module")
def pairs(starfish: Robot) -> Robot:
    return inflated_robot(starfish, "pairs")


def test_a_pair_is_two_cables_of_one_winch_on_mirrored_ways(starfish: Robot, pairs: Robot) -> None:
    assert len(pairs.cables) == 2 * len(starfish.cables)
    assert len(pairs.winches) == len(starfish.winches)
    for cable in starfish.cables:
        front, back = (np.array(pairs.cable(f"{cable.name} {side}").points) for side in ("front", "back"))
        np.testing.assert_allclose(front[:, :2], cable.points)
        np.testing.assert_allclose(back[:, :2], cable.points)
        assert front[0, 2] == back[0, 2] == 0.0
        assert (front[1:, 2] > 0).all()
        # The mesh is not mirrored, so the skins are so to a share of an element only.
        np.testing.assert_allclose(back[1:, 2], -front[1:, 2], atol=1.5e-3)


def test_cables_lie_on_the_skin(pairs: Robot) -> None:
    points = np.concatenate([np.array(cable.points)[1:] for cable in pairs.cables])
    out = np.sign(points[:, 2:]) * np.array([[0.0, 0.0, 1e-4]])
    assert (pairs.body.distances(points) == 0).all()
    assert (pairs.body.distances(points + out) > 0).all()


@pytest.mark.parametrize(("face", "least", "most"), [("back", -1.0, -0.002), ("middle", 0.0, 0.0)])
def test_each_face_has_its_side(starfish: Robot, face: str, least: float, most: float) -> None:
    filled = inflated_robot(starfish, CableSide(face))
    heights = np.concatenate([np.array(cable.points)[1:, 2] for cable in filled.cables])
    assert least <= heights.min()
    assert heights.max() <= most
    assert filled.poses["wave"].targets["top"] == (*starfish.poses["wave"].targets["top"], 0.0)


def test_a_pin_holds_the_body_all_through(pairs: Robot) -> None:
    nodes = pairs.body.mesh.nodes
    (pin,) = pairs.pins
    held = nodes[pin.holds(pairs.body.mesh)]
    assert np.ptp(held[:, 2]) > 0.8 * np.ptp(nodes[:, 2])


def test_only_what_was_drawn_can_be_filled(pairs: Robot) -> None:
    for robot in (strip_robot(), pairs):
        with pytest.raises(InputError, match="only a flat robot with a drawing can be inflated"):
            inflated_robot(robot)
