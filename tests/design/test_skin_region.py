"""Cables on the skin (R53). Oracles: closed form in boxes, winding numbers of `Solid`, lists and holes of the kit."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import box_mesh, box_robot, gallery_robot, mesh_body, strip_robot

from hydrostat.design import Constraints, Network, RouteOptions, design_cables
from hydrostat.design.buildable import violations
from hydrostat.design.robot_review import review_robot
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.design.skin_region import SINK, STITCH, SkinRegion, cable_region
from hydrostat.errors import InputError
from hydrostat.fabrication import PatternOptions, depth_table, space_pattern
from hydrostat.geometry import Mesh, Solid
from hydrostat.robot import Body, Mount, Robot

DEPTHS = [0.0, 0.003]
SIZE = np.array([0.1, 0.05, 0.05])


def layer(body: Body, depth: float) -> SkinRegion:
    found = cable_region(body, Constraints(depth=depth))
    assert isinstance(found, SkinRegion)
    return found


@cache
def block() -> Body:
    return mesh_body(box_mesh((4, 2, 2), size=tuple(SIZE)))


@cache
def hook() -> Body:
    """An L of 60 x 60 mm whose two legs are 20 mm thick, 20 mm deep."""
    full = box_mesh((6, 6, 2), size=(0.06, 0.06, 0.02))
    kept = full.elements[(full.nodes[full.elements].mean(axis=1)[:, :2] < 0.02).any(axis=1)]
    used, elements = np.unique(kept, return_inverse=True)
    return mesh_body(Mesh(full.nodes[used], elements.reshape(kept.shape)))


@pytest.mark.parametrize("depth", DEPTHS)
def test_points_come_to_the_layer_of_a_box(depth: float) -> None:
    """From inside and outside: the least of the distances from the six sides is as wanted."""
    places = np.random.default_rng(1).uniform(-0.004, SIZE + 0.004, (400, 3))
    moved = layer(block(), depth).push_inside(places)
    sides = np.minimum(moved, SIZE - moved).min(axis=1)
    deep = np.minimum(places, SIZE - places).min(axis=1) < 0.02  # in the middle several sides are as near
    assert np.abs(sides - depth)[deep].max() <= STITCH + 1e-9
    assert sides[deep].min() >= 0.0


@pytest.mark.parametrize("depth", DEPTHS)
def test_runs_keep_to_the_layer(depth: float) -> None:
    region, at = layer(block(), depth), max(depth, STITCH / 2)
    low, high = 0.01, 0.09
    along = np.array([low, at, 0.025]), np.array([high, at, 0.025])
    through = np.array([low, at, 0.025]), np.array([high, 0.05 - at, 0.025])
    dips = np.array([low, at, 0.025]), np.array([high, at + SINK + 0.001, 0.025])
    starts, ends = np.stack([along, through, dips], axis=1)
    assert region.sees(starts, ends).tolist() == [True, False, False]


@pytest.mark.parametrize("depth", DEPTHS)
def test_no_run_spans_a_hollow(depth: float) -> None:
    """Between the inner sides of the legs of an L a straight line leaves the body; along each of them it does not."""
    region, at = layer(hook(), depth), 0.02 - max(depth, STITCH / 2)
    starts = np.array([[0.05, at, 0.01], [0.05, at, 0.01]])
    ends = np.array([[at, 0.05, 0.01], [0.03, at, 0.01]])
    assert region.depths(np.vstack([starts, ends])) == pytest.approx(0.02 - at)
    assert region.depths(np.array([[0.03, 0.03, 0.01]])) < 0
    assert region.sees(starts, ends).tolist() == [False, True]


def test_too_thin_a_body_is_told() -> None:
    with pytest.raises(InputError, match="too thin for cables 30 mm under its skin; lower depth"):
        cable_region(block(), Constraints(depth=0.03))


def test_what_has_no_skin_for_cables_is_told() -> None:
    for robot, words in ((strip_robot(), "a flat body has no skin"), (box_robot(), "from winches outside")):
        with pytest.raises(InputError, match=words):
            Constraints(depth=0.002).check(robot)


def outside_robot(*points: tuple[float, float, float]) -> Robot:
    """A box of 120 x 40 x 40 mm with one cable from a winch in the world."""
    robot = box_robot()
    winch = replace(robot.winches[0], at=(-0.05, 0.02, 0.0), mount=Mount.WORLD)
    cable = replace(robot.cables[0], points=(winch.at, *points), name="")
    return robot.with_network([winch], [cable])


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (((0.01, 0.02, 0.003), (0.06, 0.02, 0.0035), (0.1, 0.02, 0.0025)), ""),
        (
            ((0.01, 0.02, 0.003), (0.06, 0.02, 0.0045)),
            "(4.5 mm inside the surface, at [60, 20, 4.5] mm). Maximum at a depth of 3 mm: 3.5 mm",
        ),
        (
            ((0.01, 0.02, 0.003), (0.06, 0.02, 0.0015)),
            "(1.5 mm inside the surface, at [60, 20, 1.5] mm). Minimum at a depth of 3 mm: 2.5 mm",
        ),
        (
            ((0.01, 0.02, 0.003), (0.1, 0.02, 0.037)),
            "too deep (20 mm inside the surface). Maximum at a depth of 3 mm: 6 mm",
        ),
    ],
)
def test_points_and_runs_off_the_layer_are_told(points: tuple[tuple[float, float, float], ...], words: str) -> None:
    limits = Constraints(depth=0.003)
    robot = outside_robot(*points)
    found = [one for one in violations(robot, limits, cable_region(robot.body, limits)) if "surface" in one]
    if words:
        assert words in found[0]
        assert "at a depth of 3 mm: " in found[0]
    else:
        assert found == []


@pytest.mark.parametrize("depth", DEPTHS)
def test_the_graph_lies_in_the_layer(depth: float, unchecked: None) -> None:
    """By winding numbers of the healed surface, along 21 places of each run."""
    robot, limits = gallery_robot("trunk"), Constraints(depth=depth)
    graph = RouteGraph.build(robot, cable_region(robot.body, limits), limits, spacing=0.0117)
    held = graph.points[~graph.world]
    solid = robot.body.solid
    assert solid is not None
    assert np.abs(-solid.distances(held) - depth).max() <= STITCH + 1e-6
    inner = graph.edges[(graph.edges < len(held)).all(axis=1)]
    starts, ends = graph.points[inner[:, 0]], graph.points[inner[:, 1]]
    shares = np.linspace(0, 1, 21)[:, None, None]
    depths = -solid.distances((starts + shares * (ends - starts)).reshape(-1, 3))
    assert depths.min() >= min(depth - STITCH, 0.5 * depth) - 4e-5
    assert depths.max() <= depth + SINK + 4e-5
    assert len(inner) > 3 * len(held)


def designed(depth: float) -> Network:
    robot = gallery_robot("trunk")
    options = RouteOptions(starts=1, exchanges=0, steps=2, refine_steps=2)
    return design_cables(
        robot, [robot.pose("wave")], winches=1, cables=2, constraints=Constraints(depth=depth), options=options
    )


@pytest.mark.slow
@pytest.mark.parametrize("depth", DEPTHS)
def test_a_design_on_the_skin_is_sewn_as_it_was_simulated(depth: float, unchecked: None) -> None:
    """Each point lies at the depth, is sewn to the skin by the list of the kit, and is a hole of the plush pattern."""
    network = designed(depth)
    robot, source = network.robot, gallery_robot("trunk")
    limits = network.constraints
    assert violations(robot, limits, cable_region(robot.body, limits)) == []
    solid = robot.body.solid
    assert isinstance(solid, Solid)
    points = np.concatenate([np.array(cable.points[1:]) for cable in robot.cables])
    assert np.abs(-solid.distances(points) - depth).max() <= STITCH + 2e-5
    moved = source.pose("wave").targets
    rest = [np.subtract(marker.at, moved[marker.name]) for marker in source.markers if marker.name in moved]
    assert network.rms_error < 0.6 * np.sqrt(np.mean(np.sum(np.square(rest), axis=1)))
    sewn = [row.how for row in depth_table(robot).rows if row.point != "1 (winch)" and "tube" not in row.how]
    assert sewn
    assert set(sewn) == {"sewn to the skin"}
    holes = space_pattern(robot, PatternOptions(force=True)).holes
    found = {(hole.cable, hole.point) for hole in holes}
    every = {
        (number, point) for number, cable in enumerate(robot.cables, 1) for point in range(2, len(cable.points) + 1)
    }
    assert found == every
    outside = [hole.depth for hole in holes if not hole.in_seam]
    assert outside or depth > 0  # 3 mm deep, all holes of this design lie in seams
    assert max(outside, default=0.0) <= 1e3 * (depth + STITCH) + 0.5


def test_the_judgement_knows_the_layer() -> None:
    """Cables 3 mm under the skin are too near to it for a clearance of 5 mm, and right for a depth of 3 mm."""
    robot = outside_robot((0.01, 0.02, 0.003), (0.06, 0.02, 0.003), (0.1, 0.02, 0.003))
    told = {
        limits.depth: review_robot(robot, constraints=limits) for limits in (Constraints(), Constraints(depth=0.003))
    }
    assert any("Minimum clearance: 5 mm" in finding.text for finding in told[None])
    assert not any("surface" in finding.text for finding in told[0.003])
