"""`grommet`: an eyelet that keeps a cable from sawing through the cloth at a pinhole."""

import math

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.solids.construct import Construction, Cylinder, Revolve
from hydrostat.fabrication.solids.printed import Printed

_LINE = 0.4  # width of one line of a nozzle: the thinnest sleeve [mm]
_PLAY = 0.4  # minimum excess of the bore over the cable [mm]

_MOUTH = ((1.0, 0.0), (0.65, 0.3), (0.25, 0.75), (0.0, 1.3))
"""Excess of the mouth's radius over the bore's, and height above the bed [mm]: a rounding in steps of less than 50
degrees from upright, which prints without support."""

_FLANGE = 1.6
_SLEEVE = 1.4  # length of the sleeve in the felt [mm]: felt of 1.5 mm or more hides its end
_STITCH = 1.0  # diameter of a hole for needle and thread [mm]
_RIM = 1.0  # least material on each side of a hole for the needle [mm]


def grommet(options: PartOptions, hole: float) -> Printed:
    """An eyelet for a pinhole of a diameter [mm], sewn on the side where the cable bends away along the cloth.

    The sleeve goes into the hole, the flange lies on the felt and is sewn on through four holes, as a button is: felt
    is too soft for anything that is only pressed on. The cable runs over the rounded mouth of the flange. Raises
    InputError: the hole is too small for a sleeve of one line of plastic round the cable.
    """
    least = options.cable + _PLAY + 2 * _LINE + 2 * options.fit
    if not (math.isfinite(hole) and hole >= least - 1e-9):
        raise InputError(
            f"a grommet for a cable of {options.cable:g} mm needs a pinhole of {least:g} mm or more, not {hole:g} mm: "
            "its sleeve would be thinner than a line of plastic"
        )
    return Printed.of(
        _model(options, hole),
        name="grommet",
        title=f"Grommet for a pinhole of {hole:g} mm",
        note="Flange on the bed, no support, 0.12 mm layers; pull a thread through to take off burrs.",
    )


def _model(options: PartOptions, hole: float) -> Construction:
    sleeve = hole / 2 - options.fit
    bore = max((options.cable + _PLAY) / 2, sleeve - options.wall)
    stitches = max(bore + _MOUTH[0][0], sleeve) + _RIM + _STITCH / 2
    eyelet = Revolve(_profile(bore, sleeve, stitches + _STITCH / 2 + _RIM))
    needle = Cylinder(_FLANGE + 2, _STITCH / 2)
    model: Construction = eyelet
    for angle in (45, 135, 225, 315):
        x, y = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        model = model - needle.move(stitches * x, stitches * y, -1)
    return model


def _profile(bore: float, sleeve: float, flange: float) -> tuple[tuple[float, float], ...]:
    """(radius, height) corners of the eyelet, counter-clockwise, from the mouth on the bed outwards."""
    top = _FLANGE + _SLEEVE
    lead = min(0.3, (sleeve - bore) / 3)
    outside = ((flange - 0.4, 0.0), (flange, 0.4), (flange, _FLANGE), (sleeve, _FLANGE))
    end = ((sleeve, top - 2 * lead), (sleeve - lead, top), (bore, top))
    mouth = tuple((bore + wider, height) for wider, height in _MOUTH)
    return (mouth[0], *outside, *end, *reversed(mouth[1:]))
