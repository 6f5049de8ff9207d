"""Room within constraints. Oracles: finite differences of what each row limits, the checks of `buildable`."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh, strip_robot

from hydrostat.design.buildable import violations
from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.design.routes.begin import layout_of
from hydrostat.design.routes.hairpins import hairpin_margins
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.margins import margins
from hydrostat.design.routes.refine import pushed_back
from hydrostat.design.zone import Zone
from hydrostat.robot import Body, Cable, Marker, Mount, Pin, Robot, Winch

Track = tuple[tuple[float, float], ...]
UP: Track = ((0.03, 0.03), (0.07, 0.032), (0.11, 0.03), (0.15, 0.031))
DOWN: Track = ((0.03, -0.03), (0.07, -0.031), (0.11, -0.033), (0.15, -0.03))


def body(*, notched: bool = False) -> Body:
    """200 x 100 mm; notched: less a slot from above between x = 90 and 110 mm, down to y = 0."""
    mesh = strip_mesh(20, 10, size=(0.2, 0.1))
    if not notched:
        return mesh_body(mesh)
    middles = mesh.nodes[mesh.elements].mean(axis=1)
    chosen = (np.abs(middles[:, 0] - 0.1) > 0.01) | (middles[:, 1] < 0.0)
    used, elements = np.unique(mesh.elements[chosen], return_inverse=True)
    return mesh_body(replace(mesh, nodes=mesh.nodes[used], elements=elements.reshape(-1, 3)))


def network(
    up: Track = UP, down: Track = DOWN, *, notched: bool = False, mount: Mount = Mount.BODY, more: Any = (), **make: Any
) -> Robot:
    return Robot(
        name="plate",
        body=body(notched=notched),
        pins=(Pin(box=((-0.001, -1.0), (0.001, 1.0))),),
        winches=(Winch(name="up", at=up[0], mount=mount), Winch(name="down", at=down[0])),
        cables=(
            Cable(winch="up", points=up, **make),
            Cable(winch="down", points=down),
            *(Cable(winch=name, points=points) for name, points in more),
        ),
        markers=(Marker(name="tip", at=(0.2, 0.0)),),
        poses={},
    )


def moved(track: Track, index: int, x: float, y: float) -> Track:
    return (*track[:index], (x, y), *track[index + 1 :])


BROKEN: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "a point near the edge": ({"up": moved(UP, 2, 0.11, 0.048)}, {}),
    "a segment past a concave corner": (
        {"notched": True, "up": ((0.03, 0.012), (0.06, 0.01), (0.14, 0.002), (0.17, 0.01))}, {}
    ),
    "points near a concave corner": (
        {"notched": True, "up": ((0.03, 0.012), (0.088, 0.001), (0.112, 0.0), (0.17, 0.01))}, {}
    ),
    "holes of two cables": ({"down": moved(DOWN, 2, 0.1115, 0.029)}, {}),
    "holes of one cable": ({"up": (*UP, (0.1525, 0.031))}, {}),
    "a hole at another winch": ({"down": moved(DOWN, 1, 0.034, 0.025)}, {"max_turn": 180.0}),
    "two winches": ({}, {"winch_gap": 0.07}),
    "a winch near the edge": ({"up": moved(UP, 0, 0.03, 0.043)}, {}),
    "a winch nearer to the edge than cables may be": ({"up": moved(UP, 0, 0.03, 0.048)}, {"winch_clearance": 0.0}),
    "a winch outside its zones": (
        {}, {"winch_zones": (Zone(at=(0.03, 0.0), radius=0.026), Zone(at=(0.1, 0.0), radius=0.01))}
    ),
    "a winch near one in the world": ({"up": moved(UP, 0, 0.02, -0.02), "mount": Mount.WORLD}, {"max_turn": 120.0}),
    "through a disc": ({}, {"keep_out": (Zone(at=(0.09, 0.025), radius=0.009),)}),
    "through a small disc": ({}, {"keep_out": (Zone(at=(0.09, 0.0305), radius=0.002),)}),
    "through a corner": ({}, {"keep_out": (Zone(box=((0.088, 0.0), (0.092, 0.0325))),)}),
    "through a polygon": ({}, {"keep_out": (Zone(outline=((0.08, 0.0), (0.1, 0.0), (0.09, 0.034))),)}),
    "bare through a still zone": ({}, {"passive_zones": (Zone(at=(0.13, 0.027), radius=0.006),)}),
    "a lead through a forbidden zone": ({"sheathed": ((0, 1),)}, {"keep_out": (Zone(at=(0.05, 0.028), radius=0.006),)}),
    "from the world through a zone": (
        {"up": ((-0.03, 0.04), *UP[1:]), "mount": Mount.WORLD}, {"keep_out": (Zone(at=(0.02, 0.034), radius=0.004),)}
    ),
    "from the world and back past its winch": (
        {"up": ((0.03, 0.0), (0.15, 0.0), (0.01, 0.004)), "mount": Mount.WORLD}, {}
    ),
    "from the world and back through its winch": (
        {"up": ((0.03, 0.0), (0.15, 0.0), (0.01, 0.0)), "mount": Mount.WORLD}, {}
    ),
    "from the world and around its winch": (
        {"up": ((0.06, 0.0), (0.15, 0.0), (0.1, 0.01), (0.05, 0.014), (0.035, -0.012), (0.07, -0.015)),
         "mount": Mount.WORLD}, {"max_turn": 120.0, "bend_radius": 0.0}
    ),
    "a turn": ({"up": moved(UP, 2, 0.085, 0.0)}, {"max_turn": 60.0}),
    "a bend": ({"up": moved(UP, 2, 0.11, 0.012)}, {"bend_radius": 0.05}),
    "a long cable": ({}, {"max_length": 0.1}),
    "slack": ({"slack": 0.004}, {"slack": 0.002}),
    "a spool": ({"spool_radius": 0.0095}, {"spool_ratio": 1.5}),
    "all at once": (
        {"up": moved(UP, 2, 0.11, 0.047), "down": moved(DOWN, 3, 0.14, -0.048)},
        {"max_length": 0.11, "max_turn": 40.0, "bend_radius": 0.02, "winch_gap": 0.062,
         "keep_out": (Zone(at=(0.09, 0.036), radius=0.006),)},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_what_is_pushed_back_can_be_built(name: str, unchecked: None) -> None:
    made, limits = BROKEN[name]
    robot, constraints = network(**made), Constraints(**limits)
    region = Region.of_body(robot.body, constraints.clearance)
    assert violations(robot, constraints, region)
    pushed = pushed_back(layout_of(robot, constraints), region, 0.006)
    assert pushed is not None
    assert violations(pushed.robot(digits=5), constraints, region) == []
    away = max(np.abs(one.points - other.points).max() for one, other in zip(
        pushed.routes, layout_of(robot, constraints).routes, strict=True))  # fmt: skip
    assert away < 0.04


def test_what_can_be_built_is_left_alone() -> None:
    start = layout_of(network(), Constraints())
    assert pushed_back(start, Region.of_body(start.source.body, 0.005), 0.006) is start


def test_what_is_locked_asks_for_no_room() -> None:
    """Two locked cables whose holes are 1 mm apart, the one's winch 2 mm inside the edge: they were there before."""
    up = moved(UP, 0, 0.03, 0.048)
    beside = tuple((x, y - 0.001) for x, y in up[1:])
    robot = network(up, more=[("up", (up[0], *beside))])
    start = layout_of(robot, Constraints(locked_cables=("up 1", "up 2")))
    region = Region.of_body(robot.body, 0.005)
    pushed = pushed_back(start, region, 0.006)
    assert pushed is not None
    assert pushed.robot() == robot


