"""`way_violations`: where cables run: how near to the edge, and through which zones."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from hydrostat.design.along import least_along
from hydrostat.design.checks.parts import LENGTH, Parts, mm, place
from hydrostat.design.zone import Zone


@dataclass(frozen=True, eq=False)
class _Segments:
    """The segments of all new cables.

    Attributes:
        cables: number of the cable of each.
        firsts: number of the point at which each begins.
        starts: [m].
        ends: [m].
        bare: whether each is without a sheath.
    """

    cables: Int[np.ndarray, " segments"]
    firsts: Int[np.ndarray, " segments"]
    starts: Float[np.ndarray, "segments dim"]
    ends: Float[np.ndarray, "segments dim"]
    bare: Bool[np.ndarray, " segments"]

    def name(self, index: int | np.integer) -> str:
        """A segment as a sentence begins with it."""
        first = self.firsts[index]
        return f"cable[{self.cables[index]}] between points {first} and {first + 1}"


def way_violations(parts: Parts) -> Iterator[str]:
    """Points and segments near the edge, segments in forbidden zones, bare ones in still zones, needless sheaths."""
    if not parts.new_cables:
        return
    segments = _segments(parts)
    yield from _near_the_edge_at_points(parts)
    yield from _near_the_edge(parts, segments)
    for number, zone in enumerate(parts.constraints.keep_out):
        yield from _through(
            segments, zone, f"passes through keep_out[{number}]", np.ones(len(segments.bare), dtype=bool)
        )
    for number, zone in enumerate(parts.constraints.still):
        yield from _through(segments, zone, f"runs without a sheath through still[{number}]", segments.bare)
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
    """How many of the first points of a cable are given: in the world and where it enters, or at a locked winch."""
    cable = parts.robot.cables[index]
    if parts.outside(cable):
        return 2
    return 0 if parts.numbers[cable.winch] in parts.new_winches else 1


def _near_the_edge_at_points(parts: Parts) -> Iterator[str]:
    least = parts.constraints.clearance
    lengths = {index: len(parts.points[index]) for index in parts.new_cables}
    asked = [(index, at) for index, count in lengths.items() for at in range(_given_points(parts, index), count)]
    if not asked:
        return
    depths = parts.region.depths(np.array([parts.points[index][at] for index, at in asked]))
    for (index, at), depth in zip(asked, depths, strict=True):
        if depth < least - LENGTH:
            yield (
                f"cable[{index}].points[{at}] at {place(parts.points[index][at])} lies {mm(depth)} inside the "
                f"{parts.edge}, less than the clearance of {mm(least)}"
            )


def _near_the_edge(parts: Parts, segments: _Segments) -> Iterator[str]:
    """Half the clearance; a segment from a given point counts from a clearance away from there."""
    clearance = parts.constraints.clearance
    given = np.array([_given_points(parts, index) for index in range(len(parts.robot.cables))])[segments.cables]
    starts, spans = segments.starts.copy(), segments.ends - segments.starts
    lengths = np.linalg.norm(spans, axis=1)
    late = segments.firsts == given - 1
    starts[late] += (clearance / lengths[late])[:, None] * spans[late]
    asked = np.flatnonzero((segments.firsts >= given) | (late & (lengths > clearance)))
    limit = 0.5 * clearance - LENGTH
    found = least_along(parts.region.depths, starts[asked], segments.ends[asked], limit, resolution=1e-4)
    for index, depth in zip(asked, found, strict=True):
        if depth < limit:
            yield (
                f"{segments.name(index)} comes to {mm(depth)} inside the {parts.edge}, "
                f"less than half the clearance of {mm(clearance)}"
            )


def _through(segments: _Segments, zone: Zone, what: str, asked: Bool[np.ndarray, " segments"]) -> Iterator[str]:
    chosen = np.flatnonzero(asked)
    found = zone.least(segments.starts[chosen], segments.ends[chosen], limit=-LENGTH)
    for index, away in zip(chosen, found, strict=True):
        if away < -LENGTH:
            yield f"{segments.name(index)} {what}, {mm(-away)} deep"


def _sheathed_for_nothing(parts: Parts, segments: _Segments) -> Iterator[str]:
    chosen = np.flatnonzero(~segments.bare)
    starts, ends = segments.starts[chosen], segments.ends[chosen]
    needed = np.zeros(len(chosen), dtype=bool)
    for zone in parts.constraints.still:
        needed |= zone.least(starts, ends, limit=LENGTH) < LENGTH
    for index in chosen[~needed]:
        yield f"{segments.name(index)} runs in a sheath outside the still zones, and leads are not allowed"
