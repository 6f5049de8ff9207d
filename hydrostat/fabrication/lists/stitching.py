"""The order in which each cable is stitched, from hole to hole or from point to point."""

import math
from collections.abc import Iterator

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.fabrication.lists.cuts import point_name
from hydrostat.fabrication.lists.table import Cell, Table, number_columns, text_columns
from hydrostat.fabrication.patterns.stitches import CableStitches, Side, Stitch
from hydrostat.geometry import Solid, Surface
from hydrostat.robot import Body, Cable, Robot

SKIN = 4.0  # A point at most so deep [mm] is sewn to the skin: the needle only dips into the foam. Assumed.

NEEDLE = 60.0
"""A point at most so deep [mm] is reached with a long needle: a doll needle of 125 mm goes in at the skin, and there is
enough of it left to hold; for deeper ones a tube is laid before casting. Assumed."""


CLOSE = 2.0  # Points nearer than this [mm] cannot be told apart with a needle. Assumed.


def stitch_table(stitches: tuple[CableStitches, ...]) -> Table:
    """Table of the stitches from hole to hole, for plush robots."""
    rows = []
    for cable in stitches:
        along, before, last = 0.0, None, cable.stitches[-1].number - 1
        for stitch in cable.stitches:
            gap = None if before is None else math.dist(before, stitch.place)
            along, before = along + (gap or 0.0), stitch.place
            name = point_name(stitch.number - 1, last)
            rows.append(
                (f"C{cable.cable}", cable.winch, cable.panel, name, _through_cloth(stitch), *stitch.place, gap, along)
            )
    return Table(
        name="stitching",
        title="Stitching order",
        columns=(
            *text_columns("cable", "winch", "panel", "point", "way"),
            *number_columns("x", "y", "from the last point", "from the winch", unit="mm"),
        ),
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


def depth_table(robot: Robot) -> Table:
    """Table of the points of the cables with their depth under the skin, for bodies in space."""
    rows = []
    if robot.cables:
        points = np.concatenate([np.array(cable.points) for cable in robot.cables])
        depths, skin = _under_skin(robot.body, points)
        steps = [(cable, step) for cable in robot.cables for step in range(len(cable.points))]
        for (cable, step), row, depth, nearest in zip(steps, _along(robot), 1e3 * depths, 1e3 * skin, strict=True):
            rows.append((*row, float(depth), *nearest.tolist(), _reach(cable, step, float(depth))))
    return Table(
        name="stitching",
        title="Where the cables pass",
        columns=(
            *text_columns("cable", "winch", "point"),
            *number_columns("x", "y", "z", "from the last point", "from the winch", "depth", unit="mm"),
            *number_columns("skin x", "skin y", "skin z", unit="mm"),
            *text_columns("how"),
        ),
        rows=tuple(rows),
        notes=(
            "Depth is that under the skin, below 0 outside the body; skin is the nearest place of the surface, where a "
            "pin marks it.",
            f"Up to {SKIN:g} mm deep the cable is sewn to the skin, up to {NEEDLE:g} mm it is drawn through with a "
            "long needle; deeper, a tube is laid before the foam is cast.",
            "Tubes of the cut list that run deeper than the skin are laid in the mould too, with a rod in them.",
        ),
    )


def plane_table(robot: Robot) -> Table:
    """Table of the points of the cables in the middle plane, for flat bodies that are cast."""
    return Table(
        name="stitching",
        title="Where the cables pass",
        columns=(
            *text_columns("cable", "winch", "point"),
            *number_columns("x", "y", "from the last point", "from the winch", unit="mm"),
        ),
        rows=tuple(_along(robot)),
        notes=(
            "All points lie in the middle of the thickness; x and y count from the middle of the drawing, seen from "
            "the front.",
            "If the mould is parted there, lay tubes with a rod in them along these points before the foam is poured; "
            "else draw the line through the foam with a long needle, from point to point.",
        ),
    )


def _along(robot: Robot) -> Iterator[tuple[Cell, ...]]:
    """Rows of the points of all cables: cable, winch, point, where it is, how far from the last and from the winch."""
    for number, cable in enumerate(robot.cables, start=1):
        along = np.concatenate([[0.0], np.cumsum(cable.segments)])
        for step, place in enumerate(cable.points):
            name, gap = point_name(step, len(cable.points) - 1), 1e3 * float(cable.segments[step - 1]) if step else None
            at = (1e3 * float(value) for value in place)
            yield (f"C{number}", cable.winch, name, *at, gap, 1e3 * float(along[step]))


def _under_skin(body: Body, points: Points) -> tuple[Vector, Points]:
    """Depth of points under the skin [m], below 0 outside, and the nearest places of it [m]."""
    solid = body.solid or Solid(Surface(body.mesh.nodes, body.mesh.boundary))
    places, _ = solid.nearest(points)
    return -solid.distances(points), places


def _reach(cable: Cable, step: int, depth: float) -> str:
    """How a point of a cable is reached."""
    beside = [place for place in (step - 1, step) if 0 <= place < len(cable.segments)]
    bare = [bool(cable.bare[place]) for place in beside]
    if depth < 0:
        return "outside the body"
    if not all(bare):
        return "end of its tube" if any(bare) else "in its tube"
    if depth <= SKIN:
        return "sewn to the skin"
    return "long needle" if depth <= NEEDLE else "tube laid before casting"


def close_warnings(robot: Robot) -> tuple[str, ...]:
    """Which cables have points too close for two stitches."""
    close = {
        f"C{number}": 1e3 * float(cable.segments[cable.bare].min())
        for number, cable in enumerate(robot.cables, start=1)
        if 1e3 * cable.segments[cable.bare].min() < CLOSE
    }
    if not close:
        return ()
    cables = f"cable{'s' if len(close) > 1 else ''} {', '.join(close)}"
    least = min(close.values())
    return (f"{cables}: points as near to each other as {least:.1f} mm, below {CLOSE:g} mm, are sewn by one stitch",)


def deep_warnings(table: Table) -> tuple[str, ...]:
    """Which cables have points too deep for a needle, a sentence each."""
    deep: dict[str, float] = {}
    for cable, how, depth in zip(table.column("cable"), table.column("how"), table.column("depth"), strict=True):
        if how == "tube laid before casting" and isinstance(depth, float):
            deep[str(cable)] = max(deep.get(str(cable), 0.0), depth)
    return tuple(
        f"cable {cable} runs up to {depth:.0f} mm under the skin, too deep for a needle ({NEEDLE:g} mm): lay a tube in "
        "the mould before the foam is poured"
        for cable, depth in deep.items()
    )
