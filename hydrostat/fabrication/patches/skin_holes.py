"""`SkinHole`: where a cable passes the skin, on the body and on the cloth."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np
import shapely

from hydrostat.arrays import Float, Int
from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patches.patch import Patch
from hydrostat.fabrication.patches.seams import Seam
from hydrostat.fabrication.patterns.shape import Place
from hydrostat.fabrication.patterns.stitches import Side, runs_of
from hydrostat.geometry import Solid, Surface
from hydrostat.robot import Cable, Mount, Robot
from hydrostat.units import plural

MAX_SEWN_DEPTH = 15.0
"""A point of a cable at most so far under the skin [mm] is sewn to it; deeper ones stay in the stuffing. Assumed."""

SHARED_HOLE_DISTANCE = 0.1  # cables that pass the skin no farther apart than that [mm] share a hole

_SEAM_FIRST = 3.0
"""A point at most so much farther from a seam than from the skin [mm] is sewn into the seam: that takes no hole, and
cables in the middle between front and back stay there. Assumed."""

_SHALLOW_DEPTH = 5.0  # A cable that was simulated so near to the skin [mm] acts as if it were on it. Assumed.


@dataclass(frozen=True, kw_only=True)
class SkinHole:
    """Point of a cable near the skin, and what the cable does there."""

    cable: int  # its number, 1 for the first cable of the robot
    point: int  # its number along the cable, 1 at the winch
    depth: float  # depth of the simulated point under the skin [mm]
    solid: tuple[float, float, float]  # the nearest place of the skin [mm]
    # patch number and place on it [mm]; two, one on each side, where the cable passes through a seam
    places: tuple[tuple[int, Place], ...]
    passes: bool  # True if the cable goes through the cloth here
    after: Side  # on which side it runs on

    @property
    def in_seam(self) -> bool:
        """True if the cable passes between two stitches of a seam, without a hole."""
        return len(self.places) > 1

    def on(self, patch: int) -> Place | None:
        """Its place on a patch [mm]; None if it is on another."""
        return next((place for number, place in self.places if number == patch), None)


class NearestOnSkin:
    """Patches, asked for the nearest places of points."""

    def __init__(self, patches: tuple[Patch, ...]) -> None:
        self._corners = np.concatenate([patch.disc.vertices[patch.disc.triangles] for patch in patches])
        self._flat = np.concatenate([patch.flat[patch.disc.triangles] for patch in patches])
        triangles = np.arange(3 * len(self._corners)).reshape(-1, 3)
        self._surface = Solid(Surface(self._corners.reshape(-1, 3), triangles))
        self._patch = np.repeat(np.arange(len(patches)), [len(patch.disc.triangles) for patch in patches])

    def nearest(
        self, points: Float[np.ndarray, "points 3"]
    ) -> tuple[Float[np.ndarray, "points 3"], Int[np.ndarray, " points"], Float[np.ndarray, "points 2"]]:
        """The nearest places of the skin [mm], the patches they are on, and where on them [mm]."""
        places, index = self._surface.nearest(points)
        weights = _weights(places, self._corners[index])
        return places, self._patch[index], np.einsum("pc,pcx->px", weights, self._flat[index])


def _weights(
    places: Float[np.ndarray, "points 3"], corners: Float[np.ndarray, "points 3 3"]
) -> Float[np.ndarray, "points 3"]:
    """Barycentric weights of places on triangles."""
    one, other, to = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], places - corners[:, 0]
    gram = np.stack([(one * one).sum(1), (one * other).sum(1), (one * other).sum(1), (other * other).sum(1)], axis=1)
    right = np.stack([(one * to).sum(1), (other * to).sum(1)], axis=1)
    two = np.linalg.solve(gram.reshape(-1, 2, 2), right[:, :, None])[:, :, 0]
    return np.column_stack([1 - two.sum(axis=1), two])


def find_holes(
    robot: Robot, patches: tuple[Patch, ...], seams: tuple[Seam, ...], options: PatternOptions
) -> tuple[SkinHole, ...]:
    """Every point of a cable that is near the skin, in stitch order.

    A cable is sewn as on a flat robot: from inside at its winch, in and out at each of these points of its bare
    stretches, so that it ends outside, where its stopper can be adjusted; where that would end on the wrong side, it
    stays inside up to its second point. A place so near a seam that a hole would weaken it is put into the seam, and so
    is a point that is about as near to a seam as to the skin.
    """
    holes = []
    for number, cable in enumerate(robot.cables, start=1):
        points = 1e3 * np.array(cable.points)
        solid, patch, flat = NearestOnSkin(patches).nearest(points)
        depths = np.linalg.norm(points - solid, axis=1)
        first = int(robot.winch(cable.winch).mount is not Mount.WORLD)
        near = [index for index in range(first, len(points)) if depths[index] <= MAX_SEWN_DEPTH]
        begins = Side.INSIDE if first else Side.OUTSIDE
        for index, passes, after in _sewn_points(cable, near, begins):
            x, y = flat[index].tolist()
            a, b, c = solid[index].tolist()
            hole = SkinHole(
                cable=number,
                point=index + 1,
                depth=float(depths[index]),
                solid=(a, b, c),
                places=((int(patch[index]), (x, y)),),
                passes=passes,
                after=after,
            )
            least = options.pinhole / 2 + options.cloth
            holes.append(_into_seam(hole, points[index], patches, seams, least))
    return tuple(holes)


def _sewn_points(cable: Cable, near: list[int], side: Side) -> Iterator[tuple[int, bool, Side]]:
    """Yield each point near the skin, True if the cable passes there, and the side after it."""
    passes = dict.fromkeys(near, False)
    now = side
    for bare, points in runs_of(cable):
        if not bare:
            continue
        last = points[-1] == len(cable.points) - 1
        holes = [index for index in points if index in passes]
        wanted = now is not (Side.OUTSIDE if last else Side.INSIDE)
        used = holes if len(holes) % 2 == wanted else holes[1:]
        passes.update(dict.fromkeys(used, True))
        now = now.other if len(used) % 2 else now
    for index in near:
        side = side.other if passes[index] else side
        yield index, passes[index], side


def _into_seam(
    hole: SkinHole, at: Float[np.ndarray, " 3"], patches: tuple[Patch, ...], seams: tuple[Seam, ...], least: float
) -> SkinHole:
    """The hole, or the nearest place of a seam if that is too near, or if the point might as well be sewn there."""
    ((number, place),) = hole.places
    depths, alongs = zip(*(seam.nearest(at) for seam in seams), strict=True)
    best = int(np.argmin(depths))
    gap = patches[number].outline.exterior.distance(shapely.Point(place))
    if gap >= least and depths[best] > hole.depth + _SEAM_FIRST:
        return hole
    seam, along = seams[best], alongs[best]
    places = tuple((patch, seam.place(along, side)) for side, patch in enumerate(seam.patches))
    return replace(hole, solid=seam.on_body(along), depth=depths[best], places=places)


def hole_problems(holes: tuple[SkinHole, ...], options: PatternOptions) -> tuple[str, ...]:
    """Return a line for each cable with holes that overlap others."""
    close: dict[int, tuple[float, SkinHole, SkinHole]] = {}
    cut = [hole for hole in holes if hole.passes and not hole.in_seam]
    for one, other in combinations(cut, 2):
        (patch, place), (theirs, there) = one.places[0], other.places[0]
        apart = float(np.hypot(*np.subtract(place, there)))
        if (
            patch == theirs
            and SHARED_HOLE_DISTANCE < apart < options.pinhole
            and apart < close.get(one.cable, (np.inf,))[0]
        ):
            close[one.cable] = (apart, one, other)
    return tuple(
        f"the holes of cable {one.cable} at point {one.point} and of cable {other.cable} at point {other.point} are "
        f"{apart:.2f} mm apart on the cloth: pinholes of {options.pinhole:g} mm overlap. Move one point away"
        for apart, one, other in close.values()
    )


def find_surface_runs(robot: Robot, patches: tuple[Patch, ...], holes: tuple[SkinHole, ...]) -> tuple[str, ...]:
    """Return a line for each cable that would run outside where it was simulated deep in the body."""
    nearest, problems = NearestOnSkin(patches).nearest, {}
    for one, other in pairwise([hole for hole in holes if hole.passes]):
        if one.cable != other.cable or one.after is Side.INSIDE:
            continue
        points = 1e3 * np.array(robot.cables[one.cable - 1].points[one.point - 1 : other.point])
        way = np.concatenate([points, (points[1:] + points[:-1]) / 2])
        depth = float(np.linalg.norm(way - nearest(way)[0], axis=1).max())
        if depth > MAX_SEWN_DEPTH:
            problems[one.cable] = (
                f"cable {one.cable} would run outside from point {one.point} to point {other.point}, but was simulated "
                f"{depth:.0f} mm under the skin there. Cast this body in a mold or lay the cable "
                "along the skin"
            )
    return tuple(problems.values())


def hole_warnings(robot: Robot, holes: tuple[SkinHole, ...]) -> tuple[str, ...]:
    """Return the differences between cables sewn to the skin and the simulated ones, one line each."""
    warnings, shallow, free = [], {}, {}
    for number, cable in enumerate(robot.cables, start=1):
        near = {hole.point for hole in holes if hole.cable == number}
        own = [hole for hole in holes if hole.cable == number and hole.passes]
        bare = {point + step for point in np.flatnonzero(cable.bare).tolist() for step in (1, 2)} - {1}
        if bare - near:
            free[number] = len(bare - near)
        if not own:
            warnings.append(
                f"cable {number} is nowhere within {MAX_SEWN_DEPTH:g} mm of the skin and gets no hole. Move it to the "
                "skin or make the robot of foam"
            )
            continue
        if max(hole.depth for hole in own) > _SHALLOW_DEPTH:
            shallow[number] = max(hole.depth for hole in own)
        if own[-1].after is Side.INSIDE or own[-1].point != len(cable.points):
            warnings.append(f"the stopper of cable {number} is inside the body. Adjust it through the opening")
    if shallow:
        warnings.append(
            f"{_cables(shallow)} simulated up to {max(shallow.values()):.0f} mm from the skin to which they are sewn. "
            "Their lever arms will differ. Move their points onto the skin to simulate the robot as built"
        )
    if free:
        warnings.append(
            f"{_cables(free)} simulated through {plural(sum(free.values()), 'point')} deeper than {MAX_SEWN_DEPTH:g} "
            "mm under the skin. Nothing holds them there: they run straight through the stuffing to the next hole"
        )
    return tuple(warnings)


def _cables(of: Iterable[int]) -> str:
    """Such as "cables 1, 2 were"."""
    numbers = [f"{number}" for number in of]
    return f"cable {numbers[0]} was" if len(numbers) == 1 else f"cables {', '.join(numbers)} were"
