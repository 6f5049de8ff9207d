"""`lay`: a path through the route graph as a line that can be sewn."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.design.polyline import resample
from hydrostat.design.region import Route
from hydrostat.design.routes.layout import Line
from hydrostat.design.routes.price import PricedPath
from hydrostat.design.routes.route_graph import RouteGraph


def lay(path: PricedPath, graph: RouteGraph, *, winch: int, place: Vector, spacing: float) -> Line | None:
    """A via point about every `spacing` along the bare path, as few as the body allows along the lead.

    Args:
        path: through the graph.
        graph: of via points.
        winch: number of the winch that pulls it.
        place: of that winch, at or near the first point of the path [m].
        spacing: of via points [m].

    Returns None for a path that is too short to have a via point.
    """
    bare, winch_point = graph.points[list(path.nodes)], path.winch
    lead = graph.points[list(path.lead)][:-1] if len(path.lead) > 1 else np.zeros((0, len(place)))
    if not len(lead):
        bare = np.vstack([place, bare[1:]])
    entry = 1 if graph.world[winch_point] and not len(lead) else 0
    run = np.vstack([bare[:entry], _smooth(bare[entry:], spacing)])
    if len(run) < 2 or np.linalg.norm(np.diff(run, axis=0), axis=1).min() < 1e-6:
        return None
    if not len(lead):
        return Line(winch, run)
    way = np.vstack([place, lead[1:], run[:1]])
    keep = 2 if graph.world[winch_point] else 1
    straight = _straightened(way, graph, keep)
    return Line(winch, np.vstack([straight, run]), lead=len(straight))


def _smooth(route: Route, spacing: float) -> Route:
    """At equal distances, less jagged than the graph."""
    fine = resample(route, spacing / 4)
    for _ in range(4):
        fine[1:-1] = 0.25 * fine[:-2] + 0.5 * fine[1:-1] + 0.25 * fine[2:]
    return resample(fine, spacing)


def _straightened(way: Route, graph: RouteGraph, keep: int) -> Route:
    """The first `keep` points of a way, then as few as see one another; without its end."""
    kept = list(range(keep))
    while kept[-1] < len(way) - 1:
        ahead = np.arange(len(way) - 1, kept[-1], -1)
        seen = graph.region.sees(np.repeat(way[kept[-1] : kept[-1] + 1], len(ahead), axis=0), way[ahead])
        kept.append(int(ahead[np.argmax(seen)]) if seen.any() else kept[-1] + 1)
    return way[kept[:-1]]
