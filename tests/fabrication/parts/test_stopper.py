"""The stopper as a thing: it prints, fits, closes on the cable, and is larger than a pinhole."""

import math

import numpy as np
import pytest
from manifold3d import Manifold
from overhang import overhang
from scipy.integrate import solve_ivp

from hydrostat.fabrication.checks.solid_checks import watertight_problems
from hydrostat.fabrication.kit_options import PartOptions, PatternOptions
from hydrostat.fabrication.parts.screws import M2X6
from hydrostat.fabrication.parts.stopper import Stopper, holding_force, screw_stopper
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed, interferences

CABLES = [PartOptions(), PartOptions(cable=0.2, fit=0.1), PartOptions(cable=0.9, bore=1.5, tube=2.5, clearance=0.5)]


def moved_lid(made: Stopper, down: float = 0.0, turned: float = 0.0) -> PartAssembly:
    """The assembly with its lid pressed down [mm] and turned about the screw [degrees]; without the screw."""
    base, lid, _ = made.assembly.pieces
    return PartAssembly(
        name="moved",
        pieces=(base, Placed(name="lid", title="Lid", solid=lid.solid.translate((0, 0, -down)).rotate((0, 0, turned)))),
    )


@pytest.mark.parametrize("options", CABLES)
def test_it_prints_without_support(options: PartOptions):
    """Oracle: triangles that face down."""
    for printed in screw_stopper(options).printed:
        assert watertight_problems(printed) == ()
        assert overhang(printed) < 0.05
        assert max(printed.size) < 13.0


def test_the_measure_of_overhangs_can_fail():
    """Oracle: the lid upside down: its rim would hang in the air."""
    _, lid = screw_stopper(PartOptions()).printed
    solid = lid.solid.rotate((180, 0, 0)).translate((0, 0, lid.size[2]))
    upside_down = type(lid)(name="lid", title="Lid", solid=solid)
    assert overhang(upside_down) > 50


@pytest.mark.parametrize("options", CABLES)
def test_nothing_is_in_the_way_until_the_cable_is_pressed_flat(options: PartOptions):
    """Oracle: boolean intersections of the pieces with the lid moved: what stops it is a rib on the floor."""
    made = screw_stopper(options)
    assert interferences(made.assembly) == ()
    assert interferences(moved_lid(made, down=0.24 * options.cable)) == ()
    assert interferences(moved_lid(made, down=0.55 * options.cable)) != ()


@pytest.mark.parametrize("turned", [8, 90, 180, 352])
def test_the_lid_does_not_turn_with_the_screw(turned: float):
    assert interferences(moved_lid(screw_stopper(PartOptions()), turned=turned)) != ()


@pytest.mark.parametrize("options", CABLES)
def test_the_screw_holds_and_does_not_come_out_at_the_cloth(options: PartOptions):
    """Oracle: heights in the assembly: three millimeters of thread, and plastic under the point pressed down."""
    base, lid, screw = (piece.solid for piece in screw_stopper(options).assembly.pieces)
    point, head = screw.bounding_box()[2], screw.bounding_box()[5]
    assert base.bounding_box()[5] - point >= 3.0
    assert head == pytest.approx(lid.bounding_box()[5])
    assert (base ^ Manifold.cylinder(0.8, 2)).volume() == pytest.approx(Manifold.cylinder(0.8, 2).volume(), rel=0.1)
    assert point - options.cable / 2 > 0.8
    assert M2X6.pilot < 2.0 < M2X6.passage


@pytest.mark.parametrize("options", CABLES)
def test_a_cable_comes_up_goes_round_and_leaves(options: PartOptions):
    """Oracle: bars as wide as the cable, moved through the pieces on the way of R13 that the docstring tells."""
    made = screw_stopper(options)
    base, lid, _ = (piece.solid for piece in made.assembly.pieces)
    x = 2.4 + (options.cable + 0.8) / 2
    up = Manifold.cylinder(30, options.cable / 2).translate((x, 0, -10))
    assert (base ^ up).volume() == 0
    side = Manifold.cube((20, options.cable, 30)).translate((x, -options.cable / 2, -10))
    assert (base ^ side).volume() == 0
    floor = lid.bounding_box()[2] - options.cable / 2
    leaves = Manifold.cube((20, options.cable, 0.3)).translate((2.7, -options.cable / 2, floor + 0.05))
    assert (base ^ leaves.rotate((0, 0, 300))).volume() == 0
    assert (base ^ leaves.rotate((0, 0, 250))).volume() > 0.1


@pytest.mark.parametrize("options", CABLES)
def test_it_is_larger_than_a_pinhole_round_the_cable(options: PartOptions):
    """Oracle: a disc of twice the pinhole's width about the cable lies on the base, but for hole and slot."""
    base = screw_stopper(options).assembly.pieces[0].solid
    x = 2.4 + (options.cable + 0.8) / 2
    pinhole = PatternOptions().pinhole
    outline = base.slice(1.0).hull()
    corners = np.concatenate(outline.to_polygons())
    assert np.linalg.norm(corners - (x, 0), axis=1).min() >= pinhole / 2 + 1.5
    assert options.cable + 0.4 < pinhole


@pytest.mark.parametrize("friction", [0.05, 0.1, 0.3])
def test_what_it_holds(friction: float):
    """Oracle: the balance of a piece of cable, integrated by scipy from the loose end; then the quarter turn."""
    preload, wrap = 50.0, math.radians(300)

    def slope(_: float, tension: np.ndarray) -> np.ndarray:
        return 2 * friction * preload / wrap + friction * tension

    end = solve_ivp(slope, (0, wrap), [0.0], rtol=1e-10, atol=1e-12).y[0, -1]
    hole = solve_ivp(lambda _, tension: friction * tension, (0, math.pi / 2), [end], rtol=1e-10).y[0, -1]
    assert holding_force(preload, friction, wrap=wrap) == pytest.approx(hole, rel=1e-6)


def test_what_is_told_of_it():
    made = screw_stopper(PartOptions())
    assert made.hold == holding_force()
    assert 10 < made.hold < 20
    assert made.screw.startswith("M2 x 6 mm")
    assert [printed.name for printed in made.printed] == ["stopper_base", "stopper_lid"]
    assert all(piece.name for piece in made.assembly.pieces)
