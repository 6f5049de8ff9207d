"""`plush_work`, `foam_work`: the pattern of a body of felt (R10), the mold and mixes of one of foam (R50 to R54)."""

from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import shapely

from hydrostat.arrays import Float
from hydrostat.fabrication.checks.mold_checks import mold_checks
from hydrostat.fabrication.checks.pattern_checks import patch_checks, pattern_checks
from hydrostat.fabrication.kit_options import (
    BLOCKS,
    MATERIAL_FIX,
    PRINTED,
    STUFFINGS,
    KitOptions,
    MoldKind,
    PartOptions,
    block_problem,
)
from hydrostat.fabrication.kit_plan import BodyWork, Cloth, FoamNeeds
from hydrostat.fabrication.moulds.mould import make_mold
from hydrostat.fabrication.moulds.pocket import WinchRoom
from hydrostat.fabrication.parts.winch_unit import WinchUnit
from hydrostat.fabrication.patches.space_pattern import space_pattern
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import Pattern, plush_pattern
from hydrostat.fabrication.patterns.shape import Circle, PatternPart
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.fabrication.solids.construct import sides_text
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import CableSide, Mount, Robot
from hydrostat.units import plural

MANY_PIECES = 40  # more pieces of a mold than that are a warning: a judgment, each is some hours on a printer


def foam_work(robot: Robot, options: KitOptions, units: Iterable[WinchUnit]) -> BodyWork:
    """Make the mold of a body, with room for the winches that sit in it (InputError: the body is not closed)."""
    pockets = {
        unit.winch: WinchRoom(low=unit.room.low, high=unit.room.high) for unit in units if unit.mount is Mount.BODY
    }
    mould = make_mold(robot, options.mould, pockets=pockets)
    spare = tuple(part for part in mould.printed if part.name.startswith("positive") and mould.kind is MoldKind.PRINTED)
    printed = tuple(part for part in mould.printed if part not in spare)
    pieces, sides = sum(part.count for part in printed), sides_text(mould.box)
    body, held = mould.casting.body, 100 * mould.pull.share
    return BodyWork(
        printed=printed,
        spare=spare,
        assemblies=(mould.assembly,),
        foam=FoamNeeds(
            volume=body.volume,
            part_a=body.part_a,
            part_b=body.part_b,
            material=body.material,
            silicone=sum(mix.volume for mix in mould.casting.silicone),
            silicone_mass=sum(mix.mass for mix in mould.casting.silicone),
            bolts=mould.bolts,
            dowels=mould.dowels,
        ),
        mould=mould,
        summary=(
            f"Mold: {plural(pieces, 'piece')}, closed {sides} mm; {held:.1f} % of the skin is undercut",
            f"Pour: {body.mass:.0f} g of {body.material}",
        ),
        problems=(*mould.problems, *channel_problems(robot, options.parts)),
        warnings=(*mould.warnings, *_effort(printed)),
        notes=(*mould.notes, *_inside(robot)),
        checks=mold_checks(robot, mould),
    )


def _inside(robot: Robot) -> tuple[str, ...]:
    """Return a note if a flat robot is cast but has its cables on its faces."""
    if robot.face in (None, CableSide.MIDDLE) or not robot.cables:
        return ()
    return (
        f"the robot file places its cables {robot.face.words}, but in a cast body they run in the middle of its "
        "thickness. Both keep the body flat, and pairs are not needed",
    )


def _effort(printed: tuple[Printed, ...]) -> tuple[str, ...]:
    """Return a warning if a mold takes much printing."""
    pieces, mass = sum(part.count for part in printed), sum(part.count * part.mass for part in printed)
    # more plastic for a mold than that is a warning [g]: five of the usual spools, a judgment too
    much_plastic = 5e3
    if pieces <= MANY_PIECES and mass <= much_plastic:
        return ()
    return (
        f"the mold needs {plural(pieces, 'piece')} and {1e-3 * mass:.1f} kg of plastic. Make the body smaller, use "
        "a printer with a larger bed, or cut the body out of a block of foam",
    )


SKIN = 1.0  # Least foam between a tube and the skin [mm]: thinner, it tears when the tube is pulled. Measured on none.


