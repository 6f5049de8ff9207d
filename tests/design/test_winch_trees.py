"""Winch trees. Oracles: numbers by hand, brute force over all places and all subsets of routes."""

from itertools import combinations

import numpy as np
import pytest
from builders import mesh_body, strip_mesh

from hydrostat.design import Constraints, TreeOptions
from hydrostat.design.region import Region
from hydrostat.design.trees.design_trees import _apart, _shares
from hydrostat.design.trees.lead_paths import LeadPaths, find_lead_paths
from hydrostat.design.trees.winch_trees import WinchTrees, tree_score
from hydrostat.geometry import Mesh
from hydrostat.robot import Body, Pin, Robot

OPTIONS, LIMITS = TreeOptions(), Constraints()


def _used(nodes: np.ndarray, elements: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Without the nodes that no element has."""
    kept, index = np.unique(elements, return_inverse=True)
    return nodes[kept], index.reshape(elements.shape)


def row(y: float, start: float = 0.06, end: float = 0.16) -> np.ndarray:
    return np.column_stack([np.linspace(start, end, 5), np.full(5, y)])


def strip_trees(seed: int, *, poses: int = 1, **options: float) -> WinchTrees:
    """Six routes on a strip, shortened at random."""
    mesh = strip_mesh(16, 4)
    random = np.random.default_rng(seed)
    posed = []
    for _ in range(poses):
        # Each height shrinks by its own share, so that the routes shorten by different lengths.
        share = np.interp(mesh.nodes[:, 1], np.linspace(-0.025, 0.025, 7), random.uniform(0.0, 0.4, 7))
        posed.append(np.column_stack([mesh.nodes[:, 0] * (1 - share), mesh.nodes[:, 1]]))
    routes = [row(y) for y in (-0.015, -0.01, -0.004, 0.003, 0.009, 0.015)]
    return WinchTrees(mesh, routes, posed, ways_of(mesh_body(mesh)), LIMITS, TreeOptions(**options))


def ways_of(body: Body) -> LeadPaths:
    """Of a body without a network."""
    robot = Robot(name="bare", body=body, pins=(Pin(box=((-1.0, -1.0), (1.0, 1.0))),), poses={})
    return find_lead_paths(robot, Region.of_body(body, LIMITS.clearance), LIMITS)


def test_the_score_by_hand() -> None:
    """E22, E23: phi mean - (1 - phi) std of contractions; an uneven pair loses what the thesis's sum would reward."""
    uneven = np.array([[0.2], [0.6]])
    assert tree_score(uneven, 0.75) == pytest.approx(0.75 * 0.4 - 0.25 * 0.2)
    assert tree_score(uneven, 1.0) == pytest.approx(0.4)
    assert tree_score(uneven, 0.0) == pytest.approx(-0.2)
    assert tree_score(np.full((3, 2), 0.3), 0.5) == pytest.approx(0.15)
    assert tree_score(np.array([[0.2], [0.6]]), 0.4) < tree_score(np.array([[0.35], [0.35]]), 0.4)
    # Two poses: what is even within each pose is even, whatever the poses ask for.
    assert tree_score(np.array([[0.1, 0.5], [0.1, 0.5]]), 0.0) == 0.0


@pytest.mark.parametrize("count", [1, 2, 3, 4])
@pytest.mark.parametrize("phi", [0.2, 0.5, 0.8, 1.0])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_best_tree_of_all_places_and_subsets(seed: int, count: int, phi: float) -> None:
    trees = strip_trees(seed, lead_penalty=0.0)
    scale = trees.shortenings.max()
    scores = [
        tree_score(trees.shortenings[list(chosen)] / scale, phi)
        for chosen in combinations(range(len(trees.routes)), count)
    ]
    found = trees.best(count, set(), [], phi)
    assert found is not None
    assert found.score == pytest.approx(max(scores), abs=1e-12)
    assert tree_score(trees.shortenings[list(found.routes)] / scale, phi) == pytest.approx(found.score, abs=1e-12)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_with_leads_the_best_of_all_places_and_neighbors_in_contraction(seed: int) -> None:
    """Brute force over what is searched where there are several poses and leads."""
    trees = strip_trees(seed, poses=2)
    order = np.argsort(trees.shortenings.mean(axis=1), kind="stable")
    scale = trees.shortenings.max()
    scores = [
        tree_score(trees.shortenings[order[first : first + 2]] / scale, 0.5)
        - OPTIONS.lead_penalty * float(trees.leads[place, order[first : first + 2]].mean()) / trees.mesh.size
        for place in range(len(trees.places))
        for first in range(5)
    ]
    found = trees.best(2, set(), [], 0.5)
    assert found is not None
    assert found.score == pytest.approx(max(scores), abs=1e-12)


def test_used_routes_and_taken_places_are_left_out() -> None:
    trees = strip_trees(0)
    first = trees.best(2, set(), [], 0.5)
    assert first is not None
    second = trees.best(2, set(first.routes), [first.place], 0.5)
    assert second is not None
    assert not set(first.routes) & set(second.routes)
    apart = np.linalg.norm(trees.mesh.nodes[first.place] - trees.mesh.nodes[second.place])
    assert apart >= LIMITS.winch_gap
    few = trees.best(5, {0, 1, 2, 3}, [], 0.5)
    assert few is not None
    assert few.routes == (4, 5)
    assert trees.best(1, set(range(6)), [], 0.5) is None
    everywhere = [int(place) for place in trees.places]
    assert trees.best(1, set(), everywhere, 0.5) is None


def test_leads_stay_inside_and_begin_at_the_winch() -> None:
    """Round a hole, which no straight lead may cross."""
    full = strip_mesh(20, 20, size=(0.1, 0.1))
    centers = full.nodes[full.elements].mean(axis=1)
    body = mesh_body(Mesh(*_used(full.nodes, full.elements[np.abs(centers - [0.05, 0.0]).max(axis=1) > 0.02])))
    region = Region.of_body(body, 0.005)
    assert region.body.area == pytest.approx(0.1**2 - 0.04**2)
    route = np.array([[0.085, -0.03], [0.085, 0.0], [0.085, 0.03]])
    trees = WinchTrees(body.mesh, [route], [body.mesh.nodes], ways_of(body), LIMITS, OPTIONS)
    assert len(trees.places)
    for place in trees.places:
        points, lead = trees.cable_points(int(place), 0)
        assert points[0] == pytest.approx(body.mesh.nodes[place])
        assert region.holds(points)
        assert np.linalg.norm(np.diff(points, axis=0), axis=1).min() > 1e-6
        if lead:
            assert np.array_equal(points[lead:], route) or np.array_equal(points[lead:], route[::-1])
        else:
            assert np.linalg.norm(points[0] - route, axis=1).min() < 2 * LIMITS.spool_radius


def test_a_route_is_pulled_from_its_nearer_end() -> None:
    trees = strip_trees(0)
    left, right = int(np.argmin(trees.mesh.nodes[trees.places, 0])), int(np.argmax(trees.mesh.nodes[trees.places, 0]))
    assert not trees.reversed[left].any()
    assert trees.reversed[right].all()
    assert trees.leads[left, 0] >= 0.95 * np.linalg.norm(trees.mesh.nodes[trees.places[left]] - trees.routes[0][0])


@pytest.mark.parametrize(("cables", "winches"), [(1, 1), (6, 2), (3, 3), (7, 3), (11, 8)])
def test_shares_are_all_ways_the_evenest_first(cables: int, winches: int) -> None:
    shares = list(_shares(cables, winches))
    every = [way for way in np.ndindex(*[cables + 1] * min(winches, 3)) if sum(way) == cables and min(way) > 0]
    assert len(shares) == len(set(shares))
    assert all(sum(share) == cables and min(share) >= 1 and len(share) == winches for share in shares)
    assert max(shares[0]) - min(shares[0]) <= 1
    if winches <= 3:
        assert set(shares) == set(every)
    spreads = [max(share) - min(share) for share in shares]
    assert spreads == sorted(spreads)


def test_very_many_ways_to_share_are_not_all_counted() -> None:
    assert list(_shares(60, 20)) == [(3,) * 20]


def test_routes_along_others_are_dropped() -> None:
    kept = _apart([row(0.0), row(0.004), row(0.0)[::-1], row(0.02), row(0.0, 0.15, 0.3)], 0.0125)
    assert [route[0, 1] for route in kept] == [0.0, 0.02, 0.0]
