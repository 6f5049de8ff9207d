"""The checks of solids hold for sound parts, and fail for others."""

from dataclasses import replace

import numpy as np
from manifold3d import Manifold
from plush_robots import crossed

from hydrostat.fabrication import MOTORS, PartOptions
from hydrostat.fabrication.checks.solid_checks import solid_checks, spool_checks, too_large
from hydrostat.fabrication.parts.winch_unit import WinchUnit, winch_units
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.printed import Printed

CUBE = Manifold.cube((10.0, 20.0, 30.0))


def part(solid: Manifold = CUBE) -> Printed:
    return Printed(name="cube", title="Cube", solid=solid)


def pair(apart: float) -> PartAssembly:
    """Two cubes beside each other [mm]."""
    return PartAssembly(
        name="pair",
        pieces=(
            Placed(name="one", title="One", solid=CUBE),
            Placed(name="other", title="Other", solid=CUBE.translate((10.0 + apart, 0.0, 0.0))),
        ),
    )


def test_sound_parts_that_touch_hold():
    assert [check.passed for check in solid_checks([part()], [pair(0.0)])] == [True, True]


def test_a_part_in_two_pieces_is_seen():
    broken = part(CUBE + CUBE.translate((40.0, 0.0, 0.0)))
    assert [check.passed for check in solid_checks([broken], [pair(1.0)])] == [False, True]


def test_pieces_in_one_place_are_seen_with_what_they_share():
    """Oracle: a slab of 0.5 x 20 x 30 mm."""
    checks = solid_checks([part()], [pair(-0.5)])
    assert [check.passed for check in checks] == [True, False]
    assert checks[1].measured == "one and other share 300.00 mm^3"


def test_a_part_may_be_turned_on_the_bed_but_not_tilted():
    assert too_large([part()], (20.0, 10.0, 30.0)) == ()
    (reason,) = too_large([part()], (30.0, 30.0, 20.0))
    assert reason.startswith("cube of 10 x 20 x 30 mm does not fit the printer (30 x 30 x 20 mm)")
    assert too_large([part()], (19.0, 19.0, 30.0)) != ()


def units() -> tuple[WinchUnit, ...]:
    return winch_units(crossed(), PartOptions(), MOTORS[0])


def test_spools_have_the_radius_of_the_robot_file():
    (check,) = spool_checks(crossed(), units())
    assert check.passed
    assert check.what.startswith("radius of 2 grooves")


def test_a_spool_that_is_too_thick_is_seen():
    """Oracle: a spool of 6 mm printed 3 % too large, 0.17 mm at its floor."""
    (unit,) = units()
    spool = next(item for item in unit.printed if item.name.startswith("spool"))
    scaled = Printed(name=spool.name, title=spool.title, solid=spool.solid.scale((1.03, 1.03, 1.0)))
    wrong = [scaled if item is spool else item for item in unit.printed]
    (check,) = spool_checks(crossed(), [replace(unit, printed=tuple(wrong))])
    assert not check.passed
    assert np.isclose(float(check.measured.split()[2]), 0.03 * 5.8, atol=0.02)
