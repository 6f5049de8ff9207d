"""The kit as a whole: the same bytes, true to its robot, readable by other programs, refused with reasons."""

import hashlib
import io
import json
from dataclasses import replace
from importlib.util import find_spec

import ezdxf
import pypdf
import pytest
import trimesh
from page_words import read_words
from plush_robots import crossed, drawn_body, plush_robot

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.fabrication import (
    ALL_MOTORS,
    Kit,
    KitOptions,
    Method,
    MoldKind,
    MoldOptions,
    Paper,
    PatternOptions,
    UnbuildableError,
    build_kit,
    drive_price,
    find_material_problems,
    find_motor,
    write_kit,
)
from hydrostat.fabrication.sheets.legible import typeset
from hydrostat.robot import MATERIALS, Material, gallery_folder, robot_hash

TOO_NEAR = [(-20, -10), (5, 12), (49.5, 22)]
"""A route [mm] whose last hole would be half a millimeter from the seam of the square."""


@pytest.fixture(params=["plush_kit", "foam_kit"])
def kit(request: pytest.FixtureRequest) -> Kit:
    return request.getfixturevalue(request.param)


@pytest.mark.slow
def test_a_kit_is_the_same_bytes_on_every_run(foam_kit):
    """Oracle: a second kit of the robot read again; for plush see tests/studio/exporting/test_exporter.py."""
    again = build_kit(hs.load_robot(gallery_folder(foam_kit.robot.name)))
    assert list(again.files) == list(foam_kit.files)
    assert [path for path in foam_kit.files if foam_kit.files[path] != again.files[path]] == []


def test_the_manifest_tells_what_is_there(kit):
    """Oracle: hashlib, and the robot's own hash."""
    told = json.loads(kit.files["manifest.json"])
    assert told["robot"] == {"name": kit.robot.name, "sha256": robot_hash(kit.robot)}
    assert told["versions"]["hydrostat"] == hs.__version__
    assert sorted([*told["files"], "manifest.json"]) == sorted(kit.files)
    for path, facts in told["files"].items():
        content = kit.files[path]
        assert facts == {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}


def test_a_kit_is_true_to_its_robot(kit):
    """Oracle: each check measures the finished files; tests of its own show that it can fail."""
    assert [check.what for check in kit.checks if not check.passed] == []
    assert len(kit.checks) >= 5


def test_every_part_is_a_file_that_another_program_finds_whole(kit):
    """Oracle: trimesh, on every STL."""
    solids = {path: content for path, content in kit.files.items() if path.endswith(".stl")}
    assert {f"parts/{part.name}.stl" for part in kit.printed} | {f"mould/{part.name}.stl" for part in kit.printed} >= {
        path for path in solids if not path.startswith("positive/")
    }
    assert len(solids) >= len(kit.printed)
    for path, content in solids.items():
        mesh = trimesh.load_mesh(io.BytesIO(content), file_type="stl")
        assert mesh.is_watertight, path
        assert mesh.volume > 0, path


def test_the_sheet_has_five_pages_for_plush_and_six_for_foam(kit):
    """Oracle: pypdf, and the size of A4."""
    pages = pypdf.PdfReader(io.BytesIO(kit.files["assembly_sheet.pdf"])).pages
    assert len(pages) == (5 if kit.method is Method.PLUSH else 6)
    for page in pages:
        assert [float(side) * 25.4 / 72 for side in page.mediabox[2:]] == pytest.approx([210, 297], abs=0.1)


def test_every_check_stands_on_the_sheet(kit):
    """Oracle: pypdf's text of the pages."""
    words = read_words(kit.files["assembly_sheet.pdf"]).replace(" ", "")
    for check in kit.checks:
        assert typeset(check.measured).replace(" ", "")[:40] in words, check.what


def test_a_robot_that_cannot_be_built_is_refused_with_all_reasons(tmp_path):
    """Oracle: two holes too near the seam; nothing is written."""
    robot = plush_robot(drawn_body("M0 0H100V100H0Z"), TOO_NEAR, [(-20, -10), (-49.5, 20)])
    with pytest.raises(UnbuildableError, match=r"2 problems prevent fabrication") as refused:
        write_kit(robot, tmp_path / "kit")
    assert ["cable[0].points[2]" in refused.value.reasons[0], "cable[1].points[1]" in refused.value.reasons[1]] == [
        True
    ] * 2
    assert not (tmp_path / "kit").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("density", "method", "reason"),
    [(30.0, "foam", "(30 kg/m^3) is not cast from two parts"), (30.0, "plush", ""), (160.0, "plush", "no stuffing")],
)
def test_a_material_that_no_kit_takes_is_refused_before_any_pose_is_solved(density, method, reason):
    """Oracle: the stages that were begun; the refusal of a whole kit above is the same sentence."""
    stages, material = [], Material(young=3e4, poisson=0.3, density=density)
    robot = crossed()
    robot = replace(robot, body=replace(robot.body, material=material if density < 100 else MATERIALS["flexfoam-it x"]))
    options = KitOptions(method=Method(method))
    found = find_material_problems(robot, options=options)
    assert [reason in text for text in found] == [True] * bool(reason)
    if reason:
        with pytest.raises(UnbuildableError) as refused:
            build_kit(robot, options=options, progress=lambda stage, *_: stages.append(stage))
        assert (refused.value.reasons[:1], stages) == (found, [])


def test_by_force_it_is_built_with_the_reasons_on_the_sheet():
    """Oracle: pypdf's text of the first page."""
    robot = plush_robot(drawn_body("M0 0H100V100H0Z"), TOO_NEAR)
    kit = build_kit(robot, options=KitOptions(force=True))
    assert len(kit.problems) == 1
    assert "cable 1, point 3" in read_words(kit.files["assembly_sheet.pdf"]).lower()


