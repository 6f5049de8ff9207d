"""`margins`: what the constraints leave a layout to move in, to first order."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Vector
from hydrostat.design.constraints import Constraints
from hydrostat.design.polyline import nearest_shares
from hydrostat.design.region import Region
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.runs import Runs, runs_of
from hydrostat.design.zone import Zone
from hydrostat.robot import Mount


class Margins(NamedTuple):
    """Limits on a change d of the numbers of a layout: rows d <= left [m]."""

    rows: Float[np.ndarray, "limits numbers"]
    left: Float[np.ndarray, " limits"]


def margins(layout: Layout, region: Region, *, reach: float) -> Margins:
    """All limits that a layout is within `reach` [m] of, as far as anything will move, with a hair of margin each."""
    return _MarginRows(layout, region, reach).found()


class _MarginRows:
    def __init__(self, layout: Layout, region: Region, reach: float) -> None:
        self.layout, self.region, self.reach = layout, region, reach
        self.constraints: Constraints = layout.constraints
        self.rows: list[np.ndarray] = []
        self.left: list[float] = []

    def found(self) -> Margins:
        self._winches()
        self._edges()
        self._gaps()
        self._crossings()
        self._turns()
        self._lengths()
        self._bounds()
        rows = np.array(self.rows).reshape(-1, self.layout.size)
        return Margins(rows, np.array(self.left))

    def _add(self, left: float, *parts: tuple[slice, Vector]) -> None:
        if left > self.reach:
            return
        row = np.zeros(self.layout.size)
        for place, slope in parts:
            row[place] += slope
        if row.any():
            self.rows.append(row)
            self.left.append(left)

    def _winches(self) -> None:
        """Winches in the body: deep enough, apart, and in a zone where they may be."""
        layout, dim = self.layout, self.layout.dim
        places = np.array([site.winch.at for site in layout.sites])
        inner = [i for i, site in enumerate(layout.sites) if site.winch.mount is Mount.BODY and not site.fixed]
        if not inner:
            return
        depths, ways = self.region.depths_and_ways(places[inner])
        for index, depth, way in zip(inner, depths, ways, strict=True):
            own = slice(dim * index, dim * (index + 1))
            need = max(self.constraints.winch_clearance, self.constraints.clearance)
            self._add(depth - need - _HAIR, (own, -way))
            self._zones(places[index], own)
            for other in range(len(layout.sites)):
                if other == index or (other in inner and other < index):
                    continue
                self._apart(places[index], own, places[other], slice(dim * other, dim * (other + 1)),
                    self.constraints.winch_gap)  # fmt: skip

    def _zones(self, place: Vector, own: slice) -> None:
        zones = self.constraints.winch_zones
        if zones:
            away = [float(zone.distances(place[None])[0]) for zone in zones]
            nearest = int(np.argmin(away))
            self._add(-away[nearest] - _HAIR, (own, zones[nearest].away(place[None])[0]))

    def _edges(self) -> None:
        """Points a clearance from the edge, segments half of it; both outside forbidden zones."""
        spots = _spots(self.layout, 0.5 * self.constraints.clearance)
        if not len(spots.shares):
            return
        places = spots.places(self.layout.numbers, self.layout.dim)
        hole, (least, most), (lowest, deepest) = spots.shares == 0.0, self.region.hole_band, self.region.run_band
        depths, ways = self.region.depths_and_ways(places)
        needs = np.where(hole, least + _HAIR, lowest + _SHY * abs(lowest))
        self._within(spots, depths - needs, ways)
        if np.isfinite(deepest):  # a layer under the skin
            limits = np.where(hole, most - _HAIR, deepest - _SHY * abs(deepest))
            self._within(spots, limits - depths, -ways)
        for zone in self.constraints.keep_out:
            self._outside(zone, spots)
        for zone in self.constraints.still:
            self._outside(zone, spots.chosen(np.flatnonzero(spots.bare)))

    def _within(self, spots: "_Spots", lefts: Vector, ways: Float[np.ndarray, "spots dim"]) -> None:
        """Rows for places that are near a limit, but for those where a cable may be as near the edge as it likes."""
        near = np.flatnonzero(~spots.entry & (lefts <= self.reach))
        if len(near):
            self._add_spots(spots.chosen(near), lefts[near], ways[near])

    def _outside(self, zone: Zone, spots: "_Spots") -> None:
        """Those places, and between them the ones nearest to the zone: a small zone would pass between two."""
        near = _nearest(zone, spots, self.layout.numbers, self.layout.dim)
        places = near.places(self.layout.numbers, self.layout.dim)
        away = zone.distances(places) - _HAIR
        close = np.flatnonzero(away <= self.reach)
        if len(close):
            self._add_spots(near.chosen(close), away[close], zone.away(places[close]))

    def _add_spots(self, spots: "_Spots", lefts: Vector, ways: Float[np.ndarray, "spots dim"]) -> None:
        """Places along cables must not move against `ways` farther than what is left."""
        rows = np.zeros((len(lefts), self.layout.size))
        every = np.arange(len(lefts))[:, None], np.arange(self.layout.dim)
        rows[every[0], spots.starts[:, None] + every[1]] -= (1 - spots.shares)[:, None] * ways
        rows[every[0], spots.ends[:, None] + every[1]] -= spots.shares[:, None] * ways
        self.rows += list(rows)
        self.left += lefts.tolist()

    def _gaps(self) -> None:
        """Holes apart; those of other winches' cables outside a winch."""
        layout, gap = self.layout, self.constraints.hole_gap
        spots = [(index, point) for index, route in enumerate(layout.routes) for point in range(1, len(route.points))]
        owners = np.array([index for index, _ in spots])
        where = [layout.place_of(*spot) for spot in spots]
        places = np.concatenate([route.points[1:] for route in layout.routes])
        away = np.linalg.norm(places[:, None] - places[None], axis=2)
        shared = (away < 1e-6) & (owners[:, None] != owners)
        stays = np.array([layout.routes[index].kept is not None for index in owners])
        seen = ~shared & ~(stays[:, None] & stays)
        for one, other in np.argwhere(np.triu((away < gap + self.reach) & seen, 1)):
            self._apart(places[one], where[one], places[other], where[other], gap)
        pulled = np.array([layout.routes[index].winch for index in owners])
        for number, site in enumerate(layout.sites):
            if site.winch.mount is Mount.WORLD:
                continue
            centre, own = np.array(site.winch.at), slice(layout.dim * number, layout.dim * (number + 1))
            needs = np.where(pulled == number, gap, 2 * site.winch.spool_radius)
            free = ~(stays & site.fixed)
            for hole in np.flatnonzero(free & (np.linalg.norm(places - centre, axis=1) < needs + self.reach)):
                self._apart(places[hole], where[hole], centre, own, float(needs[hole]))

    def _crossings(self) -> None:
        """Cables apart from each other and from winches of others, all along: none cross, none lie side by side."""
        gap = self.constraints.cable_gap
        if gap == 0.0:
            return
        layout, runs = self.layout, runs_of(self.layout)
        one, other = np.triu_indices(len(runs.routes), 1)
        asked = ((runs.routes[one] != runs.routes[other]) | (other > one + 1)) & ~(runs.kept[one] & runs.kept[other])
        one, other = one[asked], other[asked]
        middles, halves = runs.ends.mean(axis=1), 0.5 * np.linalg.norm(np.diff(runs.ends, axis=1)[:, 0], axis=1)
        near = np.linalg.norm(middles[one] - middles[other], axis=1) < halves[one] + halves[other] + gap + self.reach
        one, other = one[near], other[near]
        shares = nearest_shares(runs.ends[one], runs.ends[other])
        places = [runs.at(which, share) for which, share in zip((one, other), shares, strict=True)]
        shared = (runs.winches[one] == runs.winches[other]) & (runs.routes[one] != runs.routes[other])
        radii = np.array([2 * site.winch.spool_radius for site in layout.sites])
        centres = np.array([site.winch.at for site in layout.sites])
        for places_of in places:
            away = np.linalg.norm(places_of - centres[runs.winches[one]], axis=1)
            shared &= away < radii[runs.winches[one]] - 1e-6
        for k in np.flatnonzero(~shared & (np.linalg.norm(places[0] - places[1], axis=1) < gap + self.reach)):
            self._runs_apart(runs, (int(one[k]), places[0][k]), (int(other[k]), places[1][k]), gap)
        for number, site in enumerate(layout.sites):
            if site.winch.mount is Mount.WORLD:
                continue
            foreign = np.flatnonzero((runs.winches != number) & ~(runs.kept & site.fixed))
            spot = np.repeat(centres[number][None, None], len(foreign), axis=0).repeat(2, axis=1)
            nearest = runs.at(foreign, nearest_shares(runs.ends[foreign], spot)[0])
            own = slice(layout.dim * number, layout.dim * (number + 1))
            for run, place in zip(foreign.tolist(), nearest, strict=True):
                self._runs_apart(runs, (run, place), (own, centres[number]), float(radii[number]))

    def _runs_apart(self, runs: "Runs", one: tuple[int, Vector], other: tuple[int | slice, Vector], gap: float) -> None:
        """Two places of cables, or of a cable and a winch, at least a gap apart."""
        span = one[1] - other[1]
        distance = float(np.linalg.norm(span))
        if distance - gap - _HAIR > self.reach:
            return
        way = span / distance if distance > 1e-9 else np.eye(len(span))[0]
        parts = runs.parts(one[0], one[1], -way)
        parts += [(other[0], way)] if isinstance(other[0], slice) else runs.parts(other[0], other[1], way)
        self._add(distance - gap - _HAIR, *parts)

    def _apart(self, one: Vector, where: slice, other: Vector, there: slice, gap: float) -> None:
        span = one - other
        distance = float(np.linalg.norm(span))
        way = span / distance if distance > 1e-9 else np.eye(len(span))[0]
        self._add(distance - gap - _HAIR, (where, -way), (there, way))

    def _turns(self) -> None:
        """No turn sharper than allowed, no arc tighter; slopes by central differences of the three points."""
        turn, radius = np.radians(self.constraints.turn - _DEGREE), self.constraints.bend_radius
        for index, route in enumerate(self.layout.routes):
            if route.kept is not None or len(route.points) < 3:
                continue
            corners = np.stack([route.points[:-2], route.points[1:-1], route.points[2:]], axis=1)
            for kind in ("turn", "radius") if radius > 0 else ("turn",):
                margin, limit = (_turn_margin, turn) if kind == "turn" else (_radius_margin, radius)
                values = margin(corners, limit)
                if kind == "turn" and self.layout.sites[route.winch].winch.mount is Mount.WORLD:
                    values[0] = np.inf  # where it enters: the tube outside hangs as it likes
                near = np.flatnonzero(values <= self.reach)
                slopes = _sloped(corners[near], margin, limit)
                for corner, slope in zip(near.tolist(), slopes, strict=True):
                    parts = ((self.layout.place_of(index, corner + k), -slope[k]) for k in range(3))
                    self._add(float(values[corner]), *parts)

    def _lengths(self) -> None:
        longest = self.constraints.longest
        if longest is None:
            return
        for index, route in enumerate(self.layout.routes):
            if route.kept is None:
                spans = np.diff(route.points, axis=0)
                lengths = np.linalg.norm(spans, axis=1)
                units = spans / lengths[:, None]
                parts = [(self.layout.place_of(index, k), -units[k]) for k in range(len(units))]
                parts += [(self.layout.place_of(index, k + 1), units[k]) for k in range(len(units))]
                self._add(longest - float(lengths.sum()) - _HAIR, *parts)

    def _bounds(self) -> None:
        """Bounds of slack and spool ratios."""
        slacks, ratios = self.layout.starts[-2:]
        most = self.constraints.spool_ratio
        for index, route in enumerate(self.layout.routes):
            for place, value, low, high in (
                (slacks + index, route.slack, 0.0, self.constraints.slack),
                (ratios + index, route.ratio, 1 / most, most),
            ):
                own = slice(place, place + 1)
                for sign, left in ((1.0, high - value), (-1.0, value - low)):
                    self.rows.append(_unit(self.layout.size, own, sign))
                    self.left.append(left)


