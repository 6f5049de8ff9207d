"""`assembly_sheet`: the pages a person has on the bench while building, with pictures of the very robot."""

import json
from collections.abc import Sequence
from importlib.resources import files

from hydrostat.drawing import Camera, Canvas
from hydrostat.fabrication.kit_options import Method, Paper
from hydrostat.fabrication.kit_plan import KitFindings, KitPlan
from hydrostat.fabrication.lists.lists import Lists
from hydrostat.fabrication.lists.stitching import CableDepths
from hydrostat.fabrication.sheets.bench_words import SURFACES
from hydrostat.fabrication.sheets.cable_map import flat_map, space_map
from hydrostat.fabrication.sheets.diagrams import skin_scheme, stitch_scheme, stopper_scheme, wiring_scheme
from hydrostat.fabrication.sheets.facts import PictureFacts, PictureName, SheetData, SheetFacts
from hydrostat.fabrication.sheets.legible import PrintableText
from hydrostat.fabrication.sheets.list_facts import piece_numbers
from hydrostat.fabrication.sheets.map_layout import best_views, body_solid
from hydrostat.fabrication.sheets.sheet_facts import sheet_facts, shown_stitches
from hydrostat.fabrication.sheets.single_maps import single_maps
from hydrostat.fabrication.sheets.solid_pictures import exploded_picture, portrait, undercut_picture
from hydrostat.fabrication.winch_marks import winch_marks_of

_TEMPLATES = ("blocks.typ", "assembly_sheet.typ", "overview.typ")


def assembly_sheet(plan: KitPlan, lists: Lists, findings: KitFindings) -> bytes:
    """A PDF: three pages for plush, five for foam, four for a printed body, one of wires, and maps of single cables.

    The bytes are always the same.

    All words of the user reach the template as data, so that none of them is taken for markup.
    """
    import typst

    room = files("hydrostat.fabrication.sheets")
    pages = "plush_pages.typ" if plan.method is Method.PLUSH else "foam_pages.typ"  # a printed body has no mold page
    source = b"\n".join((room / name).read_bytes() for name in (*_TEMPLATES, pages, "wiring.typ"))
    robot = plan.robot
    views = best_views(robot, body_solid(robot)) if robot.body.mesh.dim == 3 else ()
    pictures = sheet_pictures(plan, lists, views)
    legible = PrintableText(robot)
    words: SheetFacts = legible.facts(sheet_facts(plan, lists, findings, letters=legible.warning))
    data: SheetData = {
        **words,
        "pictures": {name: _picture_facts(canvas) for name, canvas in pictures.items()},
        "singles": [_picture_facts(canvas) for canvas in _single_maps(plan, views)],
    }
    facts = json.dumps(data, ensure_ascii=False)
    # The time is the beginning of all time: a sheet is the same on every day.
    return typst.compile(source, sys_inputs={"sheet": facts}, ignore_system_fonts=True, timestamp=0)


def _picture_facts(canvas: Canvas) -> PictureFacts:
    return {"svg": canvas.svg, "width": canvas.width}


_DENSE = 6  # most cables of a body of foam that can be told apart on one map
WIDE, HALF = 182.0, 88.0  # widths of a page and of half a page without its margins [mm]; both fit both papers


def _shorter(paper: Paper) -> float:
    """Height that a page lacks against A4 [mm]."""
    return 18.0 if paper is Paper.LETTER else 0.0