def test_a_spool_too_small_for_the_shaft_is_refused():
    """Oracle: a drum of 1 mm on a shaft of 3 mm."""
    robot = crossed()
    thin = replace(robot, winches=(replace(robot.winches[0], spool_radius=0.001),))
    with pytest.raises(UnbuildableError, match=r'winch "pull": spool radius 1\.00 mm'):
        build_kit(thin)


@pytest.mark.slow
def test_letter_paper_and_stages():
    """Oracle: pypdf, and 8.5 x 11 inch; the last stage ends; the price of a motor that designs print is the kit's."""
    told = []
    options = KitOptions(paper=Paper.LETTER)
    kit = build_kit(crossed(), options=options, progress=lambda stage, done, total: told.append((stage, done, total)))
    motor = next(each for each in ALL_MOTORS if each.key == kit.motor)
    price = drive_price(crossed(), kit.torques, motor, options=options)
    assert f" USD, {price:.0f} USD of them for 1 motor, power and cables; to buy" in kit.summary[-1]
    assert len({stage for stage, _, _ in told}) >= 5
    assert told[-1][1] == told[-1][2]
    for path in ("assembly_sheet.pdf", "pattern/pattern_letter.pdf"):
        page = pypdf.PdfReader(io.BytesIO(kit.files[path])).pages[0]
        assert [float(side) for side in page.mediabox[2:]] == pytest.approx([612, 792], abs=0.5)


def test_an_unknown_motor_is_refused():
    with pytest.raises(InputError, match="n20, "):
        build_kit(crossed(), options=KitOptions(motor="v8"))
    with pytest.raises(InputError, match='unknown motor "v9"'):
        build_kit(replace(crossed(), motor="v9"))


def test_a_written_kit_has_the_motor_of_its_robot(tmp_path):
    """Oracle: the key that robot.toml names; options come first."""
    robot = replace(crossed(), motor="xl330")
    kit = write_kit(robot, tmp_path, options=KitOptions(force=True))
    assert (kit.motor, find_motor(robot, (), KitOptions(motor="n20")).key) == ("xl330", "n20")
    assert json.loads((tmp_path / "manifest.json").read_text())["motor"] == "xl330"


@pytest.mark.parametrize(
    ("made", "name", "word"),
    [
        (KitOptions, "method", "knit"),
        (KitOptions, "paper", "a5"),
        (MoldOptions, "kind", "plaster"),
        (PatternOptions, "corner", "cut"),
    ],
)
def test_a_word_that_is_no_choice_is_refused_with_those_that_are(unchecked, made, name, word):
    """Oracle: the enumeration of each."""
    with pytest.raises(InputError, match=f'{name} must be one of [a-z0-9, ]+, not "{word}"'):
        made(**{name: word})


def test_a_choice_may_be_given_as_text(unchecked):
    """Oracle: the same options with members of the enumerations; a text alone is no member."""
    given = KitOptions(method="foam", paper="letter", mould=MoldOptions(kind="silicone"))
    assert given.method is Method.FOAM
    assert given == KitOptions(method=Method.FOAM, paper=Paper.LETTER, mould=MoldOptions(kind=MoldKind.SILICONE))


@pytest.mark.slow
def test_a_stuffed_body_in_space_is_sewn_of_patches():
    """Oracle: the checks on its pattern, and ezdxf's audit of the drawing."""
    kit = build_kit(hs.load_robot(gallery_folder("bear")))
    assert kit.method is Method.PLUSH
    assert [check.what for check in kit.checks if not check.passed] == []
    assert any("skin" in check.what for check in kit.checks)
    assert not ezdxf.read(io.StringIO(kit.files["pattern/pattern.dxf"].decode())).audit().errors
    assert len(pypdf.PdfReader(io.BytesIO(kit.files["assembly_sheet.pdf"])).pages) == 5


@pytest.mark.slow
def test_a_body_of_foam_is_not_stuffed_unless_forced():
    """Oracle: the square is simulated as a castable foam."""
    robot = replace(crossed(), body=replace(crossed().body, material=MATERIALS["flexfoam-it x"]))
    with pytest.raises(UnbuildableError, match='simulated as "flexfoam-it x", which is no stuffing for cloth'):
        build_kit(robot, options=KitOptions(method=Method.PLUSH))


@pytest.mark.slow
def test_a_flat_body_can_be_cast():
    """Oracle: the volume of its mold's cavity is its area times its thickness."""
    body = replace(crossed().body, material=MATERIALS["flexfoam-it x"])
    kit = build_kit(replace(crossed(), body=body, cables=()), options=KitOptions(method=Method.FOAM))
    assert [check.what for check in kit.checks if not check.passed] == []
    halves = [content for path, content in kit.files.items() if path.startswith("positive/") and path.endswith(".stl")]
    volumes = [trimesh.load_mesh(io.BytesIO(half), file_type="stl").volume for half in halves]
    assert sum(volumes) == pytest.approx(100 * 100 * 30, rel=0.02)


@pytest.mark.skipif(find_spec("build123d") is not None, reason="the extra cad is there")
def test_step_without_its_extra_says_what_to_install():
    with pytest.raises(InputError, match=r"\[cad\]"):
        build_kit(crossed(), options=KitOptions(step=True))


def test_a_robot_without_cables_still_has_a_body():
    """Oracle: its pattern, and no winch."""
    kit = build_kit(replace(crossed(), cables=()))
    assert "pattern/pattern.svg" in kit.files
    assert not any("spool" in part.name for part in kit.printed)
