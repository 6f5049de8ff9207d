"""The order in which each cable is stitched, from hole to hole or from point to point."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.fabrication.lists.cuts import point_name
from hydrostat.fabrication.lists.table import Table, number_column, text_column
from hydrostat.fabrication.patterns.stitches import CableStitches, Side, Stitch
from hydrostat.geometry import Solid, Surface
from hydrostat.robot import SEWN_DEPTH, Body, Robot

SKIN = 1e3 * SEWN_DEPTH  # A point at most so deep [mm] is sewn to the skin: the needle only dips in. Assumed.

NEEDLE = 60.0
"""A point at most so deep [mm] is reached with a long needle: a doll needle of 125 mm goes in at the skin, and there is
enough of it left to hold; for deeper ones a tube is laid before casting. Assumed."""


MIN_STITCH_GAP = 2.0  # Points nearer than this [mm] cannot be told apart with a needle. Assumed.


class PointAccess(StrEnum):
    """Position of a point of a cable in a body in space, by the tool that reaches it."""

    OUTSIDE = "outside the body"
    TUBE = "in its tube"
    TUBE_END = "end of its tube"
    SKIN = "sewn to the skin"
    NEEDLE = "long needle"
    LAID = "tube laid before casting"


@dataclass(frozen=True, kw_only=True)
class StitchRow:
    """Point of a cable that is sewn through cloth; lengths in millimeters."""

    cable: Annotated[str, text_column("cable")]
    winch: Annotated[str, text_column("winch")]
    panel: Annotated[str, text_column("panel")]
    point: Annotated[str, text_column("point")]
    way: Annotated[str, text_column("way")]
    x: Annotated[float, number_column("x", "mm")]
    y: Annotated[float, number_column("y", "mm")]
    gap: Annotated[float | None, number_column("from the last point", "mm")]
    along: Annotated[float, number_column("from the winch", "mm")]


@dataclass(frozen=True, kw_only=True)
class DepthRow:
    """Point of a cable in a body in space; lengths in millimeters."""

    cable: Annotated[str, text_column("cable")]
    winch: Annotated[str, text_column("winch")]
    point: Annotated[str, text_column("point")]
    x: Annotated[float, number_column("x", "mm")]
    y: Annotated[float, number_column("y", "mm")]
    z: Annotated[float, number_column("z", "mm")]
    gap: Annotated[float | None, number_column("from the last point", "mm")]
    along: Annotated[float, number_column("from the winch", "mm")]
    depth: Annotated[float, number_column("depth", "mm")]
    skin_x: Annotated[float, number_column("skin x", "mm")]
    skin_y: Annotated[float, number_column("skin y", "mm")]
    skin_z: Annotated[float, number_column("skin z", "mm")]
    how: Annotated[PointAccess, text_column("how")]


@dataclass(frozen=True, kw_only=True)
class PlaneRow:
    """Point of a cable in the middle plane of a flat body that is cast; lengths in millimeters."""

    cable: Annotated[str, text_column("cable")]
    winch: Annotated[str, text_column("winch")]
    point: Annotated[str, text_column("point")]
    x: Annotated[float, number_column("x", "mm")]
    y: Annotated[float, number_column("y", "mm")]
    gap: Annotated[float | None, number_column("from the last point", "mm")]
    along: Annotated[float, number_column("from the winch", "mm")]


Stitching = Table[StitchRow] | Table[DepthRow] | Table[PlaneRow]


def stitch_table(stitches: tuple[CableStitches, ...]) -> Table[StitchRow]:
    """Table of the stitches from hole to hole, for plush robots."""
    rows = []
    for cable in stitches:
        along, before, last = 0.0, None, cable.stitches[-1].number - 1
        for stitch in cable.stitches:
            gap = None if before is None else math.dist(before, stitch.place)
            along, before = along + (gap or 0.0), stitch.place
            rows.append(
                StitchRow(
                    cable=f"C{cable.cable}",
                    winch=cable.winch,
                    panel=cable.panel,
                    point=point_name(stitch.number - 1, last),
                    way=_through_cloth(stitch),
                    x=stitch.place[0],
                    y=stitch.place[1],
                    gap=gap,
                    along=along,
                )
            )
    return Table(
        name="stitching",
        title="Stitching order",
        row=StitchRow,
        rows=tuple(rows),
        notes=(
            "Out: from inside to outside of the panel; in: the way back. Where a cable does not go through the cloth, "
            "what holds it there is tied to the cloth with thread.",
            "x and y count from the middle of the drawing, seen from the front.",
        ),
    )


def _through_cloth(stitch: Stitch) -> str:
    if not stitch.passes:
        return f"tie, stays {stitch.after}"
    return "out" if stitch.after is Side.OUTSIDE else "in"


def depth_table(robot: Robot) -> Table[DepthRow]:
    """Table of the points of the cables with their depth under the skin, for bodies in space."""
    rows = []
    if robot.cables:
        places = np.concatenate([np.array(cable.points) for cable in robot.cables])
        depths, skin = _under_skin(robot.body, places)
        for point, depth, nearest in zip(_cable_points(robot), 1e3 * depths, (1e3 * skin).tolist(), strict=True):
            rows.append(
                DepthRow(
                    cable=point.cable,
                    winch=point.winch,
                    point=point.name,
                    x=point.at[0],
                    y=point.at[1],
                    z=point.at[2],
                    gap=point.gap,
                    along=point.along,
                    depth=float(depth),
                    skin_x=nearest[0],
                    skin_y=nearest[1],
                    skin_z=nearest[2],
                    how=_point_access(point.beside, float(depth)),
                )
            )
    return Table(
        name="stitching",
        title="Where the cables pass",
        row=DepthRow,
        rows=tuple(rows),
        notes=(
            "Depth is that under the skin, below 0 outside the body; skin is the nearest place of the surface, where a "
            "pin marks it.",
            f"Up to {SKIN:g} mm deep the cable is sewn to the skin, up to {NEEDLE:g} mm it is drawn through with a "
            "long needle; deeper, a tube is laid before the body is cast.",
            "Tubes of the cut list that run deeper than the skin are laid in the mold too, with a rod in them.",
        ),
    )


def plane_table(robot: Robot) -> Table[PlaneRow]:
    """Table of the points of the cables in the middle plane, for flat bodies that are cast."""
    return Table(
        name="stitching",
        title="Where the cables pass",
        row=PlaneRow,
        rows=tuple(
            PlaneRow(
                cable=point.cable,
                winch=point.winch,
                point=point.name,
                x=point.at[0],
                y=point.at[1],
                gap=point.gap,
                along=point.along,
            )
            for point in _cable_points(robot)
        ),
        notes=(
            "All points lie in the middle of the thickness; x and y count from the middle of the drawing, seen from "
            "the front.",
            "If the mold is parted there, lay tubes with a rod in them along these points before you cast the body; "
            "else draw the line through the body with a long needle, from point to point.",
        ),
    )


@dataclass(frozen=True, kw_only=True)
class _CablePoint:
    """Point of a cable; lengths in millimeters."""

    cable: str
    winch: str
    name: str
    at: tuple[float, ...]
    gap: float | None  # from the point before it
    along: float  # from the winch
    beside: tuple[bool, ...]  # True for each segment at the point that is bare


def _cable_points(robot: Robot) -> Iterator[_CablePoint]:
    """Points of all cables, from the winch of each."""
    for number, cable in enumerate(robot.cables, start=1):
        along = np.concatenate([[0.0], np.cumsum(cable.segments)])
        for step, place in enumerate(cable.points):
            segments = [segment for segment in (step - 1, step) if 0 <= segment < len(cable.segments)]
            yield _CablePoint(
                cable=f"C{number}",
                winch=cable.winch,
                name=point_name(step, len(cable.points) - 1),
                at=tuple(1e3 * float(value) for value in place),
                gap=1e3 * float(cable.segments[step - 1]) if step else None,
                along=1e3 * float(along[step]),
                beside=tuple(bool(cable.bare[segment]) for segment in segments),
            )


def _under_skin(body: Body, points: Points) -> tuple[Vector, Points]:
    """Depth of points under the skin [m], below 0 outside, and the nearest places of it [m]."""
    solid = body.solid or Solid(Surface(body.mesh.nodes, body.mesh.boundary))
    places, _ = solid.nearest(points)
    return -solid.distances(points), places


def _point_access(bare: tuple[bool, ...], depth: float) -> PointAccess:
    """Position of a point with such segments next to it, so deep under the skin [mm]."""
    if depth < 0:
        return PointAccess.OUTSIDE
    if not all(bare):
        return PointAccess.TUBE_END if any(bare) else PointAccess.TUBE
    if depth <= SKIN:
        return PointAccess.SKIN
    return PointAccess.NEEDLE if depth <= NEEDLE else PointAccess.LAID


@dataclass(frozen=True, kw_only=True)
class CableDepths:
    """Names of cables, C1, C2, ..."""

    sewn: tuple[str, ...] = ()  # those that are sewn to the skin all along
    drawn: tuple[str, ...] = ()  # those that are drawn through the body at some points
    laid: tuple[str, ...] = ()  # those of which a point is too deep for a needle: a tube is laid before casting
    tubed: tuple[str, ...] = ()  # those whose own tube runs in the body, deeper than the skin

    @classmethod
    def of(cls, stitching: Stitching | None, cables: int) -> "CableDepths":
        """Read the depths of their points; in the middle of a flat body all are drawn through, without a list sewn."""
        points = [row for row in stitching.rows if isinstance(row, DepthRow)] if stitching is not None else []
        if not points:
            names = tuple(f"C{number}" for number in range(1, cables + 1))
            return cls(sewn=names) if stitching is None else cls(drawn=names)
        found: dict[str, set[PointAccess]] = {}
        for point in points:
            in_tube = point.how in (PointAccess.TUBE, PointAccess.TUBE_END)
            how = PointAccess.TUBE if in_tube and point.depth > SKIN else PointAccess.TUBE_END if in_tube else point.how
            found.setdefault(point.cable, set()).add(how)
        deep = {PointAccess.NEEDLE, PointAccess.LAID, PointAccess.TUBE}
        return cls(
            sewn=tuple(cable for cable, hows in found.items() if not hows & deep),
            drawn=tuple(cable for cable, hows in found.items() if PointAccess.NEEDLE in hows),
            laid=tuple(cable for cable, hows in found.items() if PointAccess.LAID in hows),
            tubed=tuple(cable for cable, hows in found.items() if PointAccess.TUBE in hows),
        )


def close_warnings(robot: Robot) -> tuple[str, ...]:
    """Warn of cables with points too close for two stitches."""
    close = {
        f"C{number}": 1e3 * float(cable.segments[cable.bare].min())
        for number, cable in enumerate(robot.cables, start=1)
        if 1e3 * cable.segments[cable.bare].min() < MIN_STITCH_GAP
    }
    if not close:
        return ()
    cables = f"cable{'s' if len(close) > 1 else ''} {', '.join(close)}"
    least = min(close.values())
    return (
        f"{cables}: some points are only {least:.1f} mm apart, too close for two stitches (minimum {MIN_STITCH_GAP:g} "
        "mm). Sew one stitch for both",
    )


def deep_warnings(table: Table[DepthRow]) -> tuple[str, ...]:
    """Warn of cables with points too deep for a needle, a sentence each."""
    deep: dict[str, float] = {}
    for row in table.rows:
        if row.how is PointAccess.LAID:
            deep[row.cable] = max(deep.get(row.cable, 0.0), row.depth)
    return tuple(
        f"cable {cable} runs up to {depth:.0f} mm under the skin, too deep for a needle ({NEEDLE:g} mm). Lay a tube in "
        "the mold before you cast the body"
        for cable, depth in deep.items()
    )
