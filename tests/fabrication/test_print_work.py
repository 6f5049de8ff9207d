"""Bodies that are printed in one piece, with holes for cables."""

import io
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from builders import gallery_robot

from hydrostat.fabrication import KitOptions, Method, build_kit, find_refusals
from hydrostat.fabrication.print_work import DRILL_OVERSHOOT, drill, hole_of, print_work
from hydrostat.fabrication.solids.body_solid import body_solid
from hydrostat.robot import Mount, get_material


@pytest.fixture(scope="module")
def spiral():
    return gallery_robot("spiral")


def test_a_hole_is_as_large_as_its_capsule():
    """Oracle: volume of a straight capsule, pi r^2 l + 4/3 pi r^3; the polygon of its circle takes up to 4 % off."""
    robot = gallery_robot("spiral")
    cable = replace(robot.cables[0], points=((0.0, 0.0), (0.03, 0.0), (0.05, 0.0)), sheathed=())
    radius, length = 0.7, 50 + 2 * DRILL_OVERSHOOT
    exact = np.pi * radius**2 * length + 4 / 3 * np.pi * radius**3
    assert 0.96 < drill(cable, 2 * radius).volume() / exact < 1


def test_the_spiral_is_printed_with_open_holes(spiral):
    """Oracle: trimesh finds the STL watertight, its volume that of the drawing without its holes; checks can fail."""
    kit = build_kit(spiral)
    assert kit.method is Method.PRINT
    assert [check.what for check in kit.checks if not check.passed] == []
    body = trimesh.load_mesh(io.BytesIO(kit.files["body/body.stl"]), file_type="stl")
    assert body.is_watertight
    assert body.body_count == 1
    whole = body_solid(spiral.body)
    holes = sum((drill(cable, hole_of(KitOptions().parts)) ^ whole).volume() for cable in spiral.cables)
    assert holes > 100
    assert body.volume == pytest.approx(whole.volume() - holes, rel=1e-4)
    assert kit.files["assembly_sheet.pdf"].startswith(b"%PDF")


def test_holes_that_are_closed_fail(spiral, monkeypatch):
    """Oracle: a body that is not drilled."""
    monkeypatch.setattr("hydrostat.fabrication.print_work.hole_of", lambda parts: 1e-3)
    work = print_work(spiral, KitOptions())
    assert [check.passed for check in work.checks] == [True]
    monkeypatch.setattr("hydrostat.fabrication.print_work.drill", lambda cable, diameter: drill(cable, 2.0 - diameter))
    assert [check.passed for check in print_work(spiral, KitOptions()).checks] == [False]


def test_what_cannot_be_printed(spiral):
    """Oracle: a winch in the body, and a body thinner than its holes, by hand: 1.4 mm and two walls of 1.6 mm."""
    place = (-0.08, 0.0)
    winches = tuple(replace(winch, mount=Mount.BODY, at=place) for winch in spiral.winches)
    cables = tuple(replace(cable, points=(place, *cable.points[1:])) for cable in spiral.cables)
    inside = replace(spiral, winches=winches, cables=cables)
    assert 'winch left: a printed body has no room for it. Set mount = "world"' in find_refusals(inside)
    thin = replace(spiral, body=replace(spiral.body, thickness=4e-3))
    assert "the body is 4 mm thick, but holes need 4.6 mm. Thicken it" in find_refusals(thin)


@pytest.mark.parametrize(
    ("material", "method"),
    [("tpu 85a", "print"), ("dragon skin 30", "foam"), ("polyester fibre", "plush"), ("pdms", "plush")],
)
def test_method_of_a_flat_body(spiral, material, method):
    """Oracle: the table of docs/fabrication.md."""
    assert KitOptions().method_for(replace(spiral.body, material=get_material(material))) == method
