"""The graph of via points. Oracles: samples along edges, counts by hand, and equilibria with one more real cable."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import box_robot, mesh_body, strip_mesh, strip_robot

from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.design.zone import Zone
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import Cable, Marker, Mount, Robot, Winch
from hydrostat.simulation import Equilibrium, Simulation

SPACING = 0.0125


def comb_robot() -> Robot:
    """A strip with two slots from above: a straight way from tooth to tooth leads through the air."""
    mesh = strip_mesh(16, 8, size=(0.2, 0.1))
    middles = mesh.nodes[mesh.elements].mean(axis=1)
    slot = (np.abs(np.abs(middles[:, 0] - 0.1) - 0.04375) < 0.007) & (middles[:, 1] > 0)
    used, elements = np.unique(mesh.elements[~slot], return_inverse=True)
    body = mesh_body(Mesh(mesh.nodes[used], elements.reshape(-1, 3)))
    return replace(strip_robot(), body=body, cables=(), winches=())


@cache
def made(kind: str) -> tuple[Robot, RouteGraph]:
    robot = {"comb": comb_robot, "box": box_robot, "strip": lambda: strip_robot(columns=16, rows=4)}[kind]()
    constraints = Constraints(clearance=0.004, winch_clearance=0.008)
    return robot, RouteGraph.build(robot, Region.of_body(robot.body, 0.004), constraints, spacing=SPACING)


def samples(graph: RouteGraph, edges: np.ndarray) -> np.ndarray:
    first, second = graph.points[edges[:, 0]], graph.points[edges[:, 1]]
    return np.stack([first + share * (second - first) for share in np.linspace(0, 1, 41)], axis=1)


@pytest.mark.parametrize("kind", ["comb", "box"])
def test_points_and_edges_keep_inside(kind: str) -> None:
    _, graph = made(kind)
    region = Region.of_body(made(kind)[0].body, 0.004)
    assert region.depths(graph.points).min() >= 0.004
    places = samples(graph, graph.edges).reshape(-1, graph.points.shape[1])
    assert region.depths(places).min() >= 0.002 - 5e-5
    away = np.linalg.norm(graph.points[:, None] - graph.points, axis=2)
    assert away[np.triu_indices(len(away), 1)].min() >= 0.35 * SPACING
    np.testing.assert_allclose(graph.anchors.positions(made(kind)[0].body.mesh.nodes), graph.points, atol=1e-12)
    assert (region.depths(graph.points[graph.winch_places]) >= 0.008 - 1e-6).all()
    assert len(graph.winch_places) == (region.depths(graph.points) >= 0.008 - 1e-6).sum() > 0


def test_every_tooth_of_the_comb_is_reached() -> None:
    """Every point is joined to every other one, though not through the slots."""
    _, graph = made("comb")
    reached = {0}
    while len(more := {*graph.targets[np.isin(graph.sources, list(reached))].tolist()} - reached):
        reached |= more
    assert len(reached) == len(graph.points) > 60
    assert np.bincount(graph.edges.ravel()).mean() > 8


@pytest.mark.parametrize("kind", ["comb", "box"])
def test_directed_edges_are_the_edges_both_ways(kind: str) -> None:
    _, graph = made(kind)
    ways = sorted([(a, b) for a, b in graph.edges.tolist()] + [(b, a) for a, b in graph.edges.tolist()])
    assert list(zip(graph.sources.tolist(), graph.targets.tolist(), strict=True)) == ways
    assert [tuple(pair) for pair in graph.edges.tolist()] == [pair for pair in ways if pair[0] < pair[1]]
    for point in range(len(graph.points)):
        assert (graph.sources[graph.offsets[point] : graph.offsets[point + 1]] == point).all()
    np.testing.assert_array_equal(graph.sources[graph.reverses], graph.targets)
    np.testing.assert_array_equal(graph.targets[graph.reverses], graph.sources)
    np.testing.assert_array_equal(np.sort([graph.sources, graph.targets], axis=0).T, graph.edges[graph.edge_of])


def test_the_same_graph_twice() -> None:
    robot, graph = made("box")
    again = RouteGraph.build(
        robot, Region.of_body(robot.body, 0.004), Constraints(clearance=0.004, winch_clearance=0.008), spacing=SPACING
    )
    np.testing.assert_array_equal(graph.points, again.points)
    np.testing.assert_array_equal(graph.edges, again.edges)


def test_zones() -> None:
    robot, _ = made("comb")
    out, still = Zone(at=(0.1, -0.03), radius=0.011), Zone(box=((0.15, -0.05), (0.2, 0.05)))
    stand = Zone(box=((0.0, -0.05), (0.06, 0.05)))
    constraints = Constraints(
        clearance=0.004, winch_clearance=0.008, keep_out=(out,), passive_zones=(still,), winch_zones=(stand,)
    )
    graph = RouteGraph.build(robot, Region.of_body(robot.body, 0.004), constraints, spacing=SPACING)
    assert 0 < len(graph.points) < len(made("comb")[1].points)
    assert out.distances(samples(graph, graph.edges).reshape(-1, 2)).min() >= 0
    inside = np.array([still.distances(some).min() < 0 for some in samples(graph, graph.edges)])
    np.testing.assert_array_equal(graph.still, inside)
    assert 0 < inside.sum() < len(inside)
    assert (stand.distances(graph.points[graph.winch_places]) < 0).all()
    random = np.random.default_rng(0).normal(size=(len(robot.body.mesh.nodes), 2, 3))
    moves = graph.edge_moves(robot.body.mesh.nodes, random)
    assert (moves[graph.still] == 0).all()
    assert (moves[~graph.still] != 0).any(axis=1).all()
    with pytest.raises(InputError, match="winch_clearance"):
        RouteGraph.build(
            robot, Region.of_body(robot.body, 0.004), replace(constraints, winch_clearance=0.08), spacing=SPACING
        )
    nowhere = replace(constraints, keep_out=(Zone(at=(0.1, 0.0), radius=1.0),))
    with pytest.raises(InputError, match="keep-out"):
        RouteGraph.build(robot, Region.of_body(robot.body, 0.004), nowhere, spacing=SPACING)


def world_robot() -> Robot:
    """A strip with one winch beside its held end, which has no cable yet but one below."""
    robot = strip_robot(columns=16, rows=4, mount=Mount.WORLD)
    return replace(robot, winches=tuple(replace(winch, mount=Mount.WORLD) for winch in robot.winches))


def test_winches_in_the_world() -> None:
    robot = world_robot()
    region, constraints = Region.of_body(robot.body, 0.004), Constraints(clearance=0.004)
    graph = RouteGraph.build(robot, region, constraints, spacing=SPACING)
    assert graph.world.sum() == 2
    np.testing.assert_array_equal(graph.points[-2:], [winch.at for winch in robot.winches])
    np.testing.assert_array_equal(graph.winch_places, np.flatnonzero(graph.world))
    entering = graph.edges[graph.world[graph.edges[:, 1]]]
    pinned = robot.body.mesh.nodes[robot.body.mesh.nodes[:, 0] == 0]
    away = np.linalg.norm(graph.points[:-2, None] - pinned, axis=2).min(axis=1)
    held = np.flatnonzero(away <= SPACING + 1e-9).tolist()
    assert held
    assert {tuple(pair) for pair in entering.tolist()} == {(p, len(graph.points) - w) for p in held for w in (1, 2)}
    assert not graph.world[graph.edges[:, 0]].any()
    inside = RouteGraph.build(robot, region, replace(constraints, mount=Mount.BODY), spacing=SPACING)
    assert not inside.world.any()
    bare = robot.with_network((), ())
    with pytest.raises(InputError, match="winches in the world"):
        RouteGraph.build(bare, region, replace(constraints, mount=Mount.WORLD), spacing=SPACING)


@pytest.mark.parametrize("kind", ["strip", "box", "world"])
def test_what_an_edge_moves_is_what_a_cable_along_it_moves(kind: str) -> None:
    """Markers of a bent robot with one more cable of a tiny tension, per newton; two tensions tell the limit."""
    robot = world_robot() if kind == "world" else made(kind)[0]
    constraints = Constraints(clearance=0.004, winch_clearance=0.008)
    graph = RouteGraph.build(robot, Region.of_body(robot.body, 0.004), constraints, spacing=SPACING)
    robot = replace(robot, markers=_markers(robot))
    simulation = Simulation(robot)
    pose = simulation.solve(np.array([0.02, 0.004]))
    moves = graph.edge_moves(pose.nodes, _fields(simulation, pose))
    random = np.random.default_rng(0)
    chosen = random.choice(np.flatnonzero(~graph.world[graph.edges[:, 1]]), 3, replace=False)
    if kind == "world":
        chosen = np.append(chosen, np.flatnonzero(graph.world[graph.edges[:, 1]])[:2])
    for edge in chosen:
        one, two = (_pulled(robot, graph, int(edge), pose, tension) for tension in (2e-3, 1e-3))
        limit = 2 * two - one
        assert np.linalg.norm(limit - moves[edge]) < 1e-3 * np.linalg.norm(moves[edge])


def _markers(robot: Robot) -> tuple[Marker, ...]:
    """Three nodes."""
    nodes = robot.body.mesh.nodes
    return tuple(Marker(name=str(node), at=tuple(nodes[node].tolist())) for node in (len(nodes) - 1, 20, 33))


def _fields(simulation: Simulation, pose: Equilibrium) -> np.ndarray:
    """H^-1 of the markers' slopes, (nodes, dim, rows)."""
    nodes, dim = pose.nodes.shape
    slopes = np.kron(simulation.marker_anchors.matrix(nodes).toarray(), np.eye(dim))
    return simulation.response(pose, slopes.T).reshape(nodes, dim, -1)


