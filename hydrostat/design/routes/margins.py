"""`margins`: what the constraints leave a layout to move in, to first order."""

from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Float, Int, Points, Vector
from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.design.routes.hairpins import hairpin_margins
from hydrostat.design.routes.layout import Layout
from hydrostat.design.zone import Zone
from hydrostat.kernel import native
from hydrostat.robot import Mount


class Margins(NamedTuple):
    """Limits on a change d of the numbers of a layout: rows d <= left [m]."""

    rows: Float[np.ndarray, "limits numbers"]
    left: Float[np.ndarray, " limits"]


def margins(layout: Layout, region: Region, *, reach: float) -> Margins:
    """All limits that a layout is within `reach` [m] of, as far as anything will move, with a hair of margin each."""
    return _MarginRows(layout, region, reach).collect()


class _MarginRows:
    def __init__(self, layout: Layout, region: Region, reach: float) -> None:
        self.layout, self.region, self.reach = layout, region, reach
        self.constraints: Constraints = layout.constraints
        self.found_rows: list[np.ndarray] = []
        self.found_left: list[Vector] = []

    def collect(self) -> Margins:
        """Collect all margins: by depth and zones, of ways back, between parts of the network, of slack and spools."""
        self._depths()
        for row, left in hairpin_margins(self.layout, reach=self.reach, hair=_ROUNDING_MARGIN, degrees=_DEGREE):
            self.found_rows.append(row[None])
            self.found_left.append(np.array([left]))
        for part in (self._between_parts(), self._bounds()):
            self.found_rows.append(part.rows)
            self.found_left.append(part.left)
        return Margins(np.concatenate(self.found_rows), np.concatenate(self.found_left))

    def _depths(self) -> None:
        """Winches and cables deep enough in the body, winches in their zones, cables outside theirs."""
        layout, dim = self.layout, self.layout.dim
        inner = np.array(
            [i for i, site in enumerate(layout.sites) if site.winch.mount is Mount.BODY and not site.fixed]
        )
        spots = _spots(layout, 0.5 * self.constraints.clearance)
        winches = layout.places[inner] if len(inner) else np.zeros((0, dim))
        places = spots.places(layout.numbers, dim)
        if not len(places) + len(winches):
            return
        depths, ways = self.region.depths_and_ways(np.concatenate([winches, places]))
        if len(inner):
            need = max(self.constraints.winch_clearance, self.constraints.clearance)
            self._add_spots(
                _winch_spots(dim * inner), depths[: len(inner)] - need - _ROUNDING_MARGIN, ways[: len(inner)]
            )
            self._zones(winches, _winch_spots(dim * inner))
        if len(places):
            self._edges(spots, depths[len(inner) :], ways[len(inner) :])

    def _zones(self, places: Points, winches: "_Spots") -> None:
        if self.constraints.winch_zones:
            distances, ways = self.constraints.winch_area.measure(places)
            self._add_spots(winches, -distances - _ROUNDING_MARGIN, -ways)

    def _edges(self, spots: "_Spots", depths: Vector, ways: Points) -> None:
        """Points a clearance from the edge, segments half of it; both outside forbidden zones."""
        hole, (least, most), (lowest, deepest) = spots.shares == 0.0, self.region.hole_band, self.region.run_band
        needs = np.where(hole, least + _ROUNDING_MARGIN, lowest + _SHY * abs(lowest))
        self._within(spots, depths - needs, ways)
        if np.isfinite(deepest):  # a layer under the skin
            limits = np.where(hole, most - _ROUNDING_MARGIN, deepest - _SHY * abs(deepest))
            self._within(spots, limits - depths, -ways)
        for zone in self.constraints.keep_out:
            self._outside(zone, spots)
        for zone in self.constraints.passive_zones:
            self._outside(zone, spots.select(np.flatnonzero(spots.bare)))

    def _within(self, spots: "_Spots", lefts: Vector, ways: Points) -> None:
        """Rows for places that are near a limit, but for those where a cable may be as near the edge as it likes."""
        free = np.flatnonzero(~spots.entry)
        self._add_spots(spots.select(free), lefts[free], ways[free])

    def _outside(self, zone: Zone, spots: "_Spots") -> None:
        """Those places, and between them the ones nearest to the zone: a small zone would pass between two."""
        near = _nearest(zone, spots, self.layout.numbers, self.layout.dim)
        places = near.places(self.layout.numbers, self.layout.dim)
        self._add_spots(near, zone.distances(places) - _ROUNDING_MARGIN, zone.away(places))

    def _add_spots(self, spots: "_Spots", lefts: Vector, ways: Points) -> None:
        """Places along cables within reach of a limit must not move against `ways` farther than what is left."""
        near = np.flatnonzero(lefts <= self.reach)
        if not len(near):
            return
        spots, lefts, ways = spots.select(near), lefts[near], ways[near]
        rows = np.zeros((len(lefts), self.layout.size))
        every = np.arange(len(lefts))[:, None], np.arange(self.layout.dim)
        rows[every[0], spots.starts[:, None] + every[1]] -= (1 - spots.shares)[:, None] * ways
        rows[every[0], spots.ends[:, None] + every[1]] -= spots.shares[:, None] * ways
        self.found_rows.append(rows)
        self.found_left.append(lefts)

    def _between_parts(self) -> Margins:
        """Winches, holes and cables apart from each other; turns and lengths of cables."""
        layout, own = self.layout, self.constraints
        longest = np.inf if own.max_length is None else own.max_length
        turn = np.radians(own.max_turn - _DEGREE)
        limits = [
            own.winch_gap,
            own.hole_gap,
            own.cable_gap,
            turn,
            own.bend_radius,
            longest,
            self.reach,
            _ROUNDING_MARGIN,
        ]
        room = _ROOM
        while True:
            rows, left = np.empty((room, layout.size)), np.empty(room)
            count = native.network_limits(layout.places, *layout.chains, np.array(limits), rows, left)
            if count <= room:
                return Margins(rows[:count], left[:count])
            room = count

    def _bounds(self) -> Margins:
        """Bounds of slack and spool ratios."""
        slacks, ratios = self.layout.starts[-2:]
        values, most = self.layout.numbers[slacks:], self.constraints.spool_ratio
        count = ratios - slacks
        back = values[count:] < 0
        low = np.concatenate([np.zeros(count), np.where(back, -most, 1 / most)])
        high = np.concatenate([np.full(count, self.constraints.slack), np.where(back, -1 / most, most)])
        rows = np.zeros((2 * len(values), self.layout.size))
        rows[:, slacks:] = np.vstack([np.eye(len(values)), -np.eye(len(values))])
        return Margins(rows, np.concatenate([high - values, values - low]))


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

    def select(self, which: np.ndarray) -> "_Spots":
        """Select some spots."""
        return _Spots(*(part[which] for part in self))