def channel_problems(robot: Robot, options: PartOptions) -> tuple[str, ...]:
    """Return a line for each sheath that comes too near the skin between two deeper places; near its ends it may."""
    solid = robot.body.solid
    if solid is None:
        return ()
    needed = options.tube / 2 + SKIN
    problems = []
    for number, cable in enumerate(robot.cables, start=1):
        for start, end in cable.sheathed:
            places = _along(np.array(cable.points[start : end + 1]))
            depths = -1e3 * solid.distances(places)
            thin = _between(depths, needed)
            if thin is not None:
                at = ", ".join(f"{1e3 * value:.0f}" for value in places[thin])
                problems.append(
                    f"cable {number}: its tube comes within {max(depths[thin], 0.0):.1f} mm of the skin at [{at}] mm, "
                    f"but needs {needed:.1f} mm of depth. Move the points of the sheath inwards"
                )
    return tuple(problems)


def _between(depths: Float[np.ndarray, " places"], needed: float) -> int | None:
    """The shallowest place between the first and the last deep one, if it is too shallow."""
    deep = np.flatnonzero(depths >= needed)
    if not len(deep):
        return None
    inner = depths[deep[0] : deep[-1] + 1]
    lowest = int(inner.argmin())
    return int(deep[0]) + lowest if inner[lowest] < needed else None


def _along(points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "places 3"]:
    """Places along a line through points [m]."""
    pieces = []
    step = 1e-3  # distance of the places that are looked at [m]
    for one, other in pairwise(points):
        count = max(int(np.ceil(np.linalg.norm(other - one) / step)), 1)
        pieces.append(one + np.linspace(0.0, 1.0, count, endpoint=False)[:, None] * (other - one))
    return np.concatenate([*pieces, points[-1:]])


def plush_work(robot: Robot, options: KitOptions) -> BodyWork:
    """Make the pattern of a body (InputError: it is in several pieces, or its skin cannot be cut into patches)."""
    drawn = replace(options.pattern, force=True)
    if robot.body.mesh.dim == 2:
        pattern = plush_pattern(robot, options=drawn)
        svg, dxf = pattern_svg(pattern), pattern_dxf(pattern)
        checks = pattern_checks(robot, pattern, svg, dxf, drawn)
    else:
        pattern = space_pattern(robot, drawn)
        svg, dxf = pattern_svg(pattern), pattern_dxf(pattern)
        checks = patch_checks(robot, pattern, svg, dxf)
    return BodyWork(
        files={"pattern/pattern.svg": svg, "pattern/pattern.dxf": dxf},
        pattern=pattern,
        holes=sum(shape.part is PatternPart.PINHOLE for panel in pattern.panels for shape in panel.shapes),
        stitches=pattern.stitches,
        gusset=bool(pattern.gusset),
        cloth=_cloth(pattern),
        summary=(f"Pattern: {plural(len(pattern.panels), 'panel')} on {_size(pattern)} mm of felt",),
        problems=(*pattern.problems, *stuffing_problems(robot)),
        warnings=pattern.warnings,
        notes=pattern.notes,
        checks=checks,
    )


def stuffing_problems(robot: Robot) -> tuple[str, ...]:
    """Return a problem if the body's material is no stuffing; none for a material given by numbers."""
    name = robot.body.material.name
    if not name or name in STUFFINGS:
        return ()
    if name in BLOCKS:
        return (block_problem(name),)
    how = "print it (--method print)" if name in PRINTED else "cast it (--method foam)"
    return (
        f'the body was simulated as "{name}", which is no stuffing for cloth. {MATERIAL_FIX} "{STUFFINGS[0]}" and '
        f"simulate again, or {how}",
    )


def _size(pattern: Pattern) -> str:
    return f"{pattern.width:.0f} x {pattern.height:.0f}"


def _cloth(pattern: Pattern) -> Cloth:
    """Felt, seam and zipper that the sheet needs; each seam is drawn on two panels and counts once."""
    seams = (
        shape.geometry.length
        for panel in pattern.panels
        for shape in panel.shapes
        if shape.part is PatternPart.SEAM and not isinstance(shape, Circle)
    )
    return Cloth(
        felt=pattern.width * pattern.height,
        seam=sum(seams) / 2,
        zipper=0.0 if pattern.opening is None else float(pattern.opening.zipper),
        panels=_panel_sizes(pattern),
    )


def _panel_sizes(pattern: Pattern) -> tuple[tuple[float, float], ...]:
    """Width and height of each panel [mm]."""
    bounds = [
        shapely.total_bounds([shape.geometry for shape in panel.shapes if shape.part is PatternPart.EDGE])
        for panel in pattern.panels
    ]
    return tuple((float(box[2] - box[0]), float(box[3] - box[1])) for box in bounds)
