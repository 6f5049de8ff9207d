"""The assembly sheet, read back by pypdf."""

import io
import pickle
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from importlib.resources import files

import pytest
from kit_plans import FewParts
from page_words import read_words as words
from pypdf import PdfReader
from sheet_inputs import Given, changed, checks, foam, lists, plush

from hydrostat.drawing import Camera, DrawnSolid, LineDrawing
from hydrostat.fabrication.kit_options import Method, Paper, PartOptions
from hydrostat.fabrication.lists.bill import BillGroup, Item, Price
from hydrostat.fabrication.lists.motors import power_plan
from hydrostat.fabrication.lists.stitching import DepthRow, PointAccess
from hydrostat.fabrication.lists.table import Table
from hydrostat.fabrication.moulds.casting import make_casting
from hydrostat.fabrication.parts.motor import ALL_MOTORS, MOTORS
from hydrostat.fabrication.parts.winch_unit import winch_units
from hydrostat.fabrication.sheets.assembly_sheet import assembly_sheet
from hydrostat.fabrication.sheets.legible import legible, note_lines, shorten_text, typeset
from hydrostat.fabrication.sheets.list_facts import power_facts
from hydrostat.fabrication.sheets.plush_steps import plush_steps
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import MATERIALS, Mount

NASTY = '#let x = 1 $*_ <b>&"\\'


