"""The base for winches outside the body: units fit and do not touch, tubes run straight, plate and outline agree."""

import math
from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest
from builders import gallery_robot, gallery_texts
from manifold3d import Manifold
from overhang import overhang
from shapely.geometry import Polygon

from hydrostat.fabrication.checks.solid_checks import watertight_problems
from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.base_plan import HOLDER_DEPTH, HOLDER_GAP, holder_at, tube_holder
from hydrostat.fabrication.parts.base_plate import BasePlate, base_plate
from hydrostat.fabrication.parts.motor import MOTORS, Motor
from hydrostat.fabrication.parts.winch_unit import WinchUnit, winch_units
from hydrostat.fabrication.solids.assembly import interferences
from hydrostat.fabrication.solids.construct import solid_of
from hydrostat.fabrication.solids.printed import Printed

BED = (220.0, 220.0, 250.0)
OUTSIDE_ALL = [name for name, text in gallery_texts().items() if text.get("winch", [{}])[0].get("mount") == "world"]
OUTSIDE = ["caging_gripper", "cupping_hand", "fish_tail", "octopus_arm", "tongue", "trunk"]


@cache
def base_of(
    name: str, motor: Motor = MOTORS[0], bed: tuple[float, float, float] = BED
) -> tuple[BasePlate, tuple[WinchUnit, ...]]:
    robot = gallery_robot(name)
    units = winch_units(robot, PartOptions(), motor)
    base = base_plate(robot, units, PartOptions(), bed)
    assert base is not None
    return base, units


def tiles(base: BasePlate) -> list[Manifold]:
    return [part.solid for part in base.printed if part.title == "Base"]


@pytest.mark.parametrize(
    ("name", "motor"), [*((name, MOTORS[0]) for name in OUTSIDE), *(("trunk", motor) for motor in MOTORS[1:])]
)
@pytest.mark.slow
def test_everything_fits_on_the_base(name: str, motor: Motor, unchecked: None):
    """Oracle: boolean intersections of all pieces; boxes round the units."""
    base, units = base_of(name, motor)
    assert base.problems == ()
    assert len(base.seats) == len(units)
    assert interferences(base.assembly) == ()
    boxes = [
        seat.place_solid(Manifold.cube(units[seat.unit].room.size).translate(units[seat.unit].room.low))
        for seat in base.seats
    ]
    assert all(one.min_gap(other, 5.0) >= 2.9 for one, other in combinations(boxes, 2))
    for part in base.printed:
        assert watertight_problems(part) == ()


@pytest.mark.slow
def test_a_motor_beside_its_hole_is_found():
    """The check can fail: a motor pushed by half a millimeter against the base."""
    base, _ = base_of("fish_tail")
    pieces = base.assembly.pieces
    motor = next(piece for piece in pieces if piece.name.startswith("motor_n20"))
    plate = next(piece for piece in pieces if piece.name == "base")
    assert (plate.solid ^ motor.solid).volume() == 0.0
    assert (plate.solid ^ motor.solid.translate((0.5, 0, 0))).volume() > 1.0


def test_a_base_only_for_winches_outside():
    robot = gallery_robot("starfish")
    units = winch_units(robot, PartOptions(), MOTORS[0])
    assert base_plate(robot, units, PartOptions(), BED) is None


@pytest.mark.parametrize("bed", [BED, (120.0, 120.0, 100.0), (90.0, 60.0, 100.0)])
@pytest.mark.parametrize("name", ["cupping_hand", "tongue"])
@pytest.mark.slow
def test_tiles_fit_the_bed_and_together_are_the_sheet(name: str, bed: tuple[float, float, float]):
    """Oracle: area of the outline less its holes, by shapely; volume of the tiles."""
    base, _ = base_of(name, bed=bed)
    assert base.problems == ()
    for part in base.printed:
        assert all(side <= room for side, room in zip(part.size, bed, strict=True))
    outline, *holes = (Polygon(ring) for ring in base.sheet)
    assert all(outline.contains(hole) for hole in holes)
    assert all(one.disjoint(other) for one, other in combinations(holes, 2))
    area = outline.area - sum(hole.area for hole in holes)
    assert sum(solid.volume() for solid in tiles(base)) == pytest.approx(base.thickness * area, rel=1e-6)
    assert next(part.count for part in base.printed if part.name == "base_leg") == 4 * len(tiles(base))


@pytest.mark.slow
def test_the_smaller_the_bed_the_more_tiles():
    counts = [
        len(tiles(base_of("cupping_hand", bed=bed)[0])) for bed in (BED, (120.0, 120.0, 100.0), (90.0, 60.0, 100.0))
    ]
    assert counts[0] == 2  # ten winches
    assert counts == sorted(set(counts))


@pytest.mark.slow
def test_a_bed_too_small_for_one_unit_is_a_problem():
    base, _ = base_of("tongue", bed=(40.0, 40.0, 100.0))
    assert any("the bed 40 x 40 x 100 mm" in text for text in base.problems)


