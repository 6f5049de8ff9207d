"""Tests of `BuildCost.of_robot`; the oracle is counting by hand."""

from dataclasses import replace

import numpy as np
import pytest

from hydrostat.design import BuildCost
from hydrostat.design.build_cost import front
from hydrostat.fabrication import ALL_MOTORS, CableWork
from hydrostat.robot import Cable, CableSide, Robot, gallery_folder, load_robot


@pytest.fixture(scope="module")
def starfish() -> Robot:
    return load_robot(gallery_folder("starfish"))


def sewn(robot: Robot, *routes: tuple[tuple[float, float], ...], sheathed: tuple[tuple[int, int], ...] = ()) -> Robot:
    """The robot with its first winch alone, and these cables [m]; the first of them sheathed at these segments."""
    winch = replace(robot.winches[0], name="w", at=routes[0][0])
    cables = [
        Cable(winch="w", points=points, sheathed=() if number else sheathed) for number, points in enumerate(routes)
    ]
    return robot.with_network((winch,), tuple(cables))


BENT = ((0.0, 0.0), (0.03, 0.0), (0.03, 0.01), (0.07, 0.01))  # two turns of 90 degrees, 80 mm


def test_counts_by_hand(starfish: Robot) -> None:
    found = BuildCost.of_robot(sewn(starfish, BENT, sheathed=((0, 1),)), [])
    assert (found.holes, found.sharp_turns, found.sheaths, found.crossings, found.motors) == (4, 2, 1, 0, 1)
    assert found.length == pytest.approx(0.08)
    assert found.minutes == pytest.approx(3 + 2.5 + 3 * 1.5 + 3 + 2)


def test_five_holes_are_stitched_in_ten_minutes(starfish: Robot) -> None:
    route = tuple((0.01 * step, 0.0) for step in range(6))
    assert CableWork.of_robot(sewn(starfish, route)).route == 10


def test_crossings_are_counted_but_not_beside_the_winch(starfish: Robot) -> None:
    over = ((0.0, 0.0), (0.04, -0.015), (0.04, 0.018))  # begins at the same winch, crosses the last segment of BENT
    assert BuildCost.of_robot(sewn(starfish, BENT, over), []).crossings == 1
    apart = ((0.0, 0.0), (0.02, -0.015), (0.04, -0.015))
    assert BuildCost.of_robot(sewn(starfish, BENT, apart), []).crossings == 0


def test_price_grows_by_the_line(starfish: Robot) -> None:
    short, long = ((0.0, 0.0), (0.03, 0.0)), ((0.0, 0.0), (0.06, 0.0))
    more = BuildCost.of_robot(sewn(starfish, long), []).price - BuildCost.of_robot(sewn(starfish, short), []).price
    assert more == pytest.approx(0.03 * 6.95 / 91.44)  # 6.95 USD for 91.44 m


@pytest.mark.parametrize("seed", range(5))
def test_the_front_is_what_nothing_dominates(seed: int) -> None:
    """Brute force over all pairs of whole numbers, of which many coincide in one or in both."""
    points = [(float(x), float(y)) for x, y in np.random.default_rng(seed).integers(0, 6, size=(14, 2))]
    found = [points[index] for index in front(points)]
    dominated = {
        (x, y) for x, y in points if any(left <= x and low <= y and (left, low) != (x, y) for left, low in points)
    }
    assert found == sorted(set(points) - dominated)


def test_no_front_of_nothing() -> None:
    assert front([]) == []


def test_nothing_takes_nothing(starfish: Robot) -> None:
    found = BuildCost.of_robot(starfish.with_network((), ()), [])
    assert set(found.as_values.values()) == {0, "", "sewing"}


def test_no_body_is_sewn_that_is_printed_or_cast(starfish: Robot) -> None:
    """Oracle: the minutes of the assembly sheets of printed and of cast bodies, which have no pairs."""
    flat = replace(sewn(starfish, BENT), face=CableSide.PAIRS)
    told = {}
    for material in ("polyester fibre", "tpu 85a", "flexfoam-it x"):
        found = BuildCost.of_robot(flat.with_material(material), [])
        told[material] = found.work, found.minutes, found.holes
    assert told == {
        "polyester fibre": ("sewing", 2 * (3 + 2.5 + 3 * 1.5), 8),
        "tpu 85a": ("threading", 3 + 5, 3),
        "flexfoam-it x": ("threading", 3 + 15, 3),
    }
    assert "10 min of sewing" not in str(found)
    assert "18 min of threading" in str(found)


def test_motors_are_those_of_the_table(starfish: Robot) -> None:
    found = BuildCost.of_robot(starfish, [])
    assert found.motor in {motor.key for motor in ALL_MOTORS}
    assert found.motors == len({cable.winch for cable in starfish.cables})
    assert np.isfinite(found.price)
    assert found.price > found.motors * min(motor.price for motor in ALL_MOTORS)