def sheet_pictures(plan: KitPlan, lists: Lists, views: Sequence[Camera]) -> dict[PictureName, Canvas]:
    """Pictures by name, in millimeters of paper; views of a body in space, the best first."""
    robot, stitches, tight = plan.robot, plan.work.stitches, _shorter(plan.options.paper)
    pictures: dict[PictureName, Canvas] = {
        "portrait": portrait(robot, views[0] if views else None, width=44.0, height=32.0)
    }
    if views:
        pictures["map"] = space_map(robot, width=112.0, height=150.0 - tight / 2, views=views[:1])
        pictures["map_both"] = space_map(robot, width=WIDE, height=112.0 - tight / 2, views=views[1:])
    else:
        if plan.method is not Method.PLUSH:
            pictures["map_both"] = flat_map(robot, (), width=WIDE, height=112.0 - tight / 2)
        pictures["map"] = flat_map(robot, stitches, width=112.0, height=150.0 - tight / 2)
    pictures["calibration"] = stopper_scheme(cloth=SURFACES[plan.method], width=HALF, height=26.0)
    left = 238.0 - tight - pictures["map"].height
    if lists.power is not None:
        marks = winch_marks_of(robot)
        mine = tuple(marks[name] for name in lists.power.winches)
        pictures["wiring"] = wiring_scheme(lists.power, mine, width=WIDE)
    return pictures | _schemes(plan, lists) | _parts(plan, min(left, 112.0)) | _mould(plan)


def _single_maps(plan: KitPlan, views: Sequence[Camera]) -> list[Canvas]:
    """Pages of maps with one cable each: for a plush robot, and where one map of all is too dense."""
    dense = plan.method is Method.FOAM and len(plan.robot.cables) > _DENSE
    if not (plan.method is Method.PLUSH and plan.robot.cables) and not dense:
        return []
    height, view = (223.0 if views else 235.0) - _shorter(plan.options.paper), views[0] if views else None
    return single_maps(plan.robot, plan.work.stitches, width=WIDE, height=height, view=view)


def _schemes(plan: KitPlan, lists: Lists) -> dict[PictureName, Canvas]:
    cables = plan.robot.cables
    if plan.method is Method.FOAM:
        if not cables:
            return {}
        depths = CableDepths.of(lists.stitching, len(cables))
        drawn = bool(depths.drawn or depths.laid or depths.tubed)
        tubes = any(cable.sheathed for cable in cables)
        body = plan.cast_material
        return {"skin": skin_scheme(sewn=bool(depths.sewn), drawn=drawn, tubes=tubes, width=HALF, body=body)}
    shown = shown_stitches(plan)
    if shown is None:
        return {}
    mark = winch_marks_of(plan.robot)[shown.winch]
    return {"stitches": stitch_scheme(shown, mark, width=HALF, height=38.0)}


def _parts(plan: KitPlan, height: float) -> dict[PictureName, Canvas]:
    pictures: dict[PictureName, Canvas] = {}
    of_winch, of_stopper = piece_numbers(plan)
    winch, stopper = plan.rigid.winch_assembly, plan.rigid.stopper_assembly
    base, seat = plan.rigid.base_assembly, plan.rigid.seat_assembly
    if winch is not None:
        pictures["winch"] = exploded_picture(winch, of_winch, width=74.0, height=height)
    if stopper is not None:
        pictures["stopper"] = exploded_picture(stopper, of_stopper, width=38.0, height=min(0.6 * height, 52.0))
    if base is not None:
        pictures["base"] = exploded_picture(base, {}, width=HALF if seat is None else 0.55 * HALF, height=56.0)
    if seat is not None:
        pictures["seat"] = exploded_picture(seat, {}, width=0.4 * HALF, height=56.0)
    return pictures


def _mould(plan: KitPlan) -> dict[PictureName, Canvas]:
    mould = plan.work.mould
    if plan.method is not Method.FOAM or mould is None:
        return {}
    numbers = {placed.name: number for number, placed in enumerate(mould.assembly.pieces, start=1)}
    surface = mould.pull.surface
    return {
        "mould": exploded_picture(mould.assembly, numbers, width=HALF, height=92.0, view=Camera.at(-50.0, 24.0)),
        "undercut": undercut_picture(
            surface.vertices, surface.triangles, mould.pull.undercut, mould.pull.direction, width=50.0, height=62.0
        ),
    }