def test_new_cables_of_a_locked_winch_at_the_edge() -> None:
    robot = network(moved(UP, 0, 0.03, 0.048))
    constraints = Constraints(locked_winches=("up",))
    region = Region.of_body(robot.body, 0.005)
    pushed = pushed_back(layout_of(robot, constraints), region, 0.006)
    assert pushed is not None
    assert violations(pushed.robot(), constraints, region) == []


def quantities(layout: Layout, region: Any) -> np.ndarray:
    """The room of every row, with all rows there."""
    return margins(layout, region, reach=1.0).left


KINDS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "edge, gaps and turns": ({"up": moved(UP, 2, 0.11, 0.034)}, {}),
    "concave corner": ({"notched": True, "up": ((0.03, 0.012), (0.06, 0.01), (0.14, 0.002), (0.17, 0.01))}, {}),
    "zones": (
        {"sheathed": ((0, 1),)},
        {
            "keep_out": (Zone(at=(0.09, 0.002), radius=0.01), Zone(box=((0.16, -0.01), (0.18, 0.01)))),
            "passive_zones": (Zone(at=(0.09, 0.04), radius=0.003),),
            "winch_zones": (Zone(at=(0.03, 0.0), radius=0.04),),
        },
    ),
    "bends and lengths": ({"up": moved(UP, 2, 0.11, 0.02)}, {"bend_radius": 0.01, "max_length": 0.13}),
    "slack and spools": ({}, {"slack": 0.01, "spool_ratio": 1.5}),
    "world": ({"up": ((-0.03, 0.04), *UP[1:]), "mount": Mount.WORLD}, {}),
}


