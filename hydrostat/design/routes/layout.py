"""`Layout`: winches and cables in the making, as numbers that can be moved."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Points, Vector
from hydrostat.design.constraints import Constraints
from hydrostat.robot import Cable, Mount, Robot, Winch


@dataclass(frozen=True, eq=False)
class WinchSite:
    """A winch in the making."""

    winch: Winch  # it, at its place
    fixed: bool = False  # whether it stays where it is
    # number of the winch that it mirrors; its own where it stands in the mirror; None: of no other
    twin: int | None = None


@dataclass(frozen=True, eq=False)
class CableRoute:
    """A cable in the making."""

    winch: int  # number of its winch
    points: Float[np.ndarray, "_ dim"]  # first = at the winch, last = stopper [m]
    lead: int = 0  # so many of its first segments run in a sheath
    slack: float = 0.0  # left by its stopper [m]
    ratio: float = 1.0  # of its spool to that of its winch; negative where it is wound the other way round
    make: Cable | None = None  # a cable whose stiffness, smoothing and friction it has; None: the usual ones
    kept: Cable | None = None  # a cable that stays just as it is
    twin: int | None = None  # number of the line that it mirrors; None: of no other


class Chains(NamedTuple):
    """Lines as lists of places, in the order in which the compiled core takes them."""

    begins: Int[np.ndarray, " _"]  # of each line in `members`, and their end
    members: Int[np.ndarray, " members"]  # places that the lines run through, one line after the other
    pulled: Int[np.ndarray, " lines"]  # winch of each line
    kept: Bool[np.ndarray, " lines"]  # whether a line stays as it is
    world: Bool[np.ndarray, " winches"]  # whether a winch stands in the world
    fixed: Bool[np.ndarray, " winches"]  # whether a winch stays where it is
    beside: Float[np.ndarray, " winches"]  # two spool radii [m]


class FreeRuns(NamedTuple):
    """Straight runs of lines from place to place."""

    first: Int[np.ndarray, " runs"]
    last: Int[np.ndarray, " runs"]
    number: Int[np.ndarray, " runs"]  # of the run in its line
    lead: Int[np.ndarray, " runs"]  # so many of the first runs of its line are sheathed
    entry: Float[np.ndarray, " runs"]  # so far from its beginning it may be as near the edge as it likes [m]


@dataclass(frozen=True, eq=False)
class Layout:
    """A network in the making.

    Its numbers, in their order: the places of the winches, the points of each line after its first, the slack of each
    line, the ratio of each line.

    Attributes:
        source: robot of the network.
        constraints: constraints of the network.
        sites: winches.
        routes: cables.
    """

    source: Robot
    constraints: Constraints
    sites: tuple[WinchSite, ...]
    routes: tuple[CableRoute, ...]

    @property
    def dim(self) -> int:
        """Dimensions of the body, 2 or 3."""
        return self.source.body.mesh.dim

    def robot(self, *, digits: int | None = None, limited: bool = False) -> Robot:
        """The robot with this network; coordinates rounded to some digits of a meter, or travels `limited`."""
        winches = [replace(site.winch, at=_point(site.winch.at, digits)) for site in self.sites]
        if limited:
            ranges = zip(winches, self.travels, self.releases, strict=True)
            winches = [replace(winch, travel=travel, release=release) for winch, travel, release in ranges]
        cables = []
        for route in self.routes:
            if route.kept is not None:
                cables.append(route.kept)
                continue
            winch = winches[route.winch]
            points = (winch.at, *(_point(point, digits) for point in route.points[1:]))
            slack, ratio = (value if digits is None else round(value, digits) for value in (route.slack, route.ratio))
            cables.append(
                replace(
                    route.make or Cable(winch=winch.name, points=points),
                    winch=winch.name,
                    points=points,
                    sheathed=((0, route.lead),) if route.lead else (),
                    slack=slack,
                    spool_radius=None if abs(ratio) == 1.0 else abs(ratio) * winch.spool_radius,
                    reverse=ratio < 0,
                )
            )
        return self.source.with_network(winches, cables)

    def turn_winches(self) -> "Layout":
        """The same layout, each winch paying out as far as its reversed cables need, if it has some."""
        back = {route.winch for route in self.routes if route.ratio < 0}
        sites = list(self.sites)
        for index, site in enumerate(sites):
            least, most = (self.constraints.reverse_release, np.inf) if index in back else (0, self.constraints.release)
            release = float(np.clip(site.winch.release, least, most))
            if not site.fixed and release != site.winch.release:
                sites[index] = replace(site, winch=replace(site.winch, release=release))
        return replace(self, sites=tuple(sites))

    @property
    def two_way(self) -> list[int]:
        """Numbers of the winches that pull cables wound both ways round."""
        ways = {(route.winch, route.ratio > 0) for route in self.routes}
        return [winch for winch in range(len(self.sites)) if {(winch, True), (winch, False)} <= ways]

    @cached_property
    def travels(self) -> list[float]:
        """Travel of each winch [m]; of new ones at most what squeezes the body as far as its material is known."""
        return self._limit_ranges([site.winch.travel for site in self.sites], 1)

    @cached_property
    def releases(self) -> list[float]:
        """Release of each winch [m]; of new ones that pull reversed cables at most what squeezes the body so far."""
        return self._limit_ranges([site.winch.release for site in self.sites], -1)

    def _limit_ranges(self, most: list[float], way: int) -> list[float]:
        """Return ranges of the winches, limited by cables that are wound one way, 1 or -1 [m]."""
        share = self.source.body.material.largest_squeeze
        for route in self.routes:
            if self.sites[route.winch].fixed or route.kept is not None or way * route.ratio < 0:
                continue
            inside = float(np.linalg.norm(np.diff(route.points[route.lead :], axis=0), axis=1).sum())
            squeezed = ((1.0 if share is None else share) * inside + route.slack) / abs(route.ratio)
            most[route.winch] = min(most[route.winch], max(squeezed - _MILLIMETER, _MILLIMETER))
        return most

    @cached_property
    def starts(self) -> list[int]:
        """Index of the first number of each line's points; then of slacks, and of ratios."""
        sizes = [self.dim * len(self.sites), *(self.dim * (len(route.points) - 1) for route in self.routes)]
        return [int(end) for end in np.cumsum([*sizes, len(self.routes)])]

    @property
    def size(self) -> int:
        """Count of the numbers."""
        return self.starts[-1] + len(self.routes)

    @property
    def places(self) -> Points:
        """Places of the winches, then of the points of each line after its first [m]."""
        return self.numbers[: self.starts[-2]].reshape(-1, self.dim)

    @cached_property
    def chains(self) -> Chains:
        """Lists of the `places` that the lines run through, and flags of lines and winches."""
        counts = [len(route.points) - 1 for route in self.routes]
        begins = np.concatenate([[0], np.cumsum(np.array(counts, dtype=np.int64) + 1)])
        members = [
            np.append(route.winch, start // self.dim + np.arange(count))
            for route, start, count in zip(self.routes, self.starts, counts, strict=False)
        ]
        winches = [site.winch for site in self.sites]
        return Chains(
            begins.astype(np.int64),
            np.concatenate([np.zeros(0, dtype=np.int64), *members]),
            np.array([route.winch for route in self.routes], dtype=np.int64),
            np.array([route.kept is not None for route in self.routes], dtype=bool),
            np.array([winch.mount is Mount.WORLD for winch in winches], dtype=bool),
            np.array([site.fixed for site in self.sites], dtype=bool),
            np.array([2 * winch.spool_radius for winch in winches], dtype=float),
        )

    @cached_property
    def free_runs(self) -> FreeRuns:
        """The straight runs of the lines that may move."""
        chain = self.chains
        first, last, number, lead, entry = [], [], [], [], []
        for index, route in enumerate(self.routes):
            if route.kept is not None:
                continue
            points = chain.members[chain.begins[index] : chain.begins[index + 1]].tolist()
            site, count = self.sites[route.winch], len(points) - 1
            free = np.inf if site.winch.mount is Mount.WORLD else self.constraints.clearance if site.fixed else 0.0
            first += points[:-1]
            last += points[1:]
            number += range(count)
            lead += [route.lead] * count
            entry += [free] + [0.0] * (count - 1)
        places = (np.array(part, dtype=np.int64) for part in (first, last, number, lead))
        return FreeRuns(*places, entry=np.array(entry, dtype=float))

    def place_of(self, route: int, point: int) -> slice:
        """The numbers of a point of a line."""
        begin = self.dim * self.routes[route].winch if point == 0 else self.starts[route] + self.dim * (point - 1)
        return slice(begin, begin + self.dim)

    @cached_property
    def numbers(self) -> Vector:
        """All of them."""
        parts = [np.ravel([site.winch.at for site in self.sites])]
        parts += [route.points[1:].ravel() for route in self.routes]
        parts += [[route.slack for route in self.routes], [route.ratio for route in self.routes]]
        return np.concatenate([np.asarray(part, dtype=float) for part in parts])

    def at(self, numbers: Vector) -> "Layout":
        """The same network with other numbers."""
        dim, slacks, ratios = self.dim, *self.starts[-2:]
        places = numbers[: dim * len(self.sites)].reshape(-1, dim)
        sites = tuple(
            replace(site, winch=replace(site.winch, at=tuple(map(float, place))))
            for site, place in zip(self.sites, places, strict=True)
        )
        routes = []
        for index, route in enumerate(self.routes):
            own = numbers[self.starts[index] : self.starts[index] + dim * (len(route.points) - 1)].reshape(-1, dim)
            routes.append(
                replace(
                    route,
                    points=np.vstack([places[route.winch], own]),
                    slack=max(float(numbers[slacks + index]), 0.0),
                    ratio=_clip_ratio(float(numbers[ratios + index]), way=route.ratio),
                )
            )
        moved = replace(self, sites=sites, routes=tuple(routes))
        moved.__dict__.update({name: getattr(self, name) for name in _SHARED})
        return moved

    @cached_property
    def ties(self) -> Float[np.ndarray, "numbers free"]:
        """Matrix from free numbers to all numbers: a fixed part has no column, a mirrored part follows its twin."""
        dim, slacks, ratios = self.dim, *self.starts[-2:]
        flip = self.constraints.flip(dim)
        full = np.eye(self.size)
        drop = np.zeros(self.size, dtype=bool)
        for index, site in enumerate(self.sites):
            rows = slice(dim * index, dim * (index + 1))
            if site.fixed or site.winch.mount is Mount.WORLD:
                drop[rows] = True
            elif site.twin == index:
                drop[rows] |= flip < 0
            elif site.twin is not None:
                _follow(full, drop, rows, slice(dim * site.twin, dim * (site.twin + 1)), flip)
        for index, route in enumerate(self.routes):
            count = len(route.points) - 1
            rows = slice(self.starts[index], self.starts[index] + dim * count)
            singles = [slacks + index, ratios + index]
            if route.kept is not None:
                drop[rows] = True
                drop[singles] = True
            elif route.twin is not None:
                twin = slice(self.starts[route.twin], self.starts[route.twin] + dim * count)
                _follow(full, drop, rows, twin, np.tile(flip, count))
                for base in (slacks, ratios):
                    _follow(
                        full,
                        drop,
                        slice(base + index, base + index + 1),
                        slice(base + route.twin, base + route.twin + 1),
                        1.0,
                    )
            if self.constraints.slack == 0.0:
                drop[slacks + index] = True
            if self.constraints.spool_ratio == 1.0:
                drop[ratios + index] = True
        return full[:, ~drop]


def _follow(full: np.ndarray, drop: np.ndarray, rows: slice, twin: slice, flip: Vector | float) -> None:
    """Rows that follow those of a twin."""
    full[rows, rows] = 0.0
    full[rows, twin] = np.eye(rows.stop - rows.start) * flip
    drop[rows] = True


def _clip_ratio(ratio: float, *, way: float) -> float:
    """A spool ratio that can be made, of the same sign as `way`."""
    size = float(np.clip(ratio if way > 0 else -ratio, 1 / Robot.MAX_RADIUS_RATIO, Robot.MAX_RADIUS_RATIO))
    return size if way > 0 else -size


def _point(coordinates: Vector | tuple[float, ...], digits: int | None) -> tuple[float, ...]:
    values = (float(value) for value in coordinates)
    return tuple(value if digits is None else round(value, digits) for value in values)


_MILLIMETER = 1e-3  # travels of a finished network are rounded down to it [m]
_SHARED = ("starts", "chains", "free_runs", "ties")  # what does not depend on the numbers