class _Spots(NamedTuple):
    """Places along cables: on the way from one point of a cable to another, by where their numbers begin.

    `entry` are those that may be near the edge: outside the body, or near a winch that stays.
    """

    starts: Int[np.ndarray, " spots"]
    ends: Int[np.ndarray, " spots"]
    shares: Vector
    bare: np.ndarray
    entry: np.ndarray
    widths: Vector

    def places(self, numbers: Vector, dim: int) -> Float[np.ndarray, "spots dim"]:
        """Positions by the numbers of the layout [m]."""
        starts, ends = (numbers[side[:, None] + np.arange(dim)] for side in (self.starts, self.ends))
        return starts + self.shares[:, None] * (ends - starts)

    def chosen(self, which: np.ndarray) -> "_Spots":
        """Some of them."""
        return _Spots(*(part[which] for part in self))


def _spots(layout: Layout, spacing: float) -> _Spots:
    """Every point of a cable but those that stay, and places about every `spacing` between them."""
    parts = []
    for index, route in enumerate(layout.routes):
        if route.kept is not None:
            continue
        site = layout.sites[route.winch]
        free = np.inf if site.winch.mount is Mount.WORLD else layout.constraints.clearance if site.fixed else 0.0
        lengths = np.linalg.norm(np.diff(route.points, axis=0), axis=1)
        counts = np.clip(np.ceil(lengths / spacing) - 1, 1, _MOST).astype(np.int64)
        begins = layout.starts[index] + layout.dim * np.arange(-1, len(lengths))
        begins[0] = layout.dim * route.winch
        point = np.repeat(np.arange(len(counts)), counts + 1)  # each has its end first, then the places before that
        place = np.arange(len(point)) - np.repeat(np.cumsum(counts + 1) - (counts + 1), counts + 1)
        hole = place == 0
        own = place / (counts + 1)[point]
        parts.append(
            _Spots(
                starts=np.where(hole, begins[point + 1], begins[point]),
                ends=begins[point + 1],
                shares=own,
                bare=np.where(hole, point + 1 > route.lead, point >= route.lead),
                entry=~hole & (own * lengths[point] < free) & (point == 0),
                widths=np.where(hole, 0.0, 1.0 / (counts + 1)[point]),
            )
        )
    if not parts:
        none, flags = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=bool)
        return _Spots(none, none, np.zeros(0), flags, flags, np.zeros(0))
    return _Spots(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def _nearest(zone: Zone, spots: _Spots, numbers: Vector, dim: int) -> _Spots:
    """Each place, moved along its segment to where it is nearest to a zone; those in holes stay.

    A place moves as far as to its neighbours, where a distance along a straight line has one dip as long as it is
    nearer to one side of the zone than to others: by golden sections.
    """
    low, high = spots.shares - spots.widths, spots.shares + spots.widths
    for _ in range(_SECTIONS):
        left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        nearer = zone.distances(spots._replace(shares=left).places(numbers, dim)) < zone.distances(
            spots._replace(shares=right).places(numbers, dim)
        )
        low, high = np.where(nearer, low, left), np.where(nearer, right, high)
    return spots._replace(shares=0.5 * (low + high))


_HAIR = 5e-5  # kept back from every limit on a length [m]: more than what rounding coordinates changes
_SHY = 0.2  # share of the limit along a straight run that is kept back from it: it is watched at some places only
_DEGREE = 0.5  # kept back from the largest turn

_STEP = 1e-7

_MOST = 500  # places between two points: a layout that cannot be pushed back may have flown far apart

_GOLDEN = 0.5 * (5**0.5 - 1)

_SECTIONS = 16  # leave a two-thousandth of where the nearest place may be


def _unit(size: int, own: slice, sign: float) -> Vector:
    row = np.zeros(size)
    row[own] = sign
    return row


def _sloped(
    corners: Float[np.ndarray, "corners 3 dim"], margin: Callable[[np.ndarray, float], Vector], limit: float
) -> Float[np.ndarray, "corners 3 dim"]:
    """Slopes of the margin of each corner by its three points, by central differences of all of them at once."""
    if not len(corners):
        return corners
    steps = _STEP * np.eye(corners[0].size).reshape(-1, 1, *corners.shape[1:])
    ends = [margin((corners + way * steps).reshape(-1, *corners.shape[1:]), limit) for way in (1, -1)]
    return ((ends[0] - ends[1]) / (2 * _STEP)).reshape(-1, len(corners)).T.reshape(corners.shape)


def _angles(corners: Float[np.ndarray, "corners 3 dim"]) -> tuple[Vector, Vector]:
    """Turn of each corner, and the shorter of its two segments [m]."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 1]
    lengths = np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1)
    cosines = (first * second).sum(axis=1) / np.maximum(lengths[0] * lengths[1], 1e-300)
    return np.arccos(np.clip(cosines, -1.0, 1.0)), np.minimum(*lengths)


def _turn_margin(corners: Float[np.ndarray, "corners 3 dim"], turn: float) -> Vector:
    """Margin of the angle times the shorter segment, as a length [m]."""
    angles, shorter = _angles(corners)
    return (turn - angles) * shorter


def _radius_margin(corners: Float[np.ndarray, "corners 3 dim"], radius: float) -> Vector:
    angles, shorter = _angles(corners)
    return 0.5 * shorter - radius * np.tan(0.5 * np.minimum(angles, 3.0))
