"""Mirror lines of drawings. Oracle: penguins drawn as mirror images, with one wing moved or without."""

import numpy as np
import pytest

from hydrostat.robot import MIRROR_TOLERANCE, Robot, find_mirror, measure_asymmetry, sketch_robot
from hydrostat.robot.mirror import mirror_points

WING = "C62 -42 86 -24 106 18 C96 28 76 8 56 4"
OTHER = "C-76 8 -96 28 -106 18 C-86 -24 -62 -42 -31 -42"


def penguin(*, wing: str = WING) -> Robot:
    """A body with a round bottom, a head, and two wings."""
    head, belly = "M0 -100 C25 -100 37 -80 31 -42", "C62 40 60 90 42 114 C30 124 -30 124 -42 114 C-60 90 -62 40 -56 4"
    size, end = 'width="300mm" viewBox="-150 -150 300 300"', "C-37 -80 -25 -100 0 -100 Z"
    drawing = f'<svg xmlns="http://www.w3.org/2000/svg" {size}><path d="{head} {wing} {belly} {OTHER} {end}"/></svg>'
    return sketch_robot(drawing.encode(), file="penguin.svg", name="penguin")


def test_a_mirrored_drawing_gets_a_mirrored_robot() -> None:
    """Markers and targets are on the mirror line or in pairs, the pin is on it, and a pair of wings bends."""
    robot = penguin()
    assert find_mirror(robot.body) == 0
    assert measure_asymmetry(robot.body, 0) < 1e-4
    flip = np.array([-1.0, 1.0])
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    assert {"top", "bottom", "left", "right"} <= places.keys()
    twins = {"left": "right", "right": "left"}
    targets = robot.pose("bend").targets
    for name, at in places.items():
        np.testing.assert_array_equal(places[twins.get(name, name)], at * flip)
        np.testing.assert_array_equal(targets[twins.get(name, name)], np.array(targets[name]) * flip)
    assert robot.pins[0].at is not None
    assert robot.pins[0].at[0] == 0
    moved = {name for name in places if np.linalg.norm(places[name] - targets[name]) > 0.01}
    assert moved == {"left", "right"}


def test_halves_that_differ_are_no_mirror_images() -> None:
    """Oracle: a wing that is 14 mm longer, above the tolerance of a fiftieth of the body's size."""
    robot = penguin(wing=WING.replace("106 18", "120 18"))
    assert MIRROR_TOLERANCE * robot.body.mesh.size < 0.007
    assert find_mirror(robot.body) is None


@pytest.mark.parametrize(
    ("points", "found", "twins"),
    [
        ([[0.1, 0.0], [-0.104, 0.002]], [[0.102, 0.001], [-0.102, 0.001]], [1, 0]),
        ([[0.01, 0.2], [0.3, 0.2]], [[0.0, 0.2], [0.3, 0.2], [-0.3, 0.2]], [0, 2, 1]),
        ([[0.01, -0.2], [0.3, 0.2]], [[0.01, -0.2], [0.3, 0.2], [-0.01, -0.2], [-0.3, 0.2]], [2, 3, 0, 1]),
        ([[0.3, 0.2]], [[0.3, 0.2]], [0]),
    ],
    ids=["pair", "on the line", "cleft", "alone"],
)
def test_points_go_to_the_line_or_into_pairs(
    points: list[list[float]], found: list[list[float]], twins: list[int]
) -> None:
    """Oracle: places by hand; the body is above y = 0 on the line."""
    made, numbers = mirror_points(np.array(points), 0, near=0.02, holds=lambda place: place[1] > 0)
    np.testing.assert_allclose(made, found, atol=1e-12)
    assert numbers.tolist() == twins