def _winch_spots(starts: Int[np.ndarray, " winches"]) -> _Spots:
    """Return winches as spots whose numbers begin there."""
    none, flags = np.zeros(len(starts)), np.zeros(len(starts), dtype=bool)
    return _Spots(starts, starts, none, flags, flags, none)


def _spots(layout: Layout, spacing: float) -> _Spots:
    """Every point of a cable but those that stay, and places about every `spacing` between them."""
    run = layout.free_runs
    spans = layout.places[run.last] - layout.places[run.first]
    lengths = np.sqrt((spans**2).sum(axis=1))
    counts = np.clip(np.ceil(lengths / spacing) - 1, 1, _MAX_PLACES).astype(np.int64) + 1
    owner = np.repeat(np.arange(len(counts)), counts)  # each has its end first, then the places before that
    place = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    hole = place == 0
    widths = 1.0 / counts[owner]
    shares = place * widths
    first, last = layout.dim * run.first[owner], layout.dim * run.last[owner]
    return _Spots(
        starts=np.where(hole, last, first),
        ends=last,
        shares=shares,
        bare=run.number[owner] >= run.lead[owner],
        entry=~hole & (shares * lengths[owner] < run.entry[owner]),
        widths=np.where(hole, 0.0, widths),
    )


def _nearest(zone: Zone, spots: _Spots, numbers: Vector, dim: int) -> _Spots:
    """Each place, moved along its segment to where it is nearest to a zone; those in holes stay.

    A place moves as far as to its neighbors, where a distance along a straight line has one dip as long as it is
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


_ROUNDING_MARGIN = 5e-5  # kept back from every limit on a length [m]: more than what rounding coordinates changes
_SHY = 0.2  # share of the limit along a straight run that is kept back from it: it is watched at some places only
_DEGREE = 0.5  # kept back from the largest turn

_MAX_PLACES = 500  # places between two points: a layout that cannot be pushed back may have flown far apart

_GOLDEN = 0.5 * (5**0.5 - 1)

_SECTIONS = 16  # leave a two-thousandth of where the nearest place may be

_ROOM = 256  # limits that there is room for at first
