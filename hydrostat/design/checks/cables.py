"""`clearance_violations`, `hole_violations`, `bend_violations`: where cables run, their holes, how they turn."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Bool, Float, Int
from hydrostat.design.checks.parts import ANGLE, LENGTH, Parts, mm, place
from hydrostat.design.drawn_shapes import drawn_zones
from hydrostat.design.polyline import least_along, nearest_shares
from hydrostat.design.zone import Zone
from hydrostat.robot import Mount


@dataclass(frozen=True, eq=False)
class _Segments:
    """The segments of all new cables."""

    cables: Int[np.ndarray, " segments"]  # number of the cable of each
    firsts: Int[np.ndarray, " segments"]  # number of the point at which each begins
    starts: Float[np.ndarray, "segments dim"]  # [m]
    ends: Float[np.ndarray, "segments dim"]  # [m]
    bare: Bool[np.ndarray, " segments"]  # whether each is without a sheath

    def name(self, index: int | np.integer) -> str:
        """A segment as a sentence begins with it."""
        first = self.firsts[index]
        return f"cable[{self.cables[index]}] between points {first} and {first + 1}"


def clearance_violations(parts: Parts) -> Iterator[str]:
    """Points and segments near the edge, segments in forbidden zones, bare ones in passive zones, needless sheaths."""
    if not parts.new_cables:
        return
    segments = _segments(parts)
    yield from _near_the_edge_at_points(parts)
    yield from _near_the_edge(parts, segments)
    drawn = drawn_zones(parts.robot.body, parts.constraints.drawing_gap)
    for number, zone in enumerate(parts.constraints.keep_out):
        every = np.ones(len(segments.bare), dtype=bool)
        what = "within drawing_gap of a drawn shape" if zone in drawn else f"inside keep_out[{number}]"
        yield from _through(segments, zone, what, "Reroute it", every)
    for number, zone in enumerate(parts.constraints.passive_zones):
        yield from _through(
            segments, zone, f"no sheath in passive_zones[{number}]", "Sheathe or reroute it", segments.bare
        )
    if not parts.constraints.leads:
        yield from _sheathed_for_nothing(parts, segments)


def _segments(parts: Parts) -> _Segments:
    cables = parts.new_cables
    counts = [len(parts.points[index]) - 1 for index in cables]
    return _Segments(
        cables=np.repeat(np.array(cables, dtype=np.int64), counts),
        firsts=np.concatenate([np.arange(count) for count in counts]),
        starts=np.concatenate([parts.points[index][:-1] for index in cables]),
        ends=np.concatenate([parts.points[index][1:] for index in cables]),
        bare=np.concatenate([parts.robot.cables[index].bare for index in cables]),
    )


def _given_points(parts: Parts, index: int) -> int:
    """Return the number of first points that are given: in the world and at the entry, or at a locked winch."""
    cable = parts.robot.cables[index]
    if parts.outside(cable):
        return 2
    return 0 if parts.numbers[cable.winch] in parts.new_winches else 1


def _near_the_edge_at_points(parts: Parts) -> Iterator[str]:
    least, most = parts.region.hole_band
    lengths = {index: len(parts.points[index]) for index in parts.new_cables}
    asked = [(index, at) for index, count in lengths.items() for at in range(_given_points(parts, index), count)]
    if not asked:
        return
    depths = parts.region.depths(np.array([parts.points[index][at] for index, at in asked]))
    worst = np.argsort(-np.maximum(least - depths, depths - most), kind="stable")  # first: reviews print that one alone
    for number in worst:
        (index, at), depth = asked[number], float(depths[number])
        if depth < least - LENGTH and index not in parts.sewn:
            yield (
                f"{_hole_name((index, at))}: low clearance ({parts.within(depth)}, "
                f"at {place(parts.points[index][at])}). Minimum {_limit(parts, least)}. Move it inward."
            )
        elif depth > most + LENGTH:
            yield (
                f"{_hole_name((index, at))}: too deep ({parts.within(depth)}, at {place(parts.points[index][at])}). "
                f"Maximum {_limit(parts, most)}. Move it outward."
            )


def _limit(parts: Parts, depth: float) -> str:
    """Return the limit that a point keeps, in words."""
    wanted = parts.constraints.depth
    return f"clearance: {mm(depth)}" if wanted is None else f"at a depth of {mm(wanted)}: {mm(depth)}"


def _near_the_edge(parts: Parts, segments: _Segments) -> Iterator[str]:
    """Half the clearance; a segment from a given point counts from a clearance away from there."""
    clearance = parts.constraints.clearance
    given = np.array([_given_points(parts, index) for index in range(len(parts.robot.cables))])[segments.cables]
    starts, spans = segments.starts.copy(), segments.ends - segments.starts
    lengths = np.linalg.norm(spans, axis=1)
    late = segments.firsts == given - 1
    starts[late] += (clearance / lengths[late])[:, None] * spans[late]
    asked = np.flatnonzero((segments.firsts >= given) | (late & (lengths > clearance)))
    least, most = parts.region.run_band
    skin = parts.constraints.depth is not None
    found = least_along(parts.region.depths, starts[asked], segments.ends[asked], least - LENGTH, resolution=1e-4)
    for index, depth in zip(asked, found, strict=True):
        if depth < least - LENGTH and segments.cables[index] not in parts.sewn:
            allowed = f"Minimum {_limit(parts, least)}" if skin else f"Minimum: half the clearance of {mm(clearance)}"
            yield f"{segments.name(index)}: low clearance ({parts.within(depth)}). {allowed}. Reroute it."
    if not skin:
        return
    found = least_along(
        lambda places: -parts.region.depths(places), starts[asked], segments.ends[asked], -most - LENGTH,
        resolution=1e-4,
    )  # fmt: skip
    for index, depth in zip(asked, -found, strict=True):
        if depth > most + LENGTH:
            allowed = f"Maximum {_limit(parts, most)}"
            yield f"{segments.name(index)}: too deep ({parts.within(depth)}). {allowed}. Add a point between."


def _through(
    segments: _Segments, zone: Zone, what: str, fix: str, asked: Bool[np.ndarray, " segments"]
) -> Iterator[str]:
    chosen = np.flatnonzero(asked)
    found = zone.least(segments.starts[chosen], segments.ends[chosen], limit=-LENGTH)
    for index, away in zip(chosen, found, strict=True):
        if away < -LENGTH:
            yield f"{segments.name(index)}: {what} ({mm(-away)} deep). Allowed: outside. {fix}."


def _sheathed_for_nothing(parts: Parts, segments: _Segments) -> Iterator[str]:
    chosen = np.flatnonzero(~segments.bare)
    starts, ends = segments.starts[chosen], segments.ends[chosen]
    needed = np.zeros(len(chosen), dtype=bool)
    for zone in parts.constraints.passive_zones:
        needed |= zone.least(starts, ends, limit=LENGTH) < LENGTH
    for index in chosen[~needed]:
        yield (
            f"{segments.name(index)}: sheath outside passive zones. Not allowed without leads. "
            "Remove it or allow leads."
        )


HOLE_TOLERANCE = 1e-5  # points no farther apart than this [m] share a hole
Hole = tuple[int, int]  # a hole: number of the cable, and of its point


def hole_violations(parts: Parts) -> Iterator[str]:
    """Via points, but first ones, too near to each other, or to a winch in the body that pulls other cables."""
    cables = parts.robot.cables
    holes = [(index, at) for index, cable in enumerate(cables) for at in range(1, len(cable.points))]
    if not holes:
        return
    places = np.concatenate([points[1:] for points in parts.points])
    new = np.isin([index for index, _ in holes], parts.new_cables)
    yield from _holes_near_each_other(parts, holes, places, new)
    yield from _holes_near_winches(parts, holes, places, new)


def _holes_near_each_other(
    parts: Parts, holes: list[tuple[int, int]], places: np.ndarray, new: np.ndarray
) -> Iterator[str]:
    least = parts.constraints.hole_gap
    gaps = np.linalg.norm(places[:, None] - places, axis=2)
    close = (gaps < least - LENGTH) & (gaps > HOLE_TOLERANCE * (1 + 1e-6)) & (new[:, None] | new)
    for one, other in np.argwhere(np.triu(close, 1)):
        yield (
            f"{_hole_name(holes[other])}: too close to {_hole_name(holes[one])} ({mm(gaps[one, other])}). "
            f"Minimum hole_gap: {mm(least)}. Move them apart."
        )


def _holes_near_winches(
    parts: Parts, holes: list[tuple[int, int]], places: np.ndarray, new: np.ndarray
) -> Iterator[str]:
    owners = np.array([parts.numbers[parts.robot.cables[index].winch] for index, _ in holes])
    for number, winch in enumerate(parts.robot.winches):
        if winch.mount is Mount.WORLD:
            continue
        gaps = np.linalg.norm(places - np.array(winch.at), axis=1)
        least = 2 * winch.spool_radius
        asked = (owners != number) & (new | (number in parts.new_winches))
        for index in np.flatnonzero(asked & (gaps < least - LENGTH)):
            yield (
                f"{_hole_name(holes[index])}: too close to {parts.winch_name(number)} of other cables "
                f"({mm(gaps[index])}). Minimum: two spool radii, {mm(least)}. Move it away."
            )


def _hole_name(hole: Hole) -> str:
    return f"cable[{hole[0]}].points[{hole[1]}]"


def gap_violations(parts: Parts) -> Iterator[str]:
    """Cables that cross or come near each other or a winch of others; beside their own winch they may."""
    least = parts.constraints.cable_gap
    if least == 0.0 or not parts.new_cables:
        return
    runs = [
        (index, at)
        for index, (cable, points) in enumerate(zip(parts.robot.cables, parts.points, strict=True))
        for at in range(int(parts.outside(cable)), len(points) - 1)
    ]
    for number, (index, at) in enumerate(runs):
        yield from _over_winches(parts, index, at)
        for other, there in runs[number + 1 :]:
            if (other == index and there <= at + 1) or not {index, other} & set(parts.new_cables):
                continue
            gap = _gap(parts, (index, at), (other, there))
            if gap < least - LENGTH:
                told, value = ("crosses", "") if gap < HOLE_TOLERANCE else ("too close to", f" ({mm(gap)})")
                yield (
                    f"cable[{other}] between points {there} and {there + 1}: {told} cable[{index}] between points {at} "
                    f"and {at + 1}{value}. Minimum cable_gap: {mm(least)}. Reroute one of them."
                )


def _gap(parts: Parts, one: Hole, other: Hole) -> float:
    """Least distance of two segments [m]; infinite where they meet beside the winch of both."""
    cables = parts.robot.cables[one[0]], parts.robot.cables[other[0]]
    ends = [_behind_winch(parts, *one), _behind_winch(parts, *other)]
    shares = nearest_shares(ends[0][None], ends[1][None])
    places = [run[0] + share[0] * (run[1] - run[0]) for run, share in zip(ends, shares, strict=True)]
    if one[0] != other[0] and cables[0].winch == cables[1].winch:
        winch = parts.winch_of(cables[0])
        away = [float(np.linalg.norm(place - winch.at)) for place in places]
        if max(away) < 2 * winch.spool_radius - HOLE_TOLERANCE:
            return float("inf")
    return float(np.linalg.norm(places[0] - places[1]))


def _behind_winch(parts: Parts, index: int, at: int) -> Float[np.ndarray, "2 dim"]:
    """The ends of a segment; the first one of a cable begins two spool radii from its winch."""
    ends, winch = parts.points[index][at : at + 2].copy(), parts.winch_of(parts.robot.cables[index])
    if at == 0 and winch.mount is Mount.BODY:
        span = ends[1] - ends[0]
        ends[0] += min(1.0, 2 * winch.spool_radius / float(np.linalg.norm(span))) * span
    return ends


def _over_winches(parts: Parts, index: int, at: int) -> Iterator[str]:
    ends = parts.points[index][at : at + 2]
    for number, winch in enumerate(parts.robot.winches):
        if winch.mount is Mount.WORLD or winch.name == parts.robot.cables[index].winch:
            continue
        if index not in parts.new_cables and number not in parts.new_winches:
            continue
        center = np.array(winch.at)
        share = nearest_shares(ends[None], np.stack([center, center])[None])[0][0]
        gap = float(np.linalg.norm(ends[0] + share * (ends[1] - ends[0]) - center))
        if gap < 2 * winch.spool_radius - LENGTH:
            yield (
                f"cable[{index}] between points {at} and {at + 1}: too close to {parts.winch_name(number)} of other "
                f"cables ({mm(gap)}). Minimum: two spool radii, {mm(2 * winch.spool_radius)}. Reroute it."
            )


def bend_violations(parts: Parts) -> Iterator[str]:
    """Turns and arcs that are too sharp, cables that are too long or too loose, spools that differ too much."""
    for index in parts.new_cables:
        yield from _sharp_bends(parts, index)
        yield from _wrong_lengths(parts, index)
    yield from _wrong_spools(parts)


def turn_violations(parts: Parts) -> Iterator[str]:
    """Turns and arcs that are too sharp."""
    for index in parts.new_cables:
        yield from _sharp_bends(parts, index)


def _sharp_bends(parts: Parts, index: int) -> Iterator[str]:
    """The arc fits a turn if it touches both segments no farther from the corner than the middle of the shorter."""
    limits, spans = parts.constraints, np.diff(parts.points[index], axis=0)
    if len(spans) < 2:
        return
    lengths = np.linalg.norm(spans, axis=1)
    units = spans / lengths[:, None]
    before, after = units[:-1], units[1:]
    turns = 2 * np.arctan2(np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1))
    tangents = 0.5 * np.minimum(lengths[:-1], lengths[1:])
    arcs = tangents / np.maximum(np.tan(0.5 * turns), np.finfo(float).tiny)
    gentler = np.tan(0.5 * np.maximum(turns - np.radians(ANGLE), 0.0))
    for corner, (turn, arc) in enumerate(zip(np.degrees(turns), arcs, strict=True)):
        name = f"cable[{index}].points[{corner + 1}]"
        enters = corner == 0 and parts.outside(parts.robot.cables[index])
        if enters and turn > HAIRPIN and (gap := _gap_behind(parts, index)) is not None:
            yield (
                f"{name}: the cable turns back past its own winch (by {turn:.4g} degrees, {mm(gap)} from it). "
                f"Maximum there: {HAIRPIN:g} degrees. Move the winch."
            )
        if turn > limits.max_turn + ANGLE and not enters:
            most = f"{limits.max_turn:g} degrees"
            yield f"{name}: turn too sharp ({turn:.3g} degrees). Maximum turn: {most}. Move the point."
        if limits.bend_radius * gentler[corner] > tangents[corner] + LENGTH:
            least = mm(limits.bend_radius)
            yield f"{name}: bend too sharp (radius {mm(arc)}). Minimum bend_radius: {least}. Move the point."


HAIRPIN = 150.0  # a larger turn [degrees] where a cable enters is no way around an edge, but a way back
BEHIND = 4.0  # spool radii within which a cable passes its winch


def _gap_behind(parts: Parts, index: int) -> float | None:
    """Distance [m] at which a cable passes its own winch after it has entered the body; None if it does not."""
    points, winch = parts.points[index], parts.winch_of(parts.robot.cables[index])
    centers = np.tile(np.array(winch.at, dtype=float), (len(points) - 2, 2, 1))
    runs = np.stack([points[1:-1], points[2:]], axis=1)
    shares = nearest_shares(runs, centers)[0]
    nearest = runs[:, 0] + shares[:, None] * (runs[:, 1] - runs[:, 0])
    gap = float(np.linalg.norm(nearest - winch.at, axis=1).min())
    return gap if gap < BEHIND * winch.spool_radius else None


def _wrong_lengths(parts: Parts, index: int) -> Iterator[str]:
    cable, limits = parts.robot.cables[index], parts.constraints
    if limits.max_length is not None and cable.length > limits.max_length + LENGTH:
        yield f"cable[{index}]: too long ({mm(cable.length)}). Maximum: {mm(limits.max_length)}. Shorten it."
    if cable.slack > limits.slack + LENGTH:
        yield f"cable[{index}]: slack too large ({mm(cable.slack)}). Maximum: {mm(limits.slack)}. Reduce it."


def _wrong_spools(parts: Parts) -> Iterator[str]:
    most, ratios = parts.constraints.spool_ratio * (1 + _ROUNDING), np.abs(parts.robot.spool_ratios)
    for index in parts.new_cables:
        if parts.robot.cables[index].reverse and not parts.constraints.two_way:
            yield f"cable[{index}]: wound the other way round. Not allowed without two_way. Unwind it or allow two_way."
        if not 1 / most <= ratios[index] <= most:
            yield (
                f"cable[{index}]: spool too different from its winch's ({ratios[index]:.4g} times its radius). "
                f"Maximum spool_ratio, also of its inverse: {parts.constraints.spool_ratio:g}. Change its spool radius."
            )


_ROUNDING = 1e-5  # radii are rounded by no larger a share
