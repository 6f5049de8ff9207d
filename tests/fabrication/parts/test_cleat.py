"""The winding cleat: it prints, lets the line in, holds it, and is larger than a pinhole."""

import math

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from overhang import overhang
from scipy.integrate import solve_ivp

from hydrostat.fabrication.checks.solid_checks import watertight_problems
from hydrostat.fabrication.kit_options import PartOptions, PatternOptions
from hydrostat.fabrication.parts.cleat import FRICTION, PINCH, TURNS, cleat, find_wound_length, holding_force

CABLES = [PartOptions(), PartOptions(cable=0.2, fit=0.1), PartOptions(cable=0.9, bore=1.5, tube=2.5, clearance=0.5)]
WAIST = 2.6  # radius [mm]


def solid_of_cleat(options: PartOptions) -> Manifold:
    (piece,) = cleat(options).assembly.pieces
    return piece.solid


@pytest.mark.parametrize("options", CABLES)
def test_it_prints_without_support_and_upside_down_it_would_not(options: PartOptions):
    """Oracle: triangles that face down."""
    (printed,) = cleat(options).printed
    assert watertight_problems(printed) == ()
    assert overhang(printed) < 0.05
    assert max(printed.size) < 13.1
    turned = printed.solid.rotate((180, 0, 0)).translate((0, 0, printed.size[2]))
    assert overhang(type(printed)(name="turned", title="Turned", solid=turned)) > 50


@pytest.mark.parametrize("options", CABLES)
def test_a_line_comes_up_and_is_laid_in_sideways(options: PartOptions):
    """Oracle: bars as wide as the line, moved through the foot."""
    solid, x = solid_of_cleat(options), WAIST + (options.cable + 0.8) / 2
    foot = solid ^ Manifold.cube((30, 30, 1.6), center=False).translate((-15, -15, 0))
    assert (foot ^ Manifold.cylinder(30, options.cable / 2).translate((x, 0, -10))).volume() == 0
    assert (foot ^ Manifold.cube((20, options.cable, 30)).translate((x, -options.cable / 2, -10))).volume() == 0
    beside = Manifold.cube((20, options.cable, 30)).translate((x, options.cable, -10))
    assert (foot ^ beside).volume() > 0.1


@pytest.mark.parametrize("options", CABLES)
def test_all_turns_have_room_inside_the_rim(options: PartOptions):
    """Oracle: rings as thick as the line, in layers from the waist outward, meet neither foot, head nor rim."""
    solid, cable = solid_of_cleat(options), options.cable
    neck = 1.6 + max(0.6, 1.5 * cable)
    wound, radius, left = 0.0, WAIST + cable / 2, TURNS
    while left:
        turns = min(left, int((neck - 1.6 + radius - WAIST) / cable))
        for turn in range(turns):
            middle = 1.6 + cable * (turn + 0.5)
            corners = ((radius - 0.5 * cable + 0.01, 0.01), (radius + 0.49 * cable, 0.01), (radius, cable - 0.02))
            ring = Manifold.revolve(CrossSection([corners])).translate((0, 0, middle - cable / 2))
            assert (solid ^ ring).volume() < 0.02 * ring.volume()
            wound += 2 * math.pi * radius
        left, radius = left - turns, radius + cable
    assert radius - cable / 2 < 6.5
    assert find_wound_length(cable) == pytest.approx(wound)
    assert cleat(options).tail >= wound + 40
    assert solid.bounding_box()[5] < 7.8


@pytest.mark.parametrize("options", CABLES)
def test_a_notch_takes_the_line_and_jams_it(options: PartOptions):
    """Oracle: a bar as wide as the line and the play of a print passes at the rim, half a line not at the end."""
    solid = solid_of_cleat(options).rotate((0, 0, -45))
    head = solid.bounding_box()[5] - 0.4
    at_rim = Manifold.cube((0.2, options.cable + 2 * options.fit, 0.2), center=True).translate((6.4, 0, head))
    inside = Manifold.cube((0.4, options.cable / 2, 0.2), center=True).translate((3.2, 0, head))
    assert (solid ^ at_rim).volume() == 0
    assert (solid ^ inside).volume() > 0.3 * inside.volume()


@pytest.mark.parametrize("options", CABLES)
def test_it_is_larger_than_a_pinhole_round_the_cable(options: PartOptions):
    """Oracle: a disc of the pinhole and 1.5 mm of cloth round it lies under the foot, at the cloth."""
    x = WAIST + (options.cable + 0.8) / 2
    corners = np.concatenate(solid_of_cleat(options).slice(0.01).hull().to_polygons())
    assert np.linalg.norm(corners - (x, 0), axis=1).min() >= PatternOptions().pinhole / 2 + 1.5
    assert options.cable + 0.4 < PatternOptions().pinhole


@pytest.mark.parametrize("friction", [0.05, 0.1, 0.2])
def test_holding_force(friction: float):
    """Oracle: dT = mu T dphi, integrated by scipy from the notch to the hole."""
    angle = 2 * math.pi * TURNS + math.pi / 2
    end = solve_ivp(lambda _, pull: friction * pull, (0, angle), [0.5], rtol=1e-10, atol=1e-12).y[0, -1]
    assert holding_force(0.5, friction) == pytest.approx(end, rel=1e-6)


def test_what_is_told_of_it():
    made = cleat(PartOptions())
    assert made.hold == holding_force(PINCH, FRICTION, turns=TURNS)
    assert made.screw is None
    assert f"{TURNS} times" in made.fix
    assert made.fix in made.reset
