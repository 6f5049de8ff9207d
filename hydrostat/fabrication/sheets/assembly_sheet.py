"""`assembly_sheet`: the pages a person has on the bench while building, with pictures of the very robot."""

import json
import math
from importlib.resources import files

from hydrostat.drawing import Camera, Canvas
from hydrostat.fabrication.kit_options import Method, Paper
from hydrostat.fabrication.sheets.cable_map import body_solid, flat_map, space_map
from hydrostat.fabrication.sheets.legible import PrintableText, note_lines
from hydrostat.fabrication.sheets.list_facts import piece_numbers
from hydrostat.fabrication.sheets.schemes import skin_scheme, stitch_scheme, stopper_scheme
from hydrostat.fabrication.sheets.sheet_facts import sheet_facts, shown_stitches
from hydrostat.fabrication.sheets.sheet_input import SheetInput
from hydrostat.fabrication.sheets.sight import best_views
from hydrostat.fabrication.sheets.single_maps import single_maps
from hydrostat.fabrication.sheets.solid_pictures import exploded_picture, portrait, undercut_picture
from hydrostat.fabrication.sheets.steps import CableDepths
from hydrostat.fabrication.sheets.wiring import wiring_scheme
from hydrostat.fabrication.winch_marks import winch_marks_of

_TEMPLATES = ("blocks.typ", "overview.typ", "assembly_sheet.typ", "words.typ")


def assembly_sheet(given: SheetInput) -> bytes:
    """A PDF: two pages for a robot of plush, four for one of foam, one of wires. The same robot gives the same bytes.

    All words of the user reach the template as data, so that none of them is taken for markup.
    """
    import typst

    room = files("hydrostat.fabrication.sheets")
    pages = "plush_pages.typ" if given.method is Method.PLUSH else "foam_pages.typ"
    source = b"\n".join((room / name).read_bytes() for name in (*_TEMPLATES, pages, "wiring.typ"))
    pictures = {name: {"svg": canvas.svg, "width": canvas.width} for name, canvas in sheet_pictures(given).items()}
    legible = PrintableText(given.robot)
    words = legible.facts(sheet_facts(given, letters=legible.warning))
    facts = json.dumps({**words, "pictures": pictures}, ensure_ascii=False)
    # The time is the beginning of all time: a sheet is the same on every day.
    return typst.compile(source, sys_inputs={"sheet": facts}, ignore_system_fonts=True, timestamp=0)


WIDE, HALF = 182.0, 88.0  # widths of a page and of half a page without its margins [mm]; both fit both papers


def sheet_pictures(given: SheetInput) -> dict[str, Canvas]:
    """Pictures by name, in millimetres of paper."""
    tight = 18.0 if given.paper is Paper.LETTER else 0.0
    told = note_lines(given.problems, given.warnings, given.robot)
    boxed = 4.0 * sum(math.ceil(len(words) / 130) for words in told) + (4.0 if told else 0.0)
    robot = given.robot
    views = best_views(robot, body_solid(robot)) if robot.body.mesh.dim == 3 else ()
    pictures = {"portrait": portrait(robot, views[0] if views else None, width=44.0, height=32.0)}
    if views:
        pictures["map"] = space_map(robot, width=112.0, height=119.0 - (tight + boxed) / 2, views=views[:1])
        pictures["map_both"] = space_map(robot, width=WIDE, height=112.0 - tight / 2, views=views[1:])
    else:
        if given.method is Method.FOAM:
            pictures["map_both"] = flat_map(robot, (), width=WIDE, height=112.0 - tight / 2)
        pictures["map"] = flat_map(robot, given.stitches, width=112.0, height=119.0 - (tight + boxed) / 2)
    pictures["calibration"] = stopper_scheme(
        cloth="cloth" if given.method is Method.PLUSH else "skin", width=HALF, height=26.0
    )
    if robot.cables and given.method is not Method.FOAM:
        pages = single_maps(robot, given.stitches, width=WIDE, height=235.0 - tight, view=views[0] if views else None)
        pictures |= {f"single_{number}": page for number, page in enumerate(pages, start=1)}
    left = 195.0 - tight - boxed - pictures["map"].height
    power = given.lists.power
    if power is not None:
        marks = winch_marks_of(robot)
        mine = tuple(marks[name] for name in power.winches)
        pictures["wiring"] = wiring_scheme(power, mine, width=WIDE)
    return pictures | _schemes(given) | _parts(given, min(left, 112.0)) | _mould(given)


def _schemes(given: SheetInput) -> dict[str, Canvas]:
    if given.method is Method.FOAM:
        depths = CableDepths.of(given)
        drawn = bool(depths.drawn or depths.laid or depths.tubed)
        tubes = any(cable.sheathed for cable in given.robot.cables)
        if not given.robot.cables:
            return {}
        return {"skin": skin_scheme(sewn=bool(depths.sewn), drawn=drawn, tubes=tubes, width=HALF)}
    shown = shown_stitches(given)
    if shown is None:
        return {}
    mark = winch_marks_of(given.robot)[shown.winch]
    return {"stitches": stitch_scheme(shown, mark, width=HALF, height=38.0)}


def _parts(given: SheetInput, height: float) -> dict[str, Canvas]:
    pictures: dict[str, Canvas] = {}
    of_winch, of_stopper = piece_numbers(given)
    if given.winch is not None:
        pictures["winch"] = exploded_picture(given.winch, of_winch, width=74.0, height=height)
    if given.stopper is not None:
        pictures["stopper"] = exploded_picture(given.stopper, of_stopper, width=38.0, height=min(0.6 * height, 52.0))
    if given.base is not None:
        wide = HALF if given.seat is None else 0.55 * HALF
        pictures["base"] = exploded_picture(given.base, {}, width=wide, height=56.0)
    if given.seat is not None:
        pictures["seat"] = exploded_picture(given.seat, {}, width=0.4 * HALF, height=56.0)
    return pictures


def _mould(given: SheetInput) -> dict[str, Canvas]:
    mould = given.mould
    if given.method is not Method.FOAM or mould is None:
        return {}
    numbers = {placed.name: number for number, placed in enumerate(mould.assembly.pieces, start=1)}
    surface = mould.pull.surface
    return {
        "mould": exploded_picture(mould.assembly, numbers, width=HALF, height=92.0, view=Camera.at(-50.0, 24.0)),
        "undercut": undercut_picture(
            surface.vertices, surface.triangles, mould.pull.undercut, mould.pull.direction, width=50.0, height=62.0
        ),
    }
