"""`plush_work`: what a body of felt takes: its pattern as drawings and as pages (R10)."""

from dataclasses import replace

from hydrostat.fabrication.body_work import BodyWork
from hydrostat.fabrication.checks.pattern_checks import patch_checks, pattern_checks
from hydrostat.fabrication.kit_options import STUFFINGS, KitOptions
from hydrostat.fabrication.lists.list_input import Cloth
from hydrostat.fabrication.patches.space_pattern import space_pattern
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import Pattern, plush_pattern
from hydrostat.fabrication.patterns.shape import Circle, PatternPart
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.fabrication.sheets.tiles import tiled_pdf
from hydrostat.robot import Robot
from hydrostat.units import counted


def plush_work(robot: Robot, options: KitOptions) -> BodyWork:
    """Make the pattern of a body: of a flat one front and back, of one in space its skin in patches.

    Raises InputError: the body is in several pieces, or its skin cannot be cut into patches.
    """
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
        files={
            "pattern/pattern.svg": svg,
            "pattern/pattern.dxf": dxf,
            f"pattern/pattern_{options.paper}.pdf": tiled_pdf(pattern, options.paper),
        },
        holes=sum(shape.part is PatternPart.PINHOLE for panel in pattern.panels for shape in panel.shapes),
        stitches=pattern.stitches,
        gusset=bool(pattern.gusset),
        cloth=_cloth(pattern),
        summary=(f"Pattern: {counted(len(pattern.panels), 'panel')} on {_size(pattern)} mm of felt",),
        problems=(*pattern.problems, *_wrong_stuffing(robot)),
        warnings=pattern.warnings,
        checks=checks,
    )


def _wrong_stuffing(robot: Robot) -> tuple[str, ...]:
    """Why what is built would be another robot than was simulated; nothing is said of a material given by numbers."""
    name = robot.body.material.name
    if not name or name in STUFFINGS:
        return ()
    return (
        f'the body was simulated as "{name}", which is not stuffed into cloth: set its material to '
        f'"{STUFFINGS[0]}" and simulate again, or cast it (--method foam)',
    )


def _size(pattern: Pattern) -> str:
    return f"{pattern.width:.0f} x {pattern.height:.0f}"


def _cloth(pattern: Pattern) -> Cloth:
    """What the sheet takes: all of its felt, and every seam that is drawn once for each of two panels."""
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
    )
