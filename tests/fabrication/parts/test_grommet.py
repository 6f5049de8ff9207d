"""The grommet: fits its hole, lets the cable run, prints without support."""

import numpy as np
import pytest
from overhang import overhang

from hydrostat.errors import InputError
from hydrostat.fabrication.checks.solid_checks import watertight_problems
from hydrostat.fabrication.kit_options import PartOptions, PatternOptions
from hydrostat.fabrication.parts.rigid_parts import grommet
from hydrostat.fabrication.solids.printed import Printed

HOLES = [PatternOptions().pinhole, 3.0, 6.0]


def radii(printed: Printed, height: float) -> tuple[float, float]:
    """Of the bore and of the outside at a height [mm]."""
    corners = np.concatenate(printed.solid.slice(height).to_polygons())
    distances = np.linalg.norm(corners, axis=1)
    return float(distances.min()), float(distances.max())


@pytest.mark.parametrize("hole", HOLES)
def test_it_prints_without_support(hole: float):
    """Oracle: triangles that face down."""
    made = grommet(PartOptions(), hole)
    assert watertight_problems(made) == ()
    assert overhang(made) == 0


def test_the_measure_of_overhangs_can_fail():
    """Oracle: a grommet on its sleeve: all of the flange hangs in the air."""
    made = grommet(PartOptions(), 3.0)
    solid = made.solid.rotate((180, 0, 0)).translate((0, 0, made.size[2]))
    assert overhang(Printed(name="grommet", title="Grommet", solid=solid)) > 30


@pytest.mark.parametrize("hole", HOLES)
def test_it_fits_the_hole_and_the_cable_fits_it(hole: float):
    """Oracle: circles cut out of the solid."""
    options = PartOptions()
    bore, sleeve = radii(grommet(options, hole), 2.2)
    assert sleeve == pytest.approx(hole / 2 - options.fit, abs=0.03)
    assert 2 * bore >= options.cable + 0.3
    assert sleeve - bore >= 0.35
    assert radii(grommet(options, hole), 0.8)[1] >= hole / 2 + 2


def test_its_mouth_is_wide_and_narrows_in_steps():
    """Oracle: the widths of the bore at heights."""
    made = grommet(PartOptions(), 2.0)
    widths = [radii(made, height)[0] for height in (0.02, 0.3, 0.75, 1.3, 2.0)]
    assert all(np.diff(widths) <= 1e-3)
    assert widths[0] - widths[-1] > 0.9


def test_it_is_sewn_on_through_four_holes():
    """Oracle: the rings of a cut through the flange."""
    polygons = grommet(PartOptions(), 2.0).solid.slice(1.0).to_polygons()
    assert len(polygons) == 6


def test_a_hole_without_room_for_a_sleeve_is_refused():
    """Oracle: 0.4 mm of cable, as much play, two lines of plastic and twice the fit: 1.9 mm."""
    assert grommet(PartOptions(), 1.9).volume > 0
    with pytest.raises(InputError, match=r"needs a pinhole of 1\.9 mm or more, not 1\.8 mm"):
        grommet(PartOptions(), 1.8)