@pytest.fixture(scope="module", autouse=True)
def shared_drawings() -> Iterator[None]:
    """Draw the same solids from the same place once: sheets here differ in their words, kits check their bytes."""
    drawn: dict[bytes, LineDrawing] = {}
    draw = LineDrawing.of_solids

    def draw_once(solids: Sequence[DrawnSolid], camera: Camera, **options: float) -> LineDrawing:
        key = pickle.dumps((solids, camera, options))
        if key not in drawn:
            drawn[key] = draw(solids, camera, **options)  # type: ignore[arg-type]
        return drawn[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(LineDrawing, "of_solids", staticmethod(draw_once))
        yield


def read(content: bytes) -> PdfReader:
    return PdfReader(io.BytesIO(content))


@cache
def sheet_of(make: Callable[[], Given]) -> bytes:
    """The sheet of a robot with nothing changed."""
    return assembly_sheet(*make())


@pytest.fixture
def plush_sheet():
    return sheet_of(plush)


@pytest.fixture
def foam_sheet():
    return sheet_of(foam)


@pytest.mark.parametrize(("make", "pages"), [(plush, 3), (foam, 5)])
@pytest.mark.parametrize(
    ("paper", "size"),
    [(Paper.A4, (595.28, 841.89)), (Paper.LETTER, (612.0, 792.0)), (Paper.A3, (595.28, 841.89))],
)
def test_pages_and_paper(make, pages, paper, size):
    reader = read(assembly_sheet(*make(paper=paper)))
    assert len(reader.pages) == pages
    for page in reader.pages:
        assert (float(page.mediabox.width), float(page.mediabox.height)) == pytest.approx(size, abs=0.01)


@pytest.mark.slow
def test_another_robot_gives_other_bytes(plush_sheet):
    assert assembly_sheet(*plush(cables=3)) != plush_sheet


def test_what_a_plush_sheet_says(plush_sheet):
    text = words(plush_sheet)
    assert "Then calibrate" not in text  # only once it is stuffed
    assert "Close and calibrate" in text
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
    assert "122" in text
    assert "C2" in text
    assert "100 × 100 × 30 mm" in text
    assert "1 winch, 2 cables" in text
    assert "Never cut PVC" in text


@pytest.mark.slow
def test_winches_that_pull_both_ways_are_not_sent_to_a_command_that_refuses_them(plush_sheet):
    """Oracle: `hydrostat calibrate` refuses each robot with a reversed cable."""
    assert "hydrostat calibrate measures" in words(plush_sheet)
    given = plush()
    first, *others = given.plan.robot.cables
    robot = given.plan.robot.with_network(given.plan.robot.winches, [replace(first, reverse=True), *others])
    text = words(assembly_sheet(*given._replace(plan=replace(given.plan, robot=robot))))
    assert "hydrostat calibrate measures" not in text
    assert "its zero in motors.toml" in text


@pytest.mark.slow
def test_a_sheet_tells_which_motor_the_firmware_is_for():
    power = power_plan({plush().plan.robot.winches[0].name: 40.0}, next(one for one in MOTORS if one.key == "n20"))
    assert "firmware ROBOT --board uno --motor n20" in words(assembly_sheet(*plush(lists=lists(2, power=power))))


@pytest.mark.parametrize("key", [motor.key for motor in ALL_MOTORS])
def test_the_first_start_ends_in_commands_that_the_robot_and_its_motors_take(key: str) -> None:
    """Oracle: the kinds of motors of the command line, and its refusal of winches that pull both ways."""
    robot, motor = plush().plan.robot, next(one for one in ALL_MOTORS if one.key == key)
    power = power_plan(dict.fromkeys((winch.name for winch in robot.winches), 40.0), motor)
    kinds = {"xl330": "dynamixel", "xc330": "dynamixel", "scs0009": "scs", "n20": "firmware", "25d": "firmware"}
    kind = kinds.get(key, "feetech")
    first, *others = robot.cables
    both = robot.with_network(robot.winches, [replace(first, reverse=True), *others])
    for one, calibrated in ((robot, True), (both, False)):
        facts = power_facts(power, one)
        assert facts is not None
        steps = " ".join(facts["start"])
        assert (f"hydrostat calibrate ROBOT --motors {kind}:PORT" in steps) == calibrated
        assert steps.count(f"--motors {kind}:PORT") == 1 + calibrated
        assert steps.index("hydrostat trajectory ROBOT --return --out dance") < steps.index("--motors"), "makes MOVES"


@pytest.mark.parametrize(("key", "told"), [("n20", "encoders from its pin 3V3"), ("25d", "the level shifter")])
def test_the_page_of_an_esp32_says_how_it_gets_its_sketch_and_3_3_volts(key: str, told: str) -> None:
    robot, motor = plush().plan.robot, next(one for one in MOTORS if one.key == key)
    facts = power_facts(power_plan({robot.winches[0].name: 40.0}, motor, "esp32s3"), robot)
    assert facts is not None
    assert facts["pins"][0][1:] == ["esp32s3", "15", "16", "39", "40", "1"]
    assert told in facts["warnings"][-1]
    assert ("Leave 10 mm" in " ".join(facts["warnings"])) == (key == "n20"), "its encoder is in no size"
    steps = " ".join(facts["start"])
    assert f"--board esp32s3 --motor {key} --out DIR. " in steps
    assert "winches.ino in the Arduino IDE" in steps
    assert "RESET" not in steps


def test_what_a_foam_sheet_says(foam_sheet):
    text = words(foam_sheet)
    for part in (
        "12.3 % of the surface",
        "6 bolts M4",
        "isocyanate",
        "2 h at 25 °C",
        "glove",
    ):
        assert part in text
    given = foam()
    assert given.plan.work.mould is not None
    assert f"{given.plan.work.mould.casting.body.part_a:.0f} g of part A" in text


@pytest.mark.slow
def test_a_mould_of_silicone_is_poured_round_the_printed_positive(foam_sheet):
    """Oracle: the parts of such a mold: a positive in halves, frames and domes; clay is for the thesis's way."""
    text = words(assembly_sheet(*foam(silicone=True)))
    for part in ("mold max 30, second pour", "Take the domes out", "dowels of 3 mm, no glue", "24 h, or 6 h at 60 °C"):
        assert part in text
    assert "clay" not in text.split("Or from a model")[0].replace("tape or clay", "")
    assert "alginate" in text.split("Or from a model")[1]
    printed = words(foam_sheet)
    assert "--mould silicone" in printed
    assert "alginate" not in printed
    assert all("parts/plate_1.3mf" in sheet for sheet in (text, printed))


@pytest.mark.slow
def test_a_body_of_silicone_is_not_told_of_foam(foam_sheet):
    given = foam()
    assert given.plan.work.mould is not None
    casting, _ = make_casting(MATERIALS["ecoflex 00-30"], 480e3, pours=())
    text = words(assembly_sheet(*foam(mould=replace(given.plan.work.mould, casting=casting))))
    assert "isocyanate" not in text
    assert not re.search(r"\bfoam\b", text, re.IGNORECASE)
    assert "contact adhesive" not in text
    assert "does not hold on silicone" in text
    assert "--mould silicone" not in text  # it does not cure there
    assert "contact adhesive" in words(foam_sheet)
    assert "let the bubbles rise" in text
    assert "4 h at 25 °C" in text
    assert "whisk on a drill as long" in words(foam_sheet)
    assert "whisk" not in text
    assert "Then calibrate" in text


@pytest.mark.slow
def test_motors_in_the_body_need_no_base(foam_sheet):
    given = foam()
    inside = tuple(
        replace(winch, at=cable.points[1], mount=Mount.BODY)
        for winch, cable in zip(given.plan.robot.winches, given.plan.robot.cables, strict=True)
    )
    cables = tuple(replace(cable, points=cable.points[1:], sheathed=()) for cable in given.plan.robot.cables)
    text = words(assembly_sheet(*changed(given, robot=given.plan.robot.with_network(inside, cables))))
    assert "W1 and W2 into their pockets in the foam" in text
    assert "base plate" not in text
    assert "W1 and W2 to the base plate" in words(foam_sheet)


@pytest.mark.parametrize("make", [plush, foam])
def test_names_are_words_not_markup(make):
    assert NASTY in words(assembly_sheet(*make(name=NASTY)))


@pytest.mark.slow
def test_names_in_other_alphabets():
    assert "Übergrößenärmel Жук" in words(assembly_sheet(*plush(name="Übergrößenärmel Жук")))


@pytest.mark.parametrize("name", ["octopus " * 40, "x" * 400])
def test_long_names_are_shortened(name):
    content = assembly_sheet(*plush(name=name))
    assert len(read(content).pages) == 3
    assert shorten_text(name, 60)[:20] in words(content)
    assert shorten_text(name, 60).endswith("…")
    assert len(shorten_text(name, 60)) <= 60


@pytest.mark.parametrize(("make", "pages"), [(plush, 5), (foam, 8)])
@pytest.mark.slow
def test_a_crowded_sheet_has_no_more_pages_but_of_maps(make, pages):
    long = "The spool of winch “pull 1” takes 71 mm of cable, but its travel asks for 740 mm; " * 4
    given = make(
        winches=12,
        cables=24,
        paper=Paper.LETTER,  # the shorter one
        problems=tuple(f"{number}: {long}" for number in range(9)),
        lists=lists(24, 90),
        checks=checks(90, failed=1),
    )
    content = assembly_sheet(*given)
    assert len(read(content).pages) == pages
    text = words(content)
    assert "more in lists/bill_of_materials.csv" in text
    assert "and 2 more in manifest.json" in text
    # What failed stands first, however many there are.
    assert "claim 89" in text


@pytest.mark.slow
def test_warnings_stand_in_a_box_and_problems_say_that_it_was_forced(plush_sheet):
    quiet = words(plush_sheet)
    warned = words(assembly_sheet(*plush(warnings=("mind the cat",))))
    forced = words(assembly_sheet(*plush(problems=("the cat sits on it",))))
    assert "WARNINGS" not in quiet
    assert "Mind the cat." in warned
    assert "cannot be built well" not in warned
    assert "The cat sits on it." in forced
    assert "cannot be built well" in forced


@pytest.mark.slow
def test_nothing_but_the_robot_is_enough():
    given = plush(winch_assembly=None, stopper_assembly=None, printed=(), lists=lists(0, 0), checks=())
    assert len(read(assembly_sheet(*given)).pages) == 3
    given = foam(winch_assembly=None, stopper_assembly=None, printed=(), lists=lists(0, 0), checks=(), mould=None)
    assert len(read(assembly_sheet(*given)).pages) == 5


def item(what: str, quantity: float, price: Price, specification: str = "", **more: bool) -> Item:
    return Item(group=BillGroup.BODY, what=what, specification=specification, quantity=quantity, price=price, **more)


def test_the_bill_is_told_in_short():
    items = (
        item("felt", 0.2, Price(amount=20.0, unit="m^2"), "no PVC"),
        item("screw or nut", 12.0, Price(amount=1 / 12), "M2 x 6 mm screw, self-tapping", is_named_by_kind=True),
        item("filling", 0.05, Price(amount=40.0, unit="kg"), "fibre"),
    )
    text = words(assembly_sheet(*plush(lists=lists(2, items))))
    for part in ("felt 0.2 m² 4", "M2 x 6 mm screw 12 1", "filling 50 g 2", "used up 7", "of work about 7 USD used up"):
        assert part in text
    assert "total" not in text


def test_the_lists_of_what_is_cut_are_told_in_short():
    """Oracle: the rows of the lists, whose place in brackets is left out."""
    text = words(sheet_of(plush))
    assert "cable cut to slack spool mark C1 250 1.5 122 C2 250 1.5 122" in text
    assert "cable from to cut to C1 1 2 23 C2 1 2 23" in text
    assert "Cables, in mm" in words(assembly_sheet(*plush(lists=replace(lists(2), tubes=lists(0).tubes))))


@pytest.mark.slow
def test_all_type_is_large_enough_and_comes_with_typst():
    sizes, fonts = set(), set()

    def note(text, page, matrix, font, size):
        if text.strip():
            sizes.add(round(size * abs(matrix[3] * page[3]), 2))

    for page in read(assembly_sheet(*plush(winches=8, cables=11))).pages:
        page.extract_text(visitor_text=note)
        for font in page["/Resources"]["/Font"].values():
            fonts.add(str(font.get_object()["/BaseFont"]).split("+")[-1])
    assert min(sizes) >= 7.49
    assert {font.split("-")[0] for font in fonts} <= {"LibertinusSerif", "DejaVuSansMono"}


def test_templates_come_with_the_package():
    room = files("hydrostat.fabrication.sheets")
    for name in ("assembly_sheet", "blocks", "overview", "plush_pages", "foam_pages"):
        assert (room / f"{name}.typ").is_file()


def test_the_cost_is_told_used_up_and_in_whole_packs():
    """Oracle: sums by hand: 4 + 0.2 and 10 + 2."""
    items = (item("felt", 1.0, Price(amount=4.0, pack=2.5)), item("thread", 1.0, Price(amount=0.2, pack=10.0)))
    text = words(assembly_sheet(*plush(lists=lists(2, items))))
    for part in ("about 4 USD used up, 12 USD in whole packs", "thread 1 <1", "used up 4", "in whole packs 12"):
        assert part in text


@pytest.mark.slow
def test_a_stopper_is_set_by_the_cloth_not_by_a_mark():
    """Oracle: lists count from the spool's shaft, so that no length from the winch's outside is right."""
    for make, cloth in ((plush, "cloth"), (foam, "skin")):
        text = words(sheet_of(make))
        assert f"until it touches the {cloth} at the cable's last point; then move it back by the listed slack" in text
        assert "stopper mark" not in text
        assert "from exit" not in text


def stitching(*points: tuple[str, float, PointAccess]) -> Table[DepthRow]:
    """A list of points: cable, depth, how."""
    place = dict.fromkeys(("x", "y", "z", "gap", "along", "skin_x", "skin_y", "skin_z"), 0.0)
    rows = (
        DepthRow(cable=cable, winch="pull", point="2", depth=depth, how=how, **place) for cable, depth, how in points
    )
    return Table(name="stitching", title="Where", row=DepthRow, rows=tuple(rows))


@pytest.mark.slow
def test_tubes_for_deep_cables_are_laid_before_casting(foam_sheet):
    """Oracle: the list of stitches."""
    deep = stitching(("C1", 70.0, PointAccess.LAID), ("C2", 2.0, PointAccess.SKIN))
    text = words(assembly_sheet(*foam(lists=lists(2, stitching=deep))))
    assert "C1 runs too deep for a needle" in text
    assert text.index("Lay tubes in the cavity") < text.index("Close it")
    assert "Lay tubes in the cavity" not in words(foam_sheet)


@pytest.mark.slow
def test_cables_are_put_in_as_deep_as_the_list_has_them(foam_sheet):
    """Oracle: a list of one that is sewn on, one that is drawn through, one whose tube is deep."""
    rows = (("C1", 2.0, PointAccess.SKIN), ("C2", 9.0, PointAccess.NEEDLE), ("C3", 9.0, PointAccess.TUBE))
    text = words(assembly_sheet(*foam(cables=3, lists=lists(3, stitching=stitching(*rows)))))
    assert "C2 and C3 before the skin is on" in text
    assert "Push the tube of C3" in text
    assert "C1. Pull the skin over the body" in text
    assert "different lever arm" in text
    assert "Draw cables through" not in words(foam_sheet)


@pytest.mark.slow
def test_names_that_no_font_can_print_are_replaced_with_a_warning(plush_sheet):
    """Oracle: typst itself refuses a page for archives with a letter that no font has."""
    given = plush(name="章鱼 7", warnings=('winch "왼쪽" is near the seam',))
    winch = replace(given.plan.robot.winches[0], name="왼쪽")
    cables = tuple(replace(cable, winch="왼쪽") for cable in given.plan.robot.cables)
    stitches = tuple(replace(sewn, winch="왼쪽") for sewn in given.plan.work.stitches)
    named = changed(given, robot=given.plan.robot.with_network((winch,), cables), stitches=stitches)
    text = words(assembly_sheet(*named))
    assert "?? 7" in text
    assert 'Winch "W1" is near the seam.' in text
    assert "fonts of these pages lack letters" in text
    assert "lack letters" not in words(plush_sheet)


@pytest.mark.parametrize("name", ["Übergröße", "Жук", "Ωμέγα", "שלום", "a–b…", "½ µ"])
def test_letters_that_the_fonts_have_stay(name):
    assert legible(name) == name


@pytest.mark.parametrize(("name", "shown"), [("章鱼", "??"), ("a\U0001f600b", "a?b"), ("왼 x", "? x"), ("a\x00", "a?")])
def test_other_letters_are_question_marks(name, shown):
    assert legible(name) == shown


def test_signs_of_a_printed_page():
    assert (
        typeset("2 h at 25 C, 3 cm^3 and 1e-06, 2.5e-3 or C1, 1e5x")
        == "2 h at 25 °C, 3 cm³ and 10⁻⁶, 2.5 × 10⁻³ or C1, 1e5x"
    )


def test_a_crowd_of_warnings_is_told_in_order():
    """Oracle: three that differ in a place are one; motors stand first, cloth last."""
    bays = tuple(f"the seam is narrow at [{x}, 2] mm: snip" for x in (1, 2, 3))
    told = note_lines((), (*bays, "two housings meet", "the motor grows hot"))
    assert told == [
        "The motor grows hot.",
        "Two housings meet.",
        "The seam is narrow at [1, 2], [2, 2], [3, 2] mm: snip.",
    ]
    assert note_lines(("it falls apart",), ("the motor grows hot",))[0] == "It falls apart."
    assert len(note_lines((), tuple(f"thing {number}" for number in range(20)))) == 8


def test_it_is_told_where_the_robot_is_held():
    """Oracle: the pin of the robot: radius 1 m round the middle."""
    assert "holds the robot around x 0, y 0 mm, up to 1000 mm from there" in words(sheet_of(plush))


def test_winches_on_the_base_and_in_the_body_are_told_apart():
    given = plush(winches=2)
    one, two = given.plan.robot.winches
    robot = given.plan.robot.with_network((one, replace(two, mount=Mount.WORLD)), given.plan.robot.cables)
    text = words(assembly_sheet(*changed(given, robot=robot)))
    assert "Screw W2 to the base plate" in text
    assert "Set W1 where the map shows it" in text


def test_the_steps_state_how_each_unit_lies():
    """Oracle: the placement of each unit, after the mark of its winch; units that lie alike share one."""
    given = plush(winches=2)
    units = winch_units(given.plan.robot, PartOptions(), MOTORS[0])
    (stuffing,) = (
        step.text
        for step in plush_steps(replace(given.plan, rigid=FewParts(units=units)))
        if step.title == "Stuff the body"
    )
    laid = [unit.place.instruction for unit in units if unit.place is not None]
    assert len(laid) == 2
    if laid[0] == laid[1]:
        assert f"seen from the front: W1 and W2 {laid[0]}." in stuffing
    else:
        assert f"seen from the front: W1 {laid[0]}; W2 {laid[1]}." in stuffing


def test_parts_are_told_with_their_files_and_for_which_winches():
    given = plush(winches=2)
    solid = given.plan.printed[0].solid
    spools = [
        Printed(name=f"spool_{letter}", title=f"Spool of {name}", solid=solid, kind="Spool", winches=(name,))
        for letter, name in zip("ab", (winch.name for winch in given.plan.robot.winches), strict=True)
    ]
    text = words(assembly_sheet(*changed(given, printed=tuple(spools))))
    assert "Spool: spool_a, spool_b 2" in text
    assert "W2 pull 2: spool_b" in text


@pytest.mark.slow
def test_a_robot_without_cables_has_no_empty_heading():
    for make in (plush, foam):
        given = make()
        robot = given.plan.robot.with_network((), ())
        text = words(
            assembly_sheet(
                *changed(
                    given,
                    robot=robot,
                    stitches=(),
                    printed=(),
                    winch_assembly=None,
                    stopper_assembly=None,
                    lists=lists(0, 0),
                )
            )
        )
        for heading in ("Where the cables run", "Calibrate", "Log", "A winch", "Winches", "Cut the cables", "Tie"):
            assert heading not in text.replace("all winches", "")


def test_a_flat_robot_of_foam_has_its_map_on_page_four():
    """Oracle: hole numbers of the map, read back from the page."""
    given = plush()
    content = assembly_sheet(*changed(given, method=Method.FOAM, stitches=(), mould=None))
    page = read(content).pages[3].extract_text()
    assert "Where the cables run" in page
    assert "C2" in page.split("Skin and cables")[0]
