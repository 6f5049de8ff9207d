"""Housings: cables and tubes pass, screws hold and do not meet, the spool turns free."""

import math
from functools import cache

import pytest
from manifold3d import Manifold, OpType
from overhang import overhang

from hydrostat.fabrication.checks.solid_checks import watertight_problems
from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.housing import SHEET, Housing, drive_of
from hydrostat.fabrication.parts.motor import ALL_MOTORS, Motor
from hydrostat.fabrication.parts.spool import Groove, Spool
from hydrostat.fabrication.parts.winch_unit import WinchParts, letter_label
from hydrostat.fabrication.solids.assembly import interferences
from hydrostat.fabrication.solids.construct import solid_of

OPTIONS = [PartOptions(), PartOptions(cable=0.6, tube=4.0, bore=2.0, clearance=0.5, wall=2.2)]
RADII = [(6.0,), (6.0, 6.0, 6.0), (9.0, 6.0)]


def housing(motor: Motor, options: PartOptions, radii: tuple[float, ...], *, outside: bool = False) -> Housing:
    spool = Spool(
        grooves=tuple(Groove(radius=radius, width=2.5) for radius in radii),
        cable=options.cable,
        shaft=motor.shaft,
        inside=drive_of(motor, options).inside,
        play=options.fit,
        wall=options.wall,
        journal=options.clearance + max(options.wall, 2.0) - 0.2,
    )
    azimuths = tuple((90 + 90 * place) % 360 for place in range(len(radii)))
    return Housing(motor=motor, spool=spool, azimuths=azimuths, outside=outside, options=options)


CASES = [(0, 1, False), (0, 0, True), (1, 2, False), (1, 0, True)]
ALL = [housing(motor, OPTIONS[a], RADII[b], outside=outside) for motor in ALL_MOTORS for a, b, outside in CASES]
every = pytest.mark.parametrize("made", ALL)


@cache
def pieces_of(made: Housing) -> dict[str, Manifold]:
    """Solids of the assembly by their names."""
    return {piece.name: piece.solid for piece in WinchParts().of(made, "one")[1].pieces}


def rod(made: Housing, place: int, radius: float, start: float, end: float, up: float = 0.0) -> Manifold:
    """Along the channel of a cable, from `start` to `end`, counted from where the cable leaves the spool [mm]."""
    groove = made.spool.grooves[place].radius
    along_x = Manifold.cylinder(end - start, radius, -1, 24).rotate((0, 90, 0)).translate((start, -groove, up))
    return along_x.rotate((0, 0, made.azimuths[place])).translate((0, 0, made.height(place)))


def posts(made: Housing, radius: float, low: float, high: float) -> Manifold:
    pin = Manifold.cylinder(high - low, radius, -1, 24).translate((0, 0, low))
    return Manifold.batch_boolean(
        [pin.translate((x, y, 0)) for x in (-made.post, made.post) for y in (-made.post, made.post)],
        OpType.Add,
    )


@every
def test_all_pieces_fit_and_print(made: Housing):
    """Oracle: boolean intersections; edges and overhangs of the triangles in the files."""
    printed, assembly = WinchParts().of(made, "one")
    assert interferences(assembly) == ()
    for part in printed:
        assert watertight_problems(part) == ()
        channels = 2 * made.options.tube * made.half * len(made.azimuths)
        hub = made.motor.horn.hub + made.options.clearance if made.motor.horn and made.motor.horn.hub else 0.0
        bridge = math.pi * hub**2 + 0.5 if part.name.startswith("coupling") else 0.5  # spans the hub of a horn
        assert overhang(part) < (channels if part.name.startswith("housing") else bridge)


@every
def test_the_spool_turns_free(made: Housing):
    """Oracle: least gaps between solids: the set clearance to plate, roof and coupling, and on the pin."""
    pieces = pieces_of(made)
    spool, clearance = pieces["spool_a"], made.options.clearance
    assert pieces["housing_a"].min_gap(spool, 5.0) == pytest.approx(clearance, abs=0.03)
    assert pieces["motor_plate_a"].min_gap(spool, 5.0) >= clearance - 0.03
    turned = spool.rotate((0, 0, 77))
    assert (turned ^ pieces["housing_a"]).volume() == 0.0


