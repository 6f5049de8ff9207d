"""`space_pattern`: the pattern of a plush body in space (R10): patches as pieces of cloth, lying as they are worn."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from shapely import LineString, Polygon
from shapely.affinity import translate
from shapely.geometry.polygon import orient

from hydrostat.arrays import Float
from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patches.cutting import cut_skin, patch_notes, patch_problems, patch_warnings, thin_direction
from hydrostat.fabrication.patches.flatten import distortion
from hydrostat.fabrication.patches.patch import Patch
from hydrostat.fabrication.patches.seams import PatchNotch, Seam, find_seams, patch_notches, stuffing_gap
from hydrostat.fabrication.patches.skin_holes import (
    SHARED_HOLE_DISTANCE,
    NearestOnSkin,
    SkinHole,
    find_holes,
    find_surface_runs,
    hole_problems,
    hole_warnings,
)
from hydrostat.fabrication.patches.skin_mesh import SkinMesh, skin_mesh
from hydrostat.fabrication.patterns.labels import PanelLabels
from hydrostat.fabrication.patterns.marks import HOLE_CLEARANCE, dash_lines
from hydrostat.fabrication.patterns.opening import Opening, opening_at
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.pinholes import Pinhole
from hydrostat.fabrication.patterns.shape import Circle, LaserLine, Layer, Panel, PatternPart, Place, Shape, trace
from hydrostat.fabrication.patterns.sheet_layout import lay_out
from hydrostat.fabrication.patterns.skin import Skin, skin_of
from hydrostat.fabrication.patterns.stitches import CableStitches, Side, Stitch
from hydrostat.robot import Body, Mount, Robot
from hydrostat.units import plural


def patch_skin(patch: Patch, options: PatternOptions) -> Skin:
    """Seam line and cut of a patch."""
    return skin_of(orient(patch.outline), options)


def patch_panel(
    name: str,
    title: str,
    skin: Skin,
    notches: Iterable[PatchNotch],
    cables: Iterable[tuple[int, tuple[tuple[SkinHole, Place], ...]]],
    opening: Opening | None,
    options: PatternOptions,
) -> Panel:
    """The panel of a patch; of each cable its number, and its holes on this patch in stitch order, with places [mm]."""
    strokes = [(notch.name, _stroke(notch.place, skin)) for notch in notches]
    cables = tuple(cables)
    shapes: list[Shape] = [
        *trace(skin.cut, Layer.CUT, PatternPart.EDGE),
        *trace(skin.slits, Layer.CUT, PatternPart.SLIT),
        *trace(skin.seam, Layer.MARK, PatternPart.SEAM),
        *(line for _, stroke in strokes for line in trace(stroke, Layer.MARK, PatternPart.NOTCH)),
        *((opening.mark, *opening.placket) if opening else ()),
    ]
    holes = [pair for _, own in cables for pair in own]
    for index, (hole, place) in enumerate(holes):
        if all(math.dist(place, other) > SHARED_HOLE_DISTANCE for _, other in holes[:index]):
            shapes += _hole(hole, place, options)
    for _, own in cables:
        shapes += _cable_lines(own, skin.seam, options)
    labels = PanelLabels(skin.seam, tuple(shapes), mirrored=False)
    labels.notch_names(strokes, skin.cut)
    if opening:
        labels.opening(opening)
    for cable, own in cables:
        if own:
            labels.cable_name(cable, own[-1][1])
    for hole, place in holes:
        labels.figure(f"{hole.point}", place)
    words = (title, name.replace("-", " "), f"{name[0]}{name.partition('-')[2]}")
    labels.title(next((text for text in words if labels.has_room(text)), words[-1]))
    labels.grain()
    return Panel(name=name, origin=(0.0, 0.0), mirrored=False, shapes=(*shapes, *labels.shapes()))


def _stroke(place: Place, skin: Skin) -> LineString:
    """Stroke from the seam across the allowance."""
    return shapely.shortest_line(shapely.Point(place), skin.cut.exterior)


def _hole(hole: SkinHole, place: Place, options: PatternOptions) -> tuple[Shape, ...]:
    """A pinhole, or a cross on the seam line where the cable passes between two stitches."""
    x, y = place
    if not hole.in_seam:
        return (Circle(layer=Layer.PINHOLE, part=PatternPart.PINHOLE, center=place, radius=options.pinhole / 2),)
    cross = 2.0
    return tuple(
        LaserLine(layer=Layer.GUIDE, part=PatternPart.MARKER, points=((x - dx, y - dy), (x + dx, y + dy)))
        for dx, dy in ((cross, cross), (cross, -cross))
    )


def _cable_lines(own: tuple[tuple[SkinHole, Place], ...], seam: Polygon, options: PatternOptions) -> tuple[Shape, ...]:
    """The cable between neighboring holes on this patch: solid outside, dashed inside."""
    shapes: list[Shape] = []
    clear = options.pinhole / 2 + HOLE_CLEARANCE
    for (hole, place), (following, there) in pairwise(own):
        if following.point != hole.point + 1 or (hole.in_seam and following.in_seam):
            continue  # from seam to seam it runs along the seam
        ends = shapely.union_all([shapely.Point(end).buffer(clear) for end in (place, there)])
        drawn = LineString([place, there]).intersection(seam).difference(ends)
        drawn = shapely.MultiLineString([part for part in shapely.get_parts(drawn).tolist() if part.length])
        if hole.after is Side.INSIDE:
            drawn = dash_lines(drawn)
        shapes += trace(drawn, Layer.GUIDE, PatternPart.CABLE)
    return tuple(shapes)


@dataclass(frozen=True, eq=False, kw_only=True)
class FrontView:
    """The view of the front."""

    right: Float[np.ndarray, " 3"]  # unit direction that points to the right in it
    up: Float[np.ndarray, " 3"]  # unit direction that points up in it

    def on_paper(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
        """Project points to the view."""
        return points @ np.stack([self.right, self.up], axis=1)


def front_view(thin: Float[np.ndarray, " 3"]) -> FrontView:
    """Look along the thin direction, z up; y up where that is the thin direction."""
    up = _across(np.eye(3)[2], thin)
    if np.linalg.norm(up) < 0.3:
        up = _across(np.eye(3)[1], thin)
    up = up / np.linalg.norm(up)
    return FrontView(right=np.cross(thin, up), up=up)


def upright(patch: Patch, up: Float[np.ndarray, " 3"]) -> Patch:
    """The patch turned on the cloth so that it lies as it is worn, its middle at the origin."""
    corners = patch.disc.vertices[patch.disc.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0)
    normal = normal / np.linalg.norm(normal)
    upward = _across(up, normal)
    if np.linalg.norm(upward) < 0.3:
        upward = _across(np.eye(3)[int(np.abs(normal).argmin())], normal)
    upward = upward / np.linalg.norm(upward)
    worn = corners.mean(axis=1) @ np.stack([np.cross(upward, normal), upward], axis=1)
    flat = patch.flat[patch.disc.triangles].mean(axis=1)
    worn, middle = worn - worn.mean(axis=0), np.average(flat, axis=0, weights=patch.disc.areas)
    one, other = (flat - middle) @ [1, 1j], worn @ [1, 1j]
    turn = np.sum(patch.disc.areas * np.conj(one) * other)
    turned = ((patch.flat - middle) @ [1, 1j]) * (turn / abs(turn))
    return replace(patch, flat=np.stack([turned.real, turned.imag], axis=1))


def _across(direction: Float[np.ndarray, " 3"], normal: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """The part of a direction across another."""
    return direction - (direction @ normal) * normal


@dataclass(frozen=True, eq=False, kw_only=True)
class SpacePattern(Pattern):
    """The pattern of a body in space; `stitches` are as seen from the front, `opening` is on the sheet."""

    patches: tuple[Patch, ...]  # flat, in places of the sheet [mm]; a panel each, in the same order
    seams: tuple[Seam, ...]  # between them, in places of the sheet [mm]
    holes: tuple[SkinHole, ...]  # places on the sheet where cables are sewn to the skin [mm]
    skin: float  # area of the skin that was cut [mm^2]


def space_pattern(robot: Robot, options: PatternOptions) -> SpacePattern:
    """The skin of a body in space in patches, to be sewn, turned and stuffed; all show the right side of the cloth.

    Raises InputError: the body is flat, hollow, in several pieces or has a hole through it, or it cannot be sewn as it
    is (unless `force`).
    """
    mesh = skin_mesh(robot.body)
    view = front_view(thin_direction(mesh))
    cutting = cut_skin(mesh)
    patches = tuple(upright(patch, view.up) for patch in cutting.patches)
    seams = find_seams(cutting.mesh, patches, view.up)
    holes = find_holes(robot, patches, seams, options)
    skins = tuple(patch_skin(patch, options) for patch in patches)
    names = cutting.names
    problems = (
        *patch_problems(names, patches, skins, seams),
        *hole_problems(holes, options),
        *find_surface_runs(robot, patches, holes),
    )
    if problems and not options.force:
        first, *others = problems
        raise InputError(f"{first} (and {len(others)} more such)" if others else first)
    notches = patch_notches(seams)
    opening = back_opening(robot, cutting.back, patches, holes, view, options)
    panels = []
    for number, (name, skin) in enumerate(zip(names, skins, strict=True)):
        title = f"{robot.name} - {name.replace('-', ' ')}"
        cables = _on_patch(robot, holes, number)
        slit = opening[1] if opening and opening[0] == number else None
        panels.append(patch_panel(name, title, skin, notches[number], cables, slit, options))
    sheet = lay_out(tuple(panels[:2]), tuple(panels[2:]), options.gap)
    origins = [panel.origin for panel in sheet.panels]
    moved = tuple(
        replace(patch, flat=patch.flat + np.array(origin)) for patch, origin in zip(patches, origins, strict=True)
    )
    return SpacePattern(
        name=robot.name,
        panels=sheet.panels,
        shapes=sheet.ruler,
        width=sheet.width,
        height=sheet.height,
        stitches=skin_stitches(robot, holes, view),
        opening=None if opening is None else _on_sheet(opening[1], origins[opening[0]]),
        problems=problems,
        warnings=(
            *patch_warnings(names, patches, seams),
            *(opening[1].warnings if opening else stuffing_gap(seams, names)),
            *hole_warnings(robot, holes),
        ),
        notes=patch_notes(names, skins),
        patches=moved,
        seams=find_seams(cutting.mesh, moved, view.up),
        holes=tuple(_move_hole(hole, origins) for hole in holes),
        skin=float(mesh.areas.sum()),
    )


def _on_patch(
    robot: Robot, holes: tuple[SkinHole, ...], patch: int
) -> list[tuple[int, tuple[tuple[SkinHole, Place], ...]]]:
    """Each cable with its points on a patch."""
    return [
        (
            number,
            tuple(
                (hole, place)
                for hole in holes
                if hole.cable == number and hole.passes and (place := hole.on(patch)) is not None
            ),
        )
        for number in range(1, len(robot.cables) + 1)
    ]


def _on_sheet(opening: Opening, origin: Place) -> Opening:
    """The opening in places of the sheet."""
    return replace(opening, slit=translate(opening.slit, *origin))


def _move_hole(hole: SkinHole, origins: list[Place]) -> SkinHole:
    """The hole in places of the sheet."""
    places = tuple((number, (x + origins[number][0], y + origins[number][1])) for number, (x, y) in hole.places)
    return replace(hole, places=places)


def back_opening(
    robot: Robot,
    back: tuple[bool, ...],
    patches: tuple[Patch, ...],
    holes: tuple[SkinHole, ...],
    view: FrontView,
    options: PatternOptions,
) -> tuple[int, Opening] | None:
    """The zipper in the patch of the back that is behind the winches, and the number of that patch."""
    inside = [1e3 * np.array(winch.at) for winch in robot.winches if winch.mount is not Mount.WORLD]
    if not inside:
        return None
    at = _level(view.on_paper(np.array(inside)))
    best: tuple[float, int, list[Place]] | None = None
    for number, patch in enumerate(patches):
        if not back[number]:
            continue
        seen = Patch(disc=replace(patch.disc, vertices=_level(view.on_paper(patch.disc.vertices))), flat=patch.flat)
        behind, _, places = NearestOnSkin((seen,)).nearest(at)
        gap = float(np.linalg.norm(behind - at, axis=1).sum())
        if best is None or gap < best[0]:
            best = (gap, number, [(x, y) for x, y in places.tolist()])
    if best is None:
        return None
    number, places = best[1], best[2]
    own = [(hole, place) for hole in holes if hole.passes and (place := hole.on(number)) is not None]
    pinholes = tuple(Pinhole(place, options.pinhole / 2, ((hole.cable - 1, hole.point - 1),)) for hole, place in own)
    opening = opening_at(places, patches[number].outline, pinholes, options)
    return None if opening is None else (number, opening)


def _level(places: Float[np.ndarray, "places 2"]) -> Float[np.ndarray, "places 3"]:
    """Places of a drawing in space."""
    return np.column_stack([places, np.zeros(len(places))])


def skin_stitches(robot: Robot, holes: tuple[SkinHole, ...], view: FrontView) -> tuple[CableStitches, ...]:
    """Return the stitches of each cable; points deep inside stay on the side of the one before."""
    sewn = []
    for number, cable in enumerate(robot.cables, start=1):
        begins = Side.OUTSIDE if robot.winch(cable.winch).mount is Mount.WORLD else Side.INSIDE
        own = {hole.point: hole for hole in holes if hole.cable == number}
        stitches, side = [], begins
        for point, (x, y) in enumerate(view.on_paper(1e3 * np.array(cable.points)).tolist(), start=1):
            hole = own.get(point)
            side = hole.after if hole else side
            stitches.append(Stitch(number=point, place=(x, y), passes=bool(hole and hole.passes), after=side))
        sewn.append(CableStitches(cable=number, winch=cable.winch, begins=begins, stitches=tuple(stitches)))
    return tuple(sewn)


@dataclass(frozen=True, kw_only=True)
class Sewing:
    """Sewing work for the skin of a body, without its cables."""

    patches: int  # number of patches of cloth; 0 if it cannot be cut at all
    give: float  # stretch of the cloth in 95 % of the worst patch: 0.1 for 10 %
    problems: tuple[str, ...]  # reasons why it cannot be sewn, one line each

    def __str__(self) -> str:
        """In words, such as "2 patches, cloth with 9 % stretch"."""
        return f"{plural(self.patches, 'patch')}, cloth with {100 * self.give:.0f} % stretch"

    @staticmethod
    def of_mesh(mesh: SkinMesh, options: PatternOptions) -> "Sewing":
        """Compute the sewing work of a skin, with the reasons if it cannot be sewn."""
        cutting = cut_skin(mesh)
        skins = tuple(patch_skin(patch, options) for patch in cutting.patches)
        seams = find_seams(cutting.mesh, cutting.patches, np.eye(3)[2])
        return Sewing(
            patches=len(cutting.patches),
            give=max(distortion(patch).give(0.95) for patch in cutting.patches),
            problems=patch_problems(cutting.names, cutting.patches, skins, seams),
        )

    @staticmethod
    def find(body: Body, *, options: PatternOptions | None = None) -> "Sewing":
        """Cut and flatten the skin of a body in space as its kit will, with the reasons if it cannot be sewn.

        It takes seconds. Raises InputError: a flat body.
        """
        if body.mesh.dim != 3:
            raise InputError("a flat body has a flat pattern of its own")
        try:
            return Sewing.of_mesh(skin_mesh(body), options or PatternOptions())
        except InputError as error:
            return Sewing(patches=0, give=0.0, problems=(str(error),))