def _pulled(robot: Robot, graph: RouteGraph, edge: int, pose: Equilibrium, tension: float) -> np.ndarray:
    """How the markers move per newton when a cable along an edge has about this tension [m/N]."""
    first, second = graph.edges[edge]
    ends = graph.points.copy()
    ends[~graph.world] = graph.anchors.positions(pose.nodes)
    shorter = float(graph.lengths[edge] - np.linalg.norm(ends[second] - ends[first]))
    mount = Mount.WORLD if graph.world[second] else Mount.BODY
    points = tuple(map(tuple, graph.points[[second, first]].tolist()))
    probe = Cable(winch="probe", points=points, stiffness=1e3, smoothing=1e-3)
    elongation = np.sqrt(4 * probe.smoothing * tension / probe.stiffness)
    pulled = robot.with_network(
        (*robot.winches, Winch(name="probe", at=points[0], mount=mount)), (*robot.cables, probe)
    )
    simulation = Simulation(pulled, options=NewtonOptions(tolerance=1e-12))
    found = simulation.solve(np.append(pose.contractions, shorter + elongation), strict=False)
    before = simulation.marker_anchors.positions(pose.nodes)
    return (simulation.marker_anchors.positions(found.nodes) - before).ravel() / found.tensions[-1]


def test_a_zone_between_nodes_holds_a_winch() -> None:
    """Oracle: a box and a polygon of 1 mm, far from every node: each has a place for a winch."""
    robot, _ = made("comb")
    region = Region.of_body(robot.body, 0.004)
    middle = robot.body.mesh.nodes[robot.body.mesh.elements].mean(axis=1)
    depths = region.depths(middle)
    deep = middle[np.argsort(-depths)[:2]]
    one = Zone(box=tuple(tuple((deep[0] + offset).tolist()) for offset in (-5e-4, 5e-4)))
    corners = deep[1] + 5e-4 * np.array([[-1, -1], [1, -1], [0, 1]])
    two = Zone(outline=tuple(map(tuple, corners.tolist())))
    constraints = Constraints(clearance=0.004, winch_clearance=0.004, winch_zones=(one, two))
    found = RouteGraph.build(robot, region, constraints, spacing=SPACING)
    places = found.points[found.winch_places]
    assert one.distances(places).min() < 0
    assert two.distances(places).min() < 0