@every
def test_a_cable_runs_straight_from_its_groove_to_its_tube(made: Housing):
    """Oracle: a straight cable and a straight tube touch nothing; a little higher the cable does."""
    box = solid_of(made.box())
    for place in range(len(made.azimuths)):
        assert (box ^ rod(made, place, made.options.cable / 2, 0, made.half + 5)).volume() == 0.0
        assert (box ^ rod(made, place, made.options.cable / 2, 0, made.half + 5, up=2.5)).volume() > 0.1
        face, seat, tube = made.half, made.seat(place), made.options.tube / 2
        assert (box ^ rod(made, place, tube, face - seat + 0.01, face + 5)).volume() == 0.0
        assert (box ^ rod(made, place, tube, face - seat - 0.2, face + 5)).volume() > 0.05


@every
def test_a_seat_holds_its_tube(made: Housing):
    for place in range(len(made.azimuths)):
        assert made.seat(place) >= 1.5


@every
def test_screws_of_the_box_do_not_meet_cables_or_motor(made: Housing):
    """Oracle: least gaps between the holes, and what a drill of the screw's size would take of other parts."""
    passage = made.screw.passage / 2
    holes = posts(made, passage, made.drive.plate, made.top)
    for place in range(len(made.azimuths)):
        seat = rod(made, place, made.options.tube / 2 + made.options.fit, 0, made.half)
        assert holes.min_gap(seat, 5.0) >= made.options.wall - 0.05
    room = Manifold.cylinder(made.top, made.cavity, -1, 96)
    assert holes.min_gap(room, 5.0) >= made.options.wall - 0.05
    if made.outside:
        below = posts(made, passage, -SHEET, 0)
        assert below.min_gap(solid_of(made.motor.body), 9.0) >= made.options.wall


@every
def test_screws_of_the_box_hold(made: Housing):
    """Oracle: lengths along the screw: it ends in the plate, or a nut has room below the base."""
    end = made.top - made.head_depth - made.screw.length
    if made.outside:
        assert end <= -SHEET - 1.6
    else:
        assert end >= 0.25
        assert made.drive.plate - max(end, 0.4) >= 1.9


@every
def test_screws_in_the_face_can_be_put_in_before_the_box(made: Housing):
    """Oracle: heads with their screws touch neither plate nor, when it is on, the box and the spool."""
    pieces = pieces_of(made)
    screw, floor = made.motor.screw, made.drive.floor
    for x, y in made.motor.holes:
        head = Manifold.cylinder(screw.head_height, screw.head / 2, -1, 32).translate((x, y, floor))
        shank = Manifold.cylinder(floor + 2, screw.hole / 2 - 0.1, -1, 32).translate((x, y, -1))
        for name in ("motor_plate_a", "housing_a", "spool_a"):
            assert (pieces[name] ^ (head + shank)).volume() < 1e-6
        assert (pieces["motor_plate_a"] ^ head.translate((0, 0, -0.3))).volume() > 0.1


def test_the_coupling_is_screwed_on_the_horn():
    """Oracle: screws with their heads touch neither coupling nor spool, and go through the disc."""
    made = next(each for each in ALL if each.motor.horn)
    horn = made.motor.horn
    assert horn is not None
    pieces = pieces_of(made)
    top = horn.height + made.drive.disc
    for step in range(horn.count):
        angle = 2 * math.pi * step / horn.count
        head = Manifold.cylinder(1.6, 2.0, -1, 32).translate((6 * math.cos(angle), 6 * math.sin(angle), top))
        shank = Manifold.cylinder(9, 1.0, -1, 32).translate((6 * math.cos(angle), 6 * math.sin(angle), 0))
        for name in ("coupling_a", "spool_a"):
            assert (pieces[name] ^ head).volume() < 1e-6
        assert (pieces["coupling_a"] ^ shank).volume() == 0.0


def test_names_go_on_after_z():
    assert [letter_label(number) for number in (0, 25, 26, 27, 701, 702)] == ["a", "z", "aa", "ab", "zz", "aaa"]
