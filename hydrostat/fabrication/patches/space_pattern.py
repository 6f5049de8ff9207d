"""`space_pattern`: the pattern of a plush body in space (R10)."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from shapely.affinity import translate

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patches.cutting import cut_skin, patch_problems, patch_warnings, thin_direction
from hydrostat.fabrication.patches.flatten import distortion
from hydrostat.fabrication.patches.patch import Patch
from hydrostat.fabrication.patches.patch_panel import patch_panel, patch_skin
from hydrostat.fabrication.patches.seams import Seam, find_seams, patch_notches, stuffing_gap
from hydrostat.fabrication.patches.skin_holes import (
    NearestOnSkin,
    SkinHole,
    find_holes,
    hole_problems,
    hole_warnings,
    way_problems,
)
from hydrostat.fabrication.patches.skin_mesh import skin_mesh
from hydrostat.fabrication.patches.view import FrontView, front_view, upright
from hydrostat.fabrication.patterns.opening import Opening, opening_at
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.pinholes import Pinhole
from hydrostat.fabrication.patterns.shape import Place
from hydrostat.fabrication.patterns.sheet_layout import lay_out
from hydrostat.fabrication.patterns.stitches import CableStitches, Side, Stitch
from hydrostat.robot import Mount, Robot


@dataclass(frozen=True, eq=False, kw_only=True)
class SpacePattern(Pattern):
    """The pattern of a body in space; `stitches` are as seen from the front, `opening` is on the sheet."""

    patches: tuple[Patch, ...]  # flat, in places of the sheet [mm]; a panel each, in the same order
    seams: tuple[Seam, ...]  # between them, in places of the sheet [mm]
    holes: tuple[SkinHole, ...]  # where cables are sewn to the skin, in places of the sheet [mm]
    skin: float  # area of the skin that was cut [mm^2]
    distortions: tuple[str, ...]  # what the cloth has to give, a line for each patch


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
        *way_problems(robot, patches, holes),
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
            *patch_warnings(names, patches, skins, seams),
            *(opening[1].warnings if opening else stuffing_gap(seams, names)),
            *hole_warnings(robot, holes),
        ),
        patches=moved,
        seams=find_seams(cutting.mesh, moved, view.up),
        holes=tuple(_moved(hole, origins) for hole in holes),
        skin=float(mesh.areas.sum()),
        distortions=tuple(f"{name}: {distortion(patch).text()}" for name, patch in zip(names, patches, strict=True)),
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


def _moved(hole: SkinHole, origins: list[Place]) -> SkinHole:
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
    """Tell how each cable is sewn; points deep inside stay on the side of the one before."""
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
