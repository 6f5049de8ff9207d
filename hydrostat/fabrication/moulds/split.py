"""`split_solid`: pieces of a solid that fit the printer, with holes for dowels where they are joined."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from manifold3d import CrossSection, JoinType, Manifold

from hydrostat.arrays import Float
from hydrostat.fabrication.moulds.solids import join_solids, rod

DOWEL = 1.6  # radius of a hole for a dowel, a piece of a 3 mm skewer or rod [mm]
DOWEL_DEPTH = 8.0  # depth of the hole in each of two pieces [mm]

_WALL = 2.0
_DEPTHS = (DOWEL + _WALL, 6.0, 9.0, 13.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Pieces:
    """A solid in pieces, where they belong."""

    solids: tuple[Manifold, ...]  # watertight, by row and column
    dowels: int  # number of dowels that join them
    lost: float  # volume of the holes for dowels, and of crumbs that a cut leaves [mm^3], measured on these


def cuts(low: float, high: float, longest: float) -> tuple[float, ...]:
    """Places that cut a length into equal pieces no longer than the printer takes [mm]."""
    count = max(int(np.ceil((high - low) / longest - 1e-9)), 1)
    return tuple(low + (high - low) * step / count for step in range(1, count))


def grid(
    low: tuple[float, float, float], high: tuple[float, float, float], bed: tuple[float, float, float]
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Find cuts across x and y, the solid turned by 90 degrees on the bed if that makes fewer pieces."""
    ways = [
        (cuts(low[0], high[0], sides[0]), cuts(low[1], high[1], sides[1]))
        for sides in ((bed[0], bed[1]), (bed[1], bed[0]))
    ]
    return min(ways, key=lambda way: (len(way[0]) + 1) * (len(way[1]) + 1))


def split_solid(solid: Manifold, x_cuts: tuple[float, ...], y_cuts: tuple[float, ...]) -> Pieces:
    """Cut a solid by upright planes; holes for two dowels are drilled across each joint that has room for them."""
    low, high = np.reshape(solid.bounding_box(), (2, 3))
    dowels: list[Manifold] = []
    for axis, places, others in ((0, x_cuts, y_cuts), (1, y_cuts, x_cuts)):
        other = 1 - axis
        for place in places:
            for start, end in pairwise((low[other], *others, high[other])):
                dowels += _dowels(solid, axis, place, (start, end))
    drilled = solid
    for dowel in dowels:
        drilled = drilled - dowel
    pieces = [drilled]
    for axis, places in ((0, x_cuts), (1, y_cuts)):
        normal = (1.0, 0.0, 0.0) if axis == 0 else (0.0, 1.0, 0.0)
        for place in places:
            pieces = [part for piece in pieces for part in piece.split_by_plane(normal, place)]
    parts = [part for piece in pieces for part in _bodies(piece)]
    holes = float((join_solids(dowels) ^ solid).volume())
    return Pieces(
        solids=tuple(sorted((part for part in parts if _printable(part)), key=_corner)),
        dowels=len(dowels),
        lost=holes + sum(float(part.volume()) for part in parts if not _printable(part)),
    )


def _bodies(piece: Manifold) -> list[Manifold]:
    """Return the connected bodies of a piece; a piece with a closed void stays whole."""
    shells = piece.decompose()
    return shells if all(shell.volume() > 0 for shell in shells) else [piece]


def _printable(part: Manifold) -> bool:
    """Return True if a part is larger than a crumb that a cut leaves."""
    low, high = np.reshape(part.bounding_box(), (2, 3))
    crumb = 20.0
    thin = 1.0
    return bool((high - low).min() > thin) and part.volume() > crumb


def _corner(piece: Manifold) -> tuple[float, float]:
    box = piece.bounding_box()
    return round(box[0], 3), round(box[1], 3)


def _dowels(solid: Manifold, axis: int, place: float, span: tuple[float, float]) -> list[Manifold]:
    """Two dowels across a joint, as far apart as they can be with a wall round them; fewer if there is no room."""
    turned = np.roll(np.eye(3), -1 - axis, axis=0)
    section = solid.transform(np.column_stack([turned, np.zeros(3)])).slice(place)
    spots = _spots(section ^ _strip(section, axis, span)) @ turned[:2] + place * turned[2]
    return dowels_at(solid, spots, axis)


def dowels_across(solid: Manifold) -> list[Manifold]:
    """Two dowels across the plane z = 0, as far apart as they can be with a wall round them."""
    spots = _spots(solid.slice(0.0))
    return dowels_at(solid, np.column_stack([spots, np.zeros(len(spots))]), 2)


def dowels_at(solid: Manifold, spots: Float[np.ndarray, "spots 3"], axis: int) -> list[Manifold]:
    """Choose of many places the two furthest apart where a dowel along an axis has room; fewer if there are none."""
    good = [spot for spot in spots if _has_room(solid, spot, axis)]
    if not good:
        return []
    places = np.array(good)
    apart = np.linalg.norm(places[:, None] - places[None], axis=2)
    one, two = np.unravel_index(int(np.argmax(apart)), apart.shape)
    chosen = (one, two) if apart[one, two] > 4 * DOWEL else (one,)
    return [_dowel(places[number], axis, 0.0) for number in chosen]


def _spots(section: CrossSection) -> Float[np.ndarray, "spots 2"]:
    """Places in a section that are at some distance from its rim."""
    rings = [ring for depth in _DEPTHS for ring in section.offset(-depth, JoinType.Miter).to_polygons()]
    if not rings:
        return np.empty((0, 2))
    spots = np.unique(np.concatenate(rings).astype(float).round(4), axis=0)
    tried = 80
    return spots[:: max(len(spots) // tried, 1)]


def _strip(section: CrossSection, axis: int, span: tuple[float, float]) -> CrossSection:
    """The part of a section between two other cuts, less a margin; the section's first axis follows the cut one."""
    low_x, low_y, high_x, high_y = section.bounds() if not section.is_empty() else (0.0, 0.0, 1.0, 1.0)
    joint = 3.0
    start, end = span[0] + joint, span[1] - joint
    if axis == 0:  # of y and z
        return CrossSection.square((end - start, high_y - low_y + 2)).translate((start, low_y - 1))
    return CrossSection.square((high_x - low_x + 2, end - start)).translate((low_x - 1, start))  # of z and x


def _has_room(solid: Manifold, spot: Float[np.ndarray, "3"], axis: int) -> bool:
    """Return True if a dowel with a wall round it lies inside the solid."""
    rod_with_wall = _dowel(spot, axis, _WALL / 2)
    return float((rod_with_wall - solid).volume()) < 1e-6


def _dowel(spot: Float[np.ndarray, "3"], axis: int, wall: float) -> Manifold:
    way = np.eye(3)[axis] * (DOWEL_DEPTH + wall)
    return rod(spot - way, spot + way, DOWEL + wall)