@pytest.mark.parametrize("name", KINDS)
def test_rows_are_the_slopes_of_what_they_limit(name: str, unchecked: None) -> None:
    """Central differences of the room of each row by all numbers; a row is where it was, as all limits are in reach."""
    made, limits = KINDS[name]
    robot, constraints = network(**made), Constraints(**limits)
    region = Region.of_body(robot.body, constraints.clearance)
    start = layout_of(robot, constraints)
    numbers = start.numbers + np.concatenate(
        [np.random.default_rng(3).uniform(-5e-4, 5e-4, start.starts[-2]), np.full(2 * len(start.routes), 1e-3)]
    )
    here = start.at(numbers)
    rows = margins(here, region, reach=1.0).rows
    step, slopes = 1e-7, np.zeros_like(rows)
    for index in range(here.size):
        ends = [quantities(here.at(numbers + sign * step * np.eye(here.size)[index]), region) for sign in (1, -1)]
        slopes[:, index] = (ends[0] - ends[1]) / (2 * step)
    # Where two sides of a body or zone are equally near, there is no slope.
    smooth = np.abs(slopes + rows).max(axis=1) < 1e-4
    assert smooth.mean() > 0.97
    assert len(rows) > 50


BACK: dict[str, tuple[Track, int]] = {  # a cable from the world, and its limits within 1 m
    "past its winch": (((0.03, 0.0), (0.15, 0.0), (0.08, 0.001), (0.01, 0.004)), 2),
    "far from its winch": (((0.03, 0.0), (0.15, 0.0), (0.12, 0.01)), 1),
    "by 160 degrees, along a short way back": (((0.03, 0.0), (0.06, 0.0), (0.0506, 0.0034)), 1),
    "by 149 degrees": (((0.03, 0.0), (0.06, 0.0), (0.0429, 0.0104)), 1),
    "little turned, near its winch": (((0.03, 0.0), (0.04, 0.0), (0.038, 0.01)), 1),
}


@pytest.mark.parametrize("name", BACK)
@pytest.mark.parametrize("dim", [2, 3])
def test_ways_back_have_exact_slopes(name: str, dim: int, unchecked: None) -> None:
    """Oracle: central differences, of the first limits alone. In space the cable leaves its plane."""
    track, count = BACK[name]
    robot = network(track, mount=Mount.WORLD) if dim == 2 else _in_space(track)
    start = layout_of(robot, Constraints())

    def find(numbers: np.ndarray) -> list[tuple[np.ndarray, float]]:
        return list(hairpin_margins(start.at(numbers), reach=1.0, hair=5e-5, degrees=0.5))

    numbers = start.numbers + np.random.default_rng(3).uniform(-5e-4, 5e-4, start.size)
    found, step = find(numbers), 1e-7
    assert len(found) == count
    for which, (row, _) in enumerate(found):
        slopes = [
            (find(numbers + one)[which][1] - find(numbers - one)[which][1]) / (2 * step)
            for one in step * np.eye(start.size)
        ]
        np.testing.assert_allclose(-row, slopes, atol=1e-5)


def _in_space(track: Track) -> Robot:
    """A box 200 x 50 x 50 mm with a cable from the world."""
    points = tuple((x, y, 0.002 * index) for index, (x, y) in enumerate(track))
    return Robot(
        name="box",
        body=mesh_body(box_mesh((4, 1, 1), size=(0.2, 0.05, 0.05))),
        pins=(Pin(box=((-0.001, -1.0, -1.0), (0.001, 1.0, 1.0))),),
        winches=(Winch(name="up", at=points[0], mount=Mount.WORLD),),
        cables=(Cable(winch="up", points=points),),
        markers=(Marker(name="tip", at=(0.2, 0.0, 0.0)),),
        poses={},
    )


def test_only_limits_within_reach_are_told() -> None:
    robot = network()
    constraints = Constraints()
    region = Region.of_body(robot.body, constraints.clearance)
    start = layout_of(robot, constraints)
    far, near = margins(start, region, reach=1.0), margins(start, region, reach=0.006)
    bounds = 4 * len(start.routes)
    assert len(near.left) - bounds == (far.left[:-bounds] <= 0.006).sum()


def test_a_layout_far_out_is_given_up() -> None:
    """No room for 60 holes 15 mm apart; it ends, and says so."""
    track = tuple((0.02 + 0.0025 * index, 0.01) for index in range(60))
    robot = network(track, DOWN)
    constraints = Constraints(hole_gap=0.03, winch_clearance=0.005)
    assert pushed_back(layout_of(robot, constraints), Region.of_body(robot.body, 0.005), 0.006) is None


def test_strips_have_room() -> None:
    """The strip of the other tests: every number of its layout is limited by something within the body."""
    start = layout_of(strip_robot(), Constraints(winch_clearance=0.005))
    rows = margins(start, Region.of_body(start.source.body, 0.005), reach=1.0).rows
    assert (np.abs(rows).max(axis=0) > 0).all()
