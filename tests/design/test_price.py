"""Prices of paths. Oracles: brute force over all simple paths, an independent program, the closed form of one cable."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from typing import Any

import numpy as np
import pytest
from builders import mesh_body, strip_mesh, strip_robot

from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.design.routes.price import PathLimits, PricedPath, PricingProblem, price_paths
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.geometry import Anchors
from hydrostat.kernel import native
from hydrostat.robot import Marker
from hydrostat.simulation import Simulation

REGION = Region.of_body(mesh_body(strip_mesh(4, 2)), 0.005)
"""Of a body that has nothing to do with the graphs: paths only ask the graph."""


def made_graph(points: np.ndarray, edges: np.ndarray, *, worlds: int = 0) -> RouteGraph:
    held = len(points) - worlds
    return RouteGraph(
        points=points,
        anchors=Anchors(np.zeros((held, 3), dtype=np.int64), np.full((held, 3), 1 / 3), np.zeros(held)),
        edges=edges,
        still=np.zeros(len(edges), dtype=bool),
        winch_places=np.arange(held) if not worlds else np.arange(held, len(points)),
        size=float(np.ptp(points, axis=0).max()),
        region=REGION,
    )


def grid_graph(columns: int, rows: int) -> RouteGraph:
    """Each point joined to its eight neighbors."""
    y, x = np.divmod(np.arange(columns * rows), columns)
    near = np.maximum(np.abs(x[:, None] - x), np.abs(y[:, None] - y)) == 1
    return made_graph(np.column_stack([x, y]).astype(float), np.argwhere(np.triu(near)))


def cloud_graph(count: int, seed: int, neighbors: int = 6) -> RouteGraph:
    points = np.random.default_rng(seed).random((count, 2)) * [2.0, 1.0]
    away = np.linalg.norm(points[:, None] - points, axis=2)
    near = np.argsort(away, axis=1)[:, 1 : neighbors + 1]
    pairs = np.column_stack([np.repeat(np.arange(count), neighbors), near.ravel()])
    return made_graph(points, np.unique(np.sort(pairs, axis=1), axis=0))


def all_paths(graph: RouteGraph, hops: int, turn: float) -> list[tuple[int, ...]]:
    """Every simple path without a sharper turn, each way round."""
    after = {(first, middle): [] for pair in graph.edges.tolist() for first, middle in (pair, pair[::-1])}
    for first, middle, last in allowed_turns(graph, turn):
        after[first, middle].append(last)
    found: list[tuple[int, ...]] = []

    def grow(path: tuple[int, ...]) -> None:
        found.append(path)
        if len(path) <= hops:
            for point in after[path[-2], path[-1]]:
                if point not in path:
                    grow((*path, point))

    for pair in after:
        grow(pair)
    return found


def allowed_turns(graph: RouteGraph, turn: float) -> list[list[int]]:
    """Points of every two successive edges, without a sharper turn."""
    joined = np.zeros((len(graph.points),) * 2, dtype=bool)
    joined[tuple(graph.edges.T)] = joined[tuple(graph.edges[:, ::-1].T)] = True
    spans = graph.points[None] - graph.points[:, None]
    units = spans / np.maximum(np.linalg.norm(spans, axis=2), 1e-12)[..., None]
    angles = np.degrees(np.arccos(np.clip(np.einsum("abd,bcd->abc", units, units), -1.0, 1.0)))
    turns = np.argwhere(joined[:, :, None] & joined[None] & (angles <= turn + 1e-5))
    return turns[turns[:, 0] != turns[:, 2]].tolist()


def sums_along(graph: RouteGraph, paths: Sequence[tuple[int, ...]], values: np.ndarray) -> np.ndarray:
    """Sum of the values of its edges for each path."""
    number = {tuple(pair): index for index, pair in enumerate(graph.edges.tolist())}
    along = np.full((len(paths), max(map(len, paths)) - 1), len(values))
    for row, path in enumerate(paths):
        for place, pair in enumerate(pairwise(path)):
            along[row, place] = number[min(pair), max(pair)]
    return np.concatenate([values, np.zeros((1, *values.shape[1:]))])[along].sum(axis=1)


def decreases(moves: np.ndarray, case: dict[str, Any]) -> np.ndarray:
    """D of many moves, by its formula."""
    total = np.zeros(len(moves))
    for pose, ridge in enumerate(case["ridge"]):
        rows = case["pose_of_row"] == pose
        pull, stiff = moves[:, rows] @ case["residual"][rows], (moves[:, rows] ** 2).sum(axis=1) + ridge
        tension = np.clip(pull / stiff, 0.0, case["most"])
        total += tension * pull - 0.5 * tension**2 * stiff
    return total


def made_case(graph: RouteGraph, seed: int, *, poses: int = 2, rows: int = 4, most: float = 3.0) -> dict[str, Any]:
    """Moves of a smooth random field, as those of an elastic body are, and a random residual; poses interleaved."""
    random = np.random.default_rng(seed)
    waves = np.sin(graph.points @ random.normal(size=(2, 6)) * 2.0 + 6 * random.random(6))
    field = np.einsum("nk,kdr->ndr", waves, random.normal(size=(6, 2, poses * rows)))
    first, second = graph.edges.T
    moves = np.einsum("edr,ed->er", field[first] - field[second], graph.points[second] - graph.points[first])
    scale = float((moves**2).sum(axis=1).mean())
    return {
        "moves": moves,
        "residual": random.normal(size=poses * rows),
        "pose_of_row": np.arange(poses * rows) % poses,
        "ridge": np.full(poses, 0.1 * scale / poses),
        "most": most / math.sqrt(scale),
    }


def priced(graph: RouteGraph, case: dict[str, Any], limits: PathLimits, **options: Any) -> list[PricedPath]:
    lead = {"lead_penalty": options.pop("lead_penalty", 0.3), "leads": options.pop("leads", False)}
    return price_paths(graph, PricingProblem(**case), replace(limits, **lead), **{"count": 5, **options})


@pytest.mark.parametrize("hops", [1, 2])
@pytest.mark.parametrize("seed", range(4))
def test_exact_for_one_and_two_edges(hops: int, seed: int) -> None:
    graph = cloud_graph(30, seed)
    case = made_case(graph, seed, most=0.5 if seed % 2 else 20.0)
    for winches in (None, [3], [4, 11]):
        longest = 0.6
        paths = [path for path in all_paths(graph, hops, 75.0) if winches is None or path[0] in winches]
        paths = [path for path in paths if _length(graph, path) <= longest]
        best = decreases(sums_along(graph, paths, case["moves"]), case).max()
        found = priced(graph, case, PathLimits(max_edges=hops, turn=75.0, longest=longest), winches=winches)
        assert found[0].gain == pytest.approx(best)


def test_near_the_best_of_all_paths() -> None:
    """On random problems with some 10 000 paths each."""
    ratios = []
    for seed in range(8):
        graph = cloud_graph(24, seed)
        tame, wild = all_paths(graph, 6, 75.0), all_paths(graph, 4, 150.0)
        for poses, winches, most, hops, turn in (
            (1, None, 20.0, 6, 75.0),
            (3, [5], 1.0, 6, 75.0),
            (1, [7], 9.0, 4, 150.0),
        ):
            paths = wild if turn > 90 else tame
            case = made_case(graph, seed, poses=poses, most=most)
            mine = paths if winches is None else [path for path in paths if path[0] in winches]
            best = decreases(sums_along(graph, mine, case["moves"]), case).max()
            found = priced(graph, case, PathLimits(max_edges=hops, turn=turn), winches=winches)
            assert found[0].nodes in mine
            ratios.append(found[0].gain / best)
    assert max(ratios) <= 1 + 1e-9
    assert min(ratios) > 0.97
    assert np.mean(ratios) > 0.995


@pytest.mark.parametrize("still", [False, True])
def test_many_rows_that_move_in_few_patterns_give_nearly_the_gain_of_all(still: bool) -> None:
    """Forty rows of a field of six waves, a hundredth of noise, and a row by which still edges move without end."""
    for seed in range(3):
        graph = cloud_graph(24, seed)
        case = made_case(graph, seed, poses=1, rows=40, most=20.0)
        noise = np.random.default_rng(seed).normal(size=case["moves"].shape)
        case["moves"] = case["moves"] + 1e-3 * np.abs(case["moves"]).mean() * noise
        if still:
            barred = np.arange(len(case["moves"])) % 5 == 0
            case["moves"][:, -1] = 1e5 * np.abs(case["moves"]).max() * barred
            case["residual"][-1] = 0.0
        paths = all_paths(graph, 2, 75.0)
        gains = decreases(sums_along(graph, paths, case["moves"]), case)
        found = priced(graph, case, PathLimits(max_edges=2, turn=75.0))
        assert found[0].gain == pytest.approx(gains.max(), rel=1e-2)
        assert gains[paths.index(found[0].nodes)] > 0.99 * gains.max()


def test_what_a_priced_path_says_of_itself() -> None:
    graph = cloud_graph(40, 1)
    case = made_case(graph, 1, poses=3, most=1.0)
    found = priced(graph, case, PathLimits(max_edges=8, turn=75.0, longest=1.2), count=12)
    assert len(found) == 12
    gains = [path.gain for path in found]
    assert gains == sorted(gains, reverse=True)
    for path in found:
        moves = sums_along(graph, [path.nodes], case["moves"])
        np.testing.assert_allclose(path.moves, moves[0], atol=1e-12)
        assert path.gain == pytest.approx(decreases(moves, case)[0])
        assert path.lead == (path.nodes[0],)
        assert _length(graph, path.nodes) <= 1.2
        for pose, tension in enumerate(path.tensions):
            assert tension == pytest.approx(_best_tension(path.moves, case, pose), abs=2e-4 * case["most"])


def _best_tension(moves: np.ndarray, case: dict[str, Any], pose: int) -> float:
    """By trying many."""
    rows = case["pose_of_row"] == pose
    tensions = np.linspace(0.0, case["most"], 10_001)
    left = case["residual"][rows] - tensions[:, None] * moves[rows]
    return float(tensions[np.argmin((left**2).sum(axis=1) + tensions**2 * case["ridge"][pose])])


def _length(graph: RouteGraph, path: Sequence[int]) -> float:
    return float(np.linalg.norm(np.diff(graph.points[list(path)], axis=0), axis=1).sum())


@pytest.mark.parametrize("longest", [None, 3.1])
@pytest.mark.parametrize("seed", range(3))
def test_the_best_lead_of_all(seed: int, longest: float | None) -> None:
    """Every path of the grid, with every part at its end bare: the lead costs by its length and moves nothing."""
    graph = grid_graph(4, 3)
    case = made_case(graph, seed)
    penalty, winches = 0.2, [0, 7]
    whole = [path for path in all_paths(graph, 6, 75.0) if path[0] in winches]
    parts = [(path[:-bare], path[-bare - 1 :]) for path in whole for bare in (1, 2) if len(path) > bare]
    parts = [part for part in parts if longest is None or _length(graph, part[0]) + _length(graph, part[1]) <= longest]
    leads = np.array([_length(graph, lead) for lead, _ in parts])
    gains = decreases(sums_along(graph, [bare for _, bare in parts], case["moves"]), case)
    gains *= np.maximum(1 - penalty * leads / graph.size, 0.0)
    limits = PathLimits(max_edges=2, turn=75.0, longest=longest)
    found = priced(graph, case, limits, winches=winches, leads=True, lead_penalty=penalty)
    assert found[0].gain == pytest.approx(gains.max())
    for path in found:
        assert path.winch in winches
        assert path.lead[-1] == path.nodes[0]
        assert (*path.lead, *path.nodes[1:]) in whole


def test_paths_unlike_one_another() -> None:
    """No two share more than 70 % of their edges, and no region of winches has more than its part of the paths."""
    graph = cloud_graph(60, 2)
    found = priced(graph, made_case(graph, 2), PathLimits(max_edges=7, turn=75.0), count=8)
    edges = [{frozenset(pair) for pair in pairwise(path.nodes)} for path in found]
    for row, some in enumerate(edges):
        for other in edges[:row]:
            assert len(some & other) <= 0.7 * min(len(some), len(other))
    places = graph.points[[path.winch for path in found]]
    near = np.linalg.norm(places[:, None] - places, axis=2) < 2 * np.median(graph.lengths)
    assert near.sum(axis=1).max() <= 2 + 2  # a path near two regions counts in both


def test_like_paths_where_there_is_nothing_else() -> None:
    graph = grid_graph(5, 1)
    case = made_case(graph, 0)
    found = priced(graph, case, PathLimits(max_edges=4, turn=75.0), winches=[0], count=10)
    paths = [path for path in all_paths(graph, 4, 75.0) if path[0] == 0]
    useful = decreases(sums_along(graph, paths, case["moves"]), case) > 0
    assert {path.nodes for path in found} <= {path for path, good in zip(paths, useful, strict=True) if good}
    assert len({path.nodes for path in found}) == len(found) > 1


def test_a_winch_in_the_world_is_where_a_cable_begins_and_nowhere_else() -> None:
    inner = grid_graph(4, 3)
    winches = np.array([[-1.0, 0.5], [-1.0, 1.5]])
    entries = np.array([[point, 12 + winch] for winch in (0, 1) for point in (0, 4, 8)])
    graph = made_graph(np.concatenate([inner.points, winches]), np.concatenate([inner.edges, entries]), worlds=2)
    graph = made_graph(graph.points, graph.edges[np.lexsort(graph.edges.T[::-1])], worlds=2)
    for seed in range(5):
        case = made_case(graph, seed)
        for leads in (False, True):
            found = priced(graph, case, PathLimits(max_edges=5, turn=140.0), leads=leads, count=30)
            assert found
            for path in found:
                whole = (*path.lead, *path.nodes[1:])
                assert whole[0] >= 12
                assert max(whole[1:]) < 12
        paths = [path for path in all_paths(graph, 2, 90.0) if path[0] >= 12 and max(path[1:]) < 12]
        best = decreases(sums_along(graph, paths, case["moves"]), case).max()
        assert priced(graph, case, PathLimits(max_edges=2, turn=90.0))[0].gain == pytest.approx(best)


def test_the_same_twice() -> None:
    graph = cloud_graph(40, 3)
    case = made_case(graph, 3)
    one, two = (priced(graph, case, PathLimits(max_edges=8, turn=75.0), leads=True) for _ in range(2))
    assert [(path.nodes, path.lead, path.gain) for path in one] == [(path.nodes, path.lead, path.gain) for path in two]


@pytest.mark.slow
def test_two_cables_chosen_one_by_one_are_nearly_the_best_pair() -> None:
    """A small strip to be bent: against every pair of all short paths, each with a winch of its own (linear model)."""
    robot = replace(strip_robot(columns=8, rows=2), cables=(), winches=())
    robot = replace(robot, markers=(Marker(name="tip", at=(0.2, 0.0)), Marker(name="middle", at=(0.1, 0.0))))
    graph = RouteGraph.build(robot, Region.of_body(robot.body, 0.004), Constraints(clearance=0.004), spacing=0.025)
    moves = strip_moves(graph, Simulation(robot))
    paths = [path for path in all_paths(graph, 3, 30.0) if path[0] < path[-1]]
    along = sums_along(graph, paths, moves)
    case = {
        "moves": moves,
        "residual": np.array([-0.006, 0.012, 0.001, -0.006]),  # the tip up, the middle down
        "pose_of_row": np.zeros(4, dtype=np.int64),
        "ridge": np.full(1, 1e-3 * float((along**2).sum(axis=1).max())),
        "most": 20.0,
    }
    limits = PathLimits(max_edges=3, turn=30.0)
    anywhere = {"winches": range(len(graph.points)), "count": 1}
    first = priced(graph, case, limits, **anywhere)[0]
    aim = first.moves / np.linalg.norm(first.moves)
    rest = case | {
        "moves": moves - np.outer(moves @ aim, aim),
        "residual": case["residual"] - (case["residual"] @ aim) * aim,
    }
    second = priced(graph, rest, limits, **anywhere)[0]
    chosen = joint_gain(sums_along(graph, [first.nodes, second.nodes], moves), case)
    best = max(joint_gain(along[list(pair)], case) for pair in combinations(range(len(paths)), 2))
    assert 0.9 * best < chosen <= best * (1 + 1e-9)
    assert chosen > 1.1 * first.gain


def strip_moves(graph: RouteGraph, simulation: Simulation) -> np.ndarray:
    nodes = simulation.rest.nodes
    slopes = np.kron(simulation.marker_anchors.matrix(len(nodes)).toarray(), np.eye(2))
    return graph.edge_moves(nodes, simulation.response(simulation.rest, slopes.T).reshape(*nodes.shape, -1))


def joint_gain(moves: np.ndarray, case: dict[str, Any]) -> float:
    """What two cables with their own winches gain together: by all ways in which tensions are at a limit or not."""
    stiff, pull = moves @ moves.T + case["ridge"][0] * np.eye(2), moves @ case["residual"]
    inner = np.linalg.solve(stiff, pull)
    if 0 <= inner.min() <= inner.max() <= case["most"]:
        return float(0.5 * pull @ inner)
    gains = []
    for free in (0, 1):
        for at in (0.0, case["most"]):
            tension = np.full(2, at)
            tension[free] = np.clip((pull[free] - stiff[0, 1] * at) / stiff[free, free], 0.0, case["most"])
            gains.append(float(pull @ tension - 0.5 * tension @ stiff @ tension))
    return max(gains)


@pytest.mark.slow
def test_loops_do_not_crowd_out_paths() -> None:
    """Where loops would pay, as in moves without any order, what is returned still is a path, and a good one."""
    ratios = []
    for seed in range(6):
        graph = cloud_graph(12, seed)
        case = made_case(graph, seed, most=0.01)
        aim = case["residual"] / np.linalg.norm(case["residual"])
        case["moves"] = np.random.default_rng(seed).normal(size=case["moves"].shape) + 0.5 * aim
        paths = [path for path in all_paths(graph, 7, 150.0) if path[0] == 5]
        best = decreases(sums_along(graph, paths, case["moves"]), case).max()
        found = priced(graph, case, PathLimits(max_edges=7, turn=150.0), winches=[5])
        assert {path.nodes for path in found} <= set(paths)
        ratios.append(found[0].gain / best)
    assert max(ratios) <= 1 + 1e-9
    assert min(ratios) > 0.97, ratios


@pytest.mark.parametrize("seed", range(3))
def test_the_next_unlike_path_by_sets_of_edges(seed: int) -> None:
    """Oracle: edges as sets of pairs of points."""
    draw = np.random.default_rng(seed)
    paths = np.full((60, 5), -1)
    for row in paths:
        count = draw.integers(2, 6)
        row[:count] = draw.permutation(7)[:count]
    usable = draw.random(len(paths)) < 0.7
    others, sets = paths[:3], [edge_set(path) for path in paths]

    def unlike(index: int, alike: float) -> bool:
        shares = [len(sets[index] & other) / min(len(sets[index]), len(other)) for other in sets[:3]]
        return bool(usable[index]) and max(shares) <= alike and not (others == paths[index]).all(axis=1).any()

    for alike in (0.3, 1.0):
        for begin in (0, 10, 59, 60):
            expected = next((index for index in range(begin, len(paths)) if unlike(index, alike)), len(paths))
            assert native.next_unlike(paths, begin, others, usable, alike) == expected


def edge_set(path: np.ndarray) -> set[frozenset[int]]:
    points = path[path >= 0].tolist()
    return {frozenset(pair) for pair in pairwise(points)}
