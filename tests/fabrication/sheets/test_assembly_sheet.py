"""The assembly sheet, read back by pypdf."""

import io
from dataclasses import replace
from importlib.resources import files

import pytest
from pypdf import PdfReader
from sheet_inputs import checks, foam, plush, tables

from hydrostat.fabrication.kit_options import Paper
from hydrostat.fabrication.lists.table import Align, Column, Table
from hydrostat.fabrication.moulds.casting import make_casting
from hydrostat.fabrication.sheets.assembly_sheet import assembly_sheet
from hydrostat.fabrication.sheets.bill_facts import shortened
from hydrostat.robot import MATERIALS, Mount

NASTY = '#let x = 1 $*_ <b>&"\\'


def read(content: bytes) -> PdfReader:
    return PdfReader(io.BytesIO(content))


def words(content: bytes) -> str:
    return " ".join("\n".join(page.extract_text() for page in read(content).pages).split())


@pytest.fixture(scope="module")
def plush_sheet():
    return assembly_sheet(plush())


@pytest.fixture(scope="module")
def foam_sheet():
    return assembly_sheet(foam())


@pytest.mark.parametrize(("make", "pages"), [(plush, 2), (foam, 4)])
@pytest.mark.parametrize(("paper", "size"), [(Paper.A4, (595.28, 841.89)), (Paper.LETTER, (612.0, 792.0))])
def test_pages_and_paper(make, pages, paper, size):
    reader = read(assembly_sheet(make(paper=paper)))
    assert len(reader.pages) == pages
    for page in reader.pages:
        assert (float(page.mediabox.width), float(page.mediabox.height)) == pytest.approx(size, abs=0.01)


def test_the_same_bytes(plush_sheet, foam_sheet):
    assert assembly_sheet(plush()) == plush_sheet
    assert assembly_sheet(foam()) == foam_sheet


def test_another_robot_gives_other_bytes(plush_sheet):
    assert assembly_sheet(plush(cables=3)) != plush_sheet


def test_what_a_plush_sheet_says(plush_sheet):
    text = words(plush_sheet)
    for part in (
        "You need",
        "Where the cables run",
        "Stitch the cables",
        "Safety",
        "Calibrate",
        "Before the first pose",
    ):
        assert part in text
    assert "thing number 8" in text
    assert "121.5" in text
    assert "C2" in text
    assert "100 × 100 × 30 mm" in text
    assert "1 winch, 2 cables" in text
    assert "Never PVC" in text


def test_what_a_foam_sheet_says(foam_sheet):
    text = words(foam_sheet)
    for part in (
        "12.3 % of the surface",
        "6 bolts M4",
        "24 h, or 6 h at 60 °C",
        "less than 5 min",
        "isocyanate",
        "glove",
    ):
        assert part in text
    given = foam()
    assert given.mould is not None
    assert f"{given.mould.casting.body.part_a:.0f} g of part A" in text


def test_a_mould_of_silicone_follows_the_nine_steps():
    text = words(assembly_sheet(foam(silicone=True)))
    assert "Follow the nine steps" in text
    assert "mold max 30, second pour" in text


def test_a_body_of_silicone_is_not_told_of_foam(foam_sheet):
    given = foam()
    assert given.mould is not None
    casting, _ = make_casting(MATERIALS["ecoflex 00-30"], 480e3, pours=())
    text = words(assembly_sheet(foam(mould=replace(given.mould, casting=casting))))
    assert "isocyanate" not in text
    assert "let the bubbles rise" in text
    assert "4 h at 25 C" in text
    assert "egg mixer as long" in words(foam_sheet)


def test_motors_in_the_body_need_no_base(foam_sheet):
    given = foam()
    inside = tuple(
        replace(winch, at=cable.points[1], mount=Mount.BODY)
        for winch, cable in zip(given.robot.winches, given.robot.cables, strict=True)
    )
    cables = tuple(replace(cable, points=cable.points[1:], sheathed=()) for cable in given.robot.cables)
    text = words(assembly_sheet(replace(given, robot=given.robot.with_network(inside, cables))))
    assert "its pocket in the foam" in text
    assert "the base" not in text
    assert "leaves the base" in words(foam_sheet)


@pytest.mark.parametrize("make", [plush, foam])
def test_names_are_words_not_markup(make):
    assert NASTY in words(assembly_sheet(make(name=NASTY)))


