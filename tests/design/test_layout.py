"""Layouts as numbers. Oracles: there and back, finite differences, mirror images, the robot that they came from."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design.constraints import Constraints
from hydrostat.design.routes.begin import add_mirror_image, layout_of, reflect_points
from hydrostat.design.routes.growth import without
from hydrostat.design.routes.layout import CableRoute, Layout, WinchSite
from hydrostat.robot import Mount, Winch, limit_travels

LOOSE = Constraints(slack=0.01, spool_ratio=2.0)
OFF = ((0.05, 0.018), (0.09, 0.017), (0.13, 0.018))


def layout(constraints: Constraints = LOOSE, **made: Any) -> Layout:
    return layout_of(strip_robot(**made), constraints)


def one_cable(*, at: tuple[float, float], mount: Mount = Mount.BODY, **limits: Any) -> Layout:
    """A mirrored design with its first cable."""
    constraints = Constraints(mirror="y", **limits)
    winch = Winch(name="winch_1", at=at, mount=mount)
    line = CableRoute(0, np.array([at, *OFF]), lead=1, slack=0.002, ratio=1.2)
    return Layout(strip_robot(), constraints, (WinchSite(winch),), (line,))


def test_the_robot_of_a_layout_is_the_one_it_came_from() -> None:
    makes: tuple[dict[str, Any], ...] = (
        {},
        {"sheathed": ((0, 2),)},
        {"slack": 0.003},
        {"stiffness": 1e3},
        {"mount": Mount.WORLD},
    )
    for made in makes:
        robot = strip_robot(**made)
        again = layout_of(robot, LOOSE).robot()
        assert again.winches == robot.winches
        assert again.cables == robot.cables


@pytest.mark.parametrize("radius", [None, 0.009])
def test_a_reversed_cable_stays_reversed(radius: float | None) -> None:
    robot = strip_robot()
    cables = (robot.cables[0], replace(robot.cables[1], reverse=True, spool_radius=radius))
    robot = robot.with_network(robot.winches, cables)
    assert layout_of(robot, LOOSE).robot().cables == robot.cables


def test_numbers_there_and_back() -> None:
    start = layout()
    numbers = start.numbers + np.random.default_rng(0).uniform(0.0, 1e-3, start.size)
    moved = start.at(numbers)
    assert np.array_equal(moved.numbers, numbers)
    for index, line in enumerate(moved.routes):
        assert np.array_equal(line.points[0], moved.sites[line.winch].winch.at)
        for point in range(len(line.points)):
            assert np.array_equal(numbers[moved.place_of(index, point)], line.points[point])


def test_winches_pay_out_as_far_as_reversed_cables_need() -> None:
    start = layout(Constraints(two_way=True, release=0.01))
    turned = replace(start, routes=(replace(start.routes[0], ratio=-1.0), start.routes[1])).turn_winches()
    assert [site.winch.release for site in turned.sites] == [turned.constraints.travel, 0.0]
    assert [cable.reverse for cable in turned.robot().cables] == [True, False]
    back = replace(turned, routes=start.routes).turn_winches()
    assert back.sites[0].winch.release == 0.01
    for ratio in (-9.0, -0.1, 0.5):  # the way of a cable is no number that is moved
        numbers = turned.numbers.copy()
        numbers[turned.starts[-1]] = ratio
        assert turned.at(numbers).routes[0].ratio == pytest.approx(np.clip(ratio, -4.0, -0.25))


def test_slack_is_never_negative() -> None:
    start = layout()
    numbers = start.numbers.copy()
    numbers[start.starts[-2]] = -1e-3
    assert start.at(numbers).routes[0].slack == 0.0


def test_coordinates_are_rounded() -> None:
    start = layout()
    robot = start.at(start.numbers + 1.23456789e-4).robot(digits=5)
    values = np.concatenate([np.ravel(cable.points) for cable in robot.cables])
    assert np.array_equal(values, np.round(values, 5))
    assert all(cable.points[0] == robot.winch(cable.winch).at for cable in robot.cables)


def test_what_stays_has_no_number() -> None:
    usual = layout(Constraints())
    count = 2 * 2 + 2 * 2 * 6
    assert usual.ties.shape == (usual.size, count)
    assert layout().ties.shape[1] == count + 2 + 2
    assert layout(Constraints(locked_winches=("up",))).ties.shape[1] == count - 2
    assert layout(Constraints(locked_cables=("up 1",))).ties.shape[1] == count - 2 - 12
    assert layout(Constraints(), mount=Mount.WORLD).ties.shape[1] == count - 2


def test_a_cable_sheathed_in_the_middle_stays_with_its_winch() -> None:
    start = layout(Constraints(), sheathed=((2, 4),))
    moved = start.at(start.numbers + start.ties @ np.full(start.ties.shape[1], 1e-3)).robot()
    assert moved.cables[0] == start.source.cables[0]
    assert moved.winches[0] == start.source.winches[0]
    assert moved.winches[1] != start.source.winches[1]


def assert_symmetric(found: Layout) -> None:
    for index, line in enumerate(found.routes):
        if line.twin is not None:
            twin = found.routes[line.twin]
            assert reflect_points(found, twin.points) == pytest.approx(line.points, abs=1e-15)
            assert (line.slack, line.ratio, line.lead) == (twin.slack, twin.ratio, twin.lead)
            assert np.array_equal(line.points[0], found.sites[found.routes[index].winch].winch.at)


@pytest.mark.parametrize("at", [(0.02, 0.012), (0.02, 0.004)])
def test_mirrored_parts_follow_their_twins(at: tuple[float, float]) -> None:
    """Beside the mirror there are two winches; near it there is one, which stays in it."""
    both = add_mirror_image(one_cable(at=at, winch_gap=0.02, slack=0.01, spool_ratio=2.0))
    assert len(both.sites) == (2 if at[1] > 0.01 else 1)
    assert len(both.routes) == 2
    assert_symmetric(both)
    free = both.ties.shape[1]
    assert free == (2 if at[1] > 0.01 else 1) + 2 * 3 + 2
    assert np.linalg.matrix_rank(both.ties) == free
    moved = both.at(both.numbers + both.ties @ np.random.default_rng(1).uniform(0.0, 1e-3, free))
    assert_symmetric(moved)
    assert not np.allclose(moved.routes[0].points, both.routes[0].points)
    if len(both.sites) == 1:
        assert moved.sites[0].winch.at[1] == 0.0


def test_a_second_pair_hangs_on_the_same_winches() -> None:
    one = add_mirror_image(one_cable(at=(0.02, 0.012), winch_gap=0.02))
    line = CableRoute(1, np.array([one.sites[1].winch.at, (0.06, -0.008), (0.1, -0.009)]))
    two = add_mirror_image(replace(one, routes=(*one.routes, line)))
    assert [line.winch for line in two.routes] == [0, 1, 1, 0]
    assert [line.twin for line in two.routes] == [None, 0, None, 2]
    assert_symmetric(two)
    free = two.ties.shape[1]
    moved = two.at(two.numbers + two.ties @ np.random.default_rng(2).uniform(0.0, 1e-3, free))
    assert_symmetric(moved)


def test_a_symmetric_robot_is_tied_together() -> None:
    """As its own network is improved, a symmetric one stays so."""
    made = add_mirror_image(one_cable(at=(0.02, 0.012), winch_gap=0.02))
    again = layout_of(made.robot(), made.constraints)
    assert [stand.twin for stand in again.sites] == [None, 0]
    assert [line.twin for line in again.routes] == [None, 0]
    assert np.array_equal(again.ties, made.ties)
    alone = layout_of(strip_robot(), made.constraints)
    assert [line.twin for line in alone.routes] == [None, None]
    assert np.array_equal(alone.ties, layout_of(strip_robot(), Constraints()).ties)


def test_without_a_cable_its_twin_and_idle_winches_go() -> None:
    one = add_mirror_image(one_cable(at=(0.02, 0.012), winch_gap=0.02))
    assert without(one, 0) is None
    line = CableRoute(1, np.array([one.sites[1].winch.at, (0.06, -0.008), (0.1, -0.009)]))
    two = add_mirror_image(replace(one, routes=(*one.routes, line)))
    left = without(two, 0)
    assert left is not None
    assert len(left.sites) == 2
    assert [line.twin for line in left.routes] == [None, 0]
    assert_symmetric(left)
    plain = without(layout(), 0)
    assert plain is not None
    assert [stand.winch.name for stand in plain.sites] == ["down"]
    locked = without(layout(Constraints(locked_winches=("up",))), 0)
    assert locked is not None
    assert [stand.winch.name for stand in locked.sites] == ["up", "down"]


def test_limited_travels_are_those_of_a_finished_network() -> None:
    """Oracle: `limit_travels`, which rounds down to a millimeter."""
    made = layout()
    far = tuple(replace(site, winch=replace(site.winch, travel=0.2)) for site in made.sites)
    made = replace(made, sites=far)
    limited = made.robot(limited=True)
    assert limit_travels(made.robot()).winches != made.robot().winches
    assert all(winch.travel == round(winch.travel, 3) for winch in limit_travels(made.robot()).winches)
    for winch, safe in zip(limited.winches, limit_travels(made.robot()).winches, strict=True):
        assert safe.travel - 1e-3 <= winch.travel <= safe.travel