@pytest.mark.parametrize("motor", MOTORS, ids=lambda motor: motor.key)
@pytest.mark.slow
def test_a_straight_tube_runs_from_its_seat_through_its_holder(motor: Motor):
    """Oracle: a straight tube from the exit on, a hair thinner than it is, cuts nothing; beside its bore it does."""
    base, units = base_of("trunk", motor)
    holders = [piece.solid for piece in base.assembly.pieces if piece.name.startswith("tube_holder")]
    others = [piece.solid for piece in base.assembly.pieces if not piece.name.startswith("tube_holder")]
    for seat, holder in zip(base.seats, holders, strict=True):
        (leaves,) = units[seat.unit].exits
        length = HOLDER_GAP + HOLDER_DEPTH
        assert dict(base.tubes)[leaves.cable] > length
        tube = Manifold.cylinder(length, 0.97, -1, 24).rotate((-90, 0, 0)).translate(leaves.point)
        placed = seat.place_solid(tube.translate((0, 0.01, 0)))
        assert all((placed ^ solid).volume() < 1e-9 for solid in others)
        assert (placed ^ holder).volume() < 1e-9
        assert (seat.place_solid(tube.translate((0.6, 0, 0))) ^ holder).volume() > 1.0


def test_a_holder_prints_and_closes_on_its_tubes():
    """Oracle: overhangs of its small bores only; the slot cuts every bore."""
    for heights in ([7.0], [7.0, 12.0, 17.0]):
        solid = solid_of(tube_holder(heights, PartOptions()))
        part = Printed(name="holder", title="Holder", solid=solid)
        assert watertight_problems(part) == ()
        assert overhang(part) < 70
        sheet = Manifold.cube((0.8, 6, 60)).translate((-0.4, -3, min(heights)))
        assert (sheet ^ solid).volume() == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("name", OUTSIDE_ALL)
def test_every_tube_reaches_a_body_anywhere_in_front_of_the_base(name: str, unchecked: None):
    """Oracle: straight distances from each holder to all beginnings of cables, the body put at either end of the row.

    A tube that bends gently needs more than that: up to the way straight on and then to the side.
    """
    robot = gallery_robot(name)
    base, units = base_of(name)
    seats = {units[seat.unit].winch: seat for seat in base.seats}
    holders = {unit.winch: np.array(seats[unit.winch].place_point(holder_at(unit))) for unit in units}
    assert len({float(y) for _, y in holders.values()}) == 1
    row = [float(x) for x, _ in holders.values()]
    tubes, run = dict(base.tubes), PartOptions().run
    assert set(tubes) == set(range(len(robot.cables)))
    begins = 1e3 * np.array([cable.points[0] for cable in robot.cables])
    for unit in units:
        holder = holders[unit.winch] + np.array([0.0, HOLDER_DEPTH / 2])
        for cable in unit.cables:
            free = tubes[cable] - HOLDER_GAP - HOLDER_DEPTH
            for end in (min(row), max(row)):
                for nearest in begins:  # stands at the run from the row, in front of one of its ends
                    away = abs(end - holder[0]) + run + float(np.linalg.norm(begins[cable] - nearest))
                    assert free >= away - 1e-9
                    assert tubes[cable] > math.hypot(end - holder[0], run)


def test_the_run_is_an_option():
    robot = gallery_robot("trunk")
    tubes = []
    for run in (100.0, 350.0):
        options = PartOptions(run=run)
        base = base_plate(robot, winch_units(robot, options, MOTORS[0]), options, BED)
        assert base is not None
        tubes.append(dict(base.tubes))
    assert all(tubes[1][cable] == pytest.approx(tubes[0][cable] + 250.0) for cable in tubes[0])


@pytest.mark.slow
def test_a_tube_that_ends_where_its_cable_begins_is_to_be_held_there():
    robot = gallery_robot("fish_tail")
    bare = replace(robot, cables=(replace(robot.cables[0], sheathed=()), *robot.cables[1:]))
    parts = [
        base_plate(each, winch_units(each, PartOptions(), MOTORS[0]), PartOptions(), BED) for each in (robot, bare)
    ]
    assert next(base.warnings for base in parts if base is not None) == ()
    (text,) = (text for base in parts if base is not None for text in base.warnings)
    place = ", ".join(f"{1e3 * value + 0.0:.1f}" for value in robot.cables[0].points[0])
    assert "cable C1" in text
    assert f"({place}) mm" in text


@pytest.mark.slow
def test_a_core_is_lifted_off_with_its_plates(unchecked: None):
    """Oracles: solids; the way of a coupler from its plate to the housing, by the travel; a tube up to its stop."""
    robot = gallery_robot("cupping_hand")
    options = PartOptions(swap=True)
    units = winch_units(robot, options, MOTORS[0])
    base = base_plate(robot, units, options, BED)
    assert base is not None
    assert base.problems == ()
    assert interferences(base.assembly) == ()
    for part in base.printed:
        assert watertight_problems(part) == ()
    assert [part.count for part in base.printed if part.name == "line_coupler"] == [len(robot.cables)]
    pieces = base.assembly.pieces
    plates = [piece.solid for piece in pieces if piece.title == "Core plate"]
    fixed = [piece.solid for piece in pieces if piece.title not in ("Core plate", "Line coupler")]
    for plate in plates:
        assert all((plate.translate((0, 0, 30)) ^ solid).volume() == 0.0 for solid in fixed)
    travel = max(1e3 * winch.travel for winch in robot.winches)
    for coupler in (piece.solid for piece in pieces if piece.title == "Line coupler"):
        assert all((coupler.translate((0, -travel, 0)) ^ solid).volume() == 0.0 for solid in fixed)
    for seat in base.seats:
        (leaves,) = units[seat.unit].exits
        tube = Manifold.cylinder(HOLDER_DEPTH - 2.0, 0.97, -1, 24).rotate((-90, 0, 0)).translate(leaves.point)
        placed = seat.place_solid(tube.translate((0, base.bare + 0.01, 0)))
        assert all((placed ^ solid).volume() < 1e-9 for solid in plates)
        assert sum((placed.translate((0, -1.0, 0)) ^ solid).volume() for solid in plates) > 1.0