def test_names_in_other_alphabets():
    assert "Übergrößenärmel Жук" in words(assembly_sheet(plush(name="Übergrößenärmel Жук")))


@pytest.mark.parametrize("name", ["octopus " * 40, "x" * 400])
def test_long_names_are_shortened(name):
    content = assembly_sheet(plush(name=name))
    assert len(read(content).pages) == 2
    assert shortened(name, 60)[:20] in words(content)
    assert shortened(name, 60).endswith("…")
    assert len(shortened(name, 60)) <= 60


@pytest.mark.parametrize(
    ("make", "pages", "paper"), [(plush, 2, Paper.A4), (plush, 2, Paper.LETTER), (foam, 4, Paper.LETTER)]
)
def test_a_crowded_sheet_has_no_more_pages(make, pages, paper):
    long = "The spool of winch “pull 1” takes 71 mm of cable, but its travel asks for 740 mm; " * 4
    given = make(
        winches=12,
        cables=24,
        paper=paper,
        problems=(long,) * 9,
        tables=tables(24, bill=90),
        checks=checks(90, failed=1),
    )
    content = assembly_sheet(given)
    assert len(read(content).pages) == pages
    text = words(content)
    assert "more in bill_of_materials.csv" in text
    assert "and 2 more in manifest.json" in text
    # What failed stands first, however many there are.
    assert "claim 89" in text


def test_warnings_stand_in_a_box_and_problems_say_that_it_was_forced(plush_sheet):
    quiet = words(plush_sheet)
    warned = words(assembly_sheet(plush(warnings=("mind the cat",))))
    forced = words(assembly_sheet(plush(problems=("the cat sits on it",))))
    assert "MIND" not in quiet
    assert "Mind the cat." in warned
    assert "cannot be built well" not in warned
    assert "The cat sits on it." in forced
    assert "cannot be built well" in forced


def test_nothing_but_the_robot_is_enough():
    given = plush(winch=None, stopper=None, printed=(), tables={}, checks=())
    assert len(read(assembly_sheet(given)).pages) == 2
    given = foam(winch=None, stopper=None, printed=(), tables={}, checks=(), mould=None)
    assert len(read(assembly_sheet(given)).pages) == 4


def test_the_bill_is_told_in_short_with_one_sum():
    words_of = [Column(title=title, align=Align.LEFT) for title in ("what", "specification")]
    columns = (*words_of, Column(title="quantity"), Column(title="unit", align=Align.LEFT), Column(title="used up"))
    rows = (
        ("felt", "no PVC", 0.2, "m^2", 4.0),
        ("screw or nut", "M2 x 6 mm screw, self-tapping", 12.0, "piece", 1.0),
        ("filling", "fibre", 0.05, "kg", 2.0),
        ("total", "", None, "", 7.0),
    )
    bill = Table(name="bill_of_materials", title="Bill", columns=columns, rows=rows)
    text = words(assembly_sheet(plush(tables={"bill_of_materials": bill})))
    for part in ("felt 0.2 m² 4", "M2 x 6 mm screw 12 1", "filling 50 g 2", "together 7", "of work, 7 USD"):
        assert part in text
    assert "total" not in text


def test_a_list_with_other_columns_is_told_whole():
    other = Table(
        name="cable_cuts",
        title="Cables",
        columns=tables(1)["bill_of_materials"].columns,
        rows=(("rope", 1.5, "m", 2.0),),
    )
    assert "rope" in words(assembly_sheet(plush(tables={"cable_cuts": other})))


def test_all_type_is_large_enough_and_comes_with_typst():
    sizes, fonts = set(), set()

    def note(text, page, matrix, font, size):
        if text.strip():
            sizes.add(round(size * abs(matrix[3] * page[3]), 2))

    for page in read(assembly_sheet(plush(winches=8, cables=11))).pages:
        page.extract_text(visitor_text=note)
        for font in page["/Resources"]["/Font"].values():
            fonts.add(str(font.get_object()["/BaseFont"]).split("+")[-1])
    assert min(sizes) >= 7.49
    assert {font.split("-")[0] for font in fonts} <= {"LibertinusSerif", "DejaVuSansMono"}


def test_templates_come_with_the_package():
    room = files("hydrostat.fabrication.sheets")
    for name in ("assembly_sheet", "blocks", "overview", "plush_pages", "foam_pages"):
        assert (room / f"{name}.typ").is_file()
