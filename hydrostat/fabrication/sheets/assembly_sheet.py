"""`assembly_sheet`: the pages a person has on the bench while building."""

import json
from importlib.resources import files

from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.sheets.legible import Legible
from hydrostat.fabrication.sheets.sheet_facts import sheet_facts
from hydrostat.fabrication.sheets.sheet_input import SheetInput
from hydrostat.fabrication.sheets.sheet_pictures import sheet_pictures

_TEMPLATES = ("blocks.typ", "overview.typ", "assembly_sheet.typ")


def assembly_sheet(given: SheetInput) -> bytes:
    """A PDF of two pages for a robot of plush, four for one of foam; the same bytes for the same robot.

    All words of the user reach the template as data, so that none of them is taken for markup.
    """
    import typst

    room = files("hydrostat.fabrication.sheets")
    pages = "plush_pages.typ" if given.method is Method.PLUSH else "foam_pages.typ"
    source = b"\n".join((room / name).read_bytes() for name in (*_TEMPLATES, pages))
    pictures = {name: {"svg": canvas.svg, "width": canvas.width} for name, canvas in sheet_pictures(given).items()}
    legible = Legible(given.robot)
    words = legible.facts(sheet_facts(given, letters=legible.warning))
    facts = json.dumps({**words, "pictures": pictures}, ensure_ascii=False)
    # The time is the beginning of all time: a sheet is the same on every day.
    return typst.compile(source, sys_inputs={"sheet": facts}, ignore_system_fonts=True, timestamp=0)
