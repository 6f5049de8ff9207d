"""Patterns as other people's programs see them."""

import io
import re
from dataclasses import replace
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest
from plush_robots import SQUARE, crossed, drawn_body, plush_robot
from read_back import Seen, see_dxf, see_svg

from hydrostat.fabrication import plush_pattern
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import PatternPart
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.robot import Robot

READERS = [(pattern_svg, see_svg), (pattern_dxf, see_dxf)]


def worst_hole(seen: Seen, robot: Robot, pattern: Pattern) -> float:
    """Largest distance from a cable point to the nearest hole, and back [mm]."""
    front = pattern.panel("front")
    wanted = np.array([front.on_sheet(point) for cable in robot.cables for point in cable.points])
    distances = np.linalg.norm(wanted[:, None] - seen.circles["PINHOLE"][None, :, :2], axis=2)
    return max(distances.min(axis=0).max(), distances.min(axis=1).max())


@pytest.mark.parametrize(("write", "see"), READERS)
def test_pinholes_are_where_cables_are_at_true_scale(write, see):
    """Oracle: svgelements and ezdxf, which know nothing of us; 0.1 mm (R10)."""
    robot = crossed()
    pattern = plush_pattern(robot)
    seen = see(write(pattern))
    assert worst_hole(seen, robot, pattern) < 0.1
    np.testing.assert_allclose(seen.circles["PINHOLE"][:, 2], 1.0, rtol=1e-5)


@pytest.mark.parametrize(("write", "see"), READERS)
def test_the_check_of_the_scale_can_fail(write, see):
    """Oracle: a pattern whose holes are 0.2 mm off."""
    robot = crossed()
    pattern = plush_pattern(robot)
    front = pattern.panel("front")
    off = tuple(shape.move(0.2, 0.0) if shape.part is PatternPart.PINHOLE else shape for shape in front.shapes)
    wrong = replace(pattern, panels=(replace(front, shapes=off), pattern.panel("back")))
    assert worst_hole(see(write(wrong)), robot, pattern) > 0.1


@pytest.mark.parametrize(("write", "see"), READERS)
def test_the_cut_is_seen_at_true_scale(write, see):
    """Oracle: a square of 100 mm under an allowance of 8 mm is 116 mm wide and high, y up."""
    pattern = plush_pattern(crossed())
    seen = see(write(pattern))
    edges = [line for line, closed in zip(seen.lines["CUT"], seen.closed["CUT"], strict=True) if closed]
    for panel, line in zip(pattern.panels, edges, strict=True):
        np.testing.assert_allclose(np.ptp(line, axis=0), 116, atol=0.01)
        np.testing.assert_allclose(line.min(axis=0), np.subtract(panel.origin, 58), atol=0.01)
    assert seen.closed["CUT"].count(False) == 1  # the slit of the opening


def test_both_files_show_the_same():
    """Oracle: each other."""
    pattern = plush_pattern(crossed())
    svg, dxf = see_svg(pattern_svg(pattern)), see_dxf(pattern_dxf(pattern))
    for layer in ("MARK", "GUIDE", "PINHOLE", "CUT"):
        assert len(svg.lines[layer]) == len(dxf.lines[layer])
        assert len(svg.circles[layer]) == len(dxf.circles[layer])
        assert svg.lines[layer] or len(svg.circles[layer])
        for ours, theirs in zip(svg.lines[layer], dxf.lines[layer], strict=True):
            np.testing.assert_allclose(ours, theirs, atol=0.002)


def test_svg_has_layers_for_inkscape_and_a_size_in_millimeters():
    """Oracle: an XML parser; the viewBox is the size."""
    pattern = plush_pattern(crossed())
    page = ElementTree.fromstring(pattern_svg(pattern))
    inkscape = "{http://www.inkscape.org/namespaces/inkscape}"
    layers = [group for group in page if group.get(f"{inkscape}groupmode") == "layer"]
    assert [group.get(f"{inkscape}label") for group in layers] == ["MARK", "GUIDE", "PINHOLE", "CUT"]
    assert [group.get("stroke") for group in layers] == ["#000000", "#008000", "#0000ff", "#ff0000"]
    width, height = page.get("width"), page.get("height")
    assert f"0 0 {width} {height}".replace("mm", "") == page.get("viewBox")
    assert not page.findall(".//{http://www.w3.org/2000/svg}text")


def test_dxf_is_clean():
    """Oracle: ezdxf's audit, and the header's code for millimeters."""
    document = ezdxf.read(io.StringIO(pattern_dxf(plush_pattern(crossed())).decode()))
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    assert document.header["$INSUNITS"] == 4
    assert document.dxfversion == "AC1024"
    assert {entity.dxftype() for entity in document.modelspace()} == {"LWPOLYLINE", "CIRCLE"}


@pytest.mark.parametrize("write", [pattern_svg, pattern_dxf])
def test_bytes_are_the_same_on_every_run(write):
    """Oracle: a second pattern of a second robot made the same way; the clock goes on between."""
    assert write(plush_pattern(crossed())) == write(plush_pattern(crossed()))


def test_the_dxf_writer_leaves_ezdxf_as_it_was():
    """Oracle: its option, before and after."""
    before = ezdxf.options.write_fixed_meta_data_for_testing
    pattern_dxf(plush_pattern(crossed()))
    assert ezdxf.options.write_fixed_meta_data_for_testing == before


@pytest.mark.parametrize("name", ['<b>&"Sam\'s"</b>', "Zoë 海星 \x0b", "]]>", "a\nb"])
def test_any_name_makes_whole_files(name):
    """Oracle: an XML parser and ezdxf."""
    pattern = plush_pattern(plush_robot(drawn_body(SQUARE), [(0, 0), (20, 10)], name=name))
    page = ElementTree.fromstring(pattern_svg(pattern))
    assert page.findtext("{http://www.w3.org/2000/svg}title") == name.replace("\x0b", "")
    assert not ezdxf.read(io.StringIO(pattern_dxf(pattern).decode())).audit().errors


def test_numbers_are_short():
    """Oracle: a pattern for numbers: at most three decimals, no exponent, no minus zero."""
    text = pattern_svg(plush_pattern(crossed())).decode()
    paths = " ".join(re.findall(r' (?:d|cx|cy|r)="([^"]*)"', text))
    assert not re.search(r"\d\.\d{4}|e|-0[^.]|nan", paths)
