"""`cleat`: the winding cleat in one piece that ends a cable and is adjusted by hand."""

import math
from dataclasses import dataclass

from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.stopper import Stopper
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.construct import Construction, Cylinder, Prism, Revolve, solid_of
from hydrostat.fabrication.solids.printed import Printed

TURNS = 8
"""Turns of the line round a cleat."""

PINCH = 0.5
"""Pull that the line withstands in a notch [N], assumed: it jams where the wedge is narrower than the line. Not
measured."""

FRICTION = 0.07
"""Friction coefficient of the turns, assumed: below the 0.1 to 0.2 of UHMWPE on plastic, because most turns lie on
line. Not measured. The holding force depends on it exponentially: 9 N at 0.055, 53 N at 0.09."""


@dataclass(frozen=True, kw_only=True)
class _CleatSizes:
    """Sizes of a cleat in millimeters.

    Attributes:
        rim: radius of the foot on the cloth and of the head.
        waist: radius between both, which the line is wound round.
        foot: thickness of the foot.
        straight: least height of the waist below the cone of the head, whose sides rise by 45 degrees to print by
            themselves; 1.5 times the diameter of a thick line.
        edge: height of the rim of the head.
        room: excess of the hole over the diameter of the line.
        chamfer: chamfer of the edge on the cloth.
        notch: depth of a notch from the rim.
        notches: number of notches.
    """

    rim: float = 6.5
    waist: float = 2.6
    foot: float = 1.6
    straight: float = 0.6
    edge: float = 0.8
    room: float = 0.8
    chamfer: float = 0.5
    notch: float = 3.4
    notches: int = 4


_SIZES = _CleatSizes()
_WIND = f"wind the line {TURNS} times round its waist, the tail taut, and pull the tail into a notch"


def cleat(options: PartOptions) -> Stopper:
    """The winding cleat for the end of a cable: one printed button, no screw, no tool.

    The cable comes up from the cloth next to the waist (it is laid in through the slot of the foot, nothing is
    threaded), is wound `TURNS` times round the waist, and its tail is pulled into a notch of the head. To take up
    slack, pull the tail out of the notch, unwind it, pull the cable straight and wind it again.

    Holding force: capstan friction of the turns on the pull that a notch holds (`holding_force`).
    """
    body = _button(options)
    printed = Printed.of(
        body,
        name="stopper",
        title="Stopper (winding cleat)",
        note="Foot on the bed, no support, 0.12 mm layers. Pull a thread through hole and notches to take off burrs.",
    )
    piece = Placed(name="stopper", title="Stopper (winding cleat)", solid=solid_of(body))
    return Stopper(
        printed=(printed,),
        assembly=PartAssembly(name="stopper", pieces=(piece,)),
        screw=None,
        hold=holding_force(),
        tail=40.0 + 5 * math.ceil(find_wound_length(options.cable) / 5),
        begin="lay it into the slot of its stopper and wind it three times round the waist for now",
        place="Unwind its stopper; slide it along the line until it touches the {surface} at the cable's last point",
        fix=_WIND,
        reset=f"unwind its stopper, pull the line straight, {_WIND}",
        check="tails in their notches",
    )


def holding_force(pinch: float = PINCH, friction: float = FRICTION, *, turns: float = TURNS) -> float:
    """Tension at which a cable begins to slip [N]: capstan equation, from the pull that the notch holds [N].

    The quarter turn from the hole onto the waist counts like the turns.
    """
    return pinch * math.exp(friction * (2 * math.pi * turns + math.pi / 2))


def find_wound_length(cable: float) -> float:
    """Length of the turns of a line of a diameter [mm], in layers that fill the groove from the waist outward [mm]."""
    length, radius, left = 0.0, _SIZES.waist + cable / 2, TURNS
    while left > 0:
        room = _find_straight(cable) + radius - _SIZES.waist  # height of the groove at this radius
        turns = min(left, max(1, math.floor(room / cable)))
        length, radius, left = length + 2 * math.pi * radius * turns, radius + cable, left - turns
    return length


def _find_straight(cable: float) -> float:
    """Height of the waist below the cone [mm]: a thick line needs room for its turns inside the rim."""
    return max(_SIZES.straight, 1.5 * cable)


def _button(options: PartOptions) -> Construction:
    """Foot, waist and head, with a hole for the line and the notches."""
    rim, waist, chamfer = _SIZES.rim, _SIZES.waist, _SIZES.chamfer
    neck = _SIZES.foot + _find_straight(options.cable)
    crown = neck + rim - waist
    side = ((0, 0), (rim - chamfer, 0), (rim, chamfer), (rim, _SIZES.foot), (waist, _SIZES.foot), (waist, neck))
    body: Construction = Revolve((*side, (rim, crown), (rim, crown + _SIZES.edge), (0, crown + _SIZES.edge)))
    body = body - _line_hole(options)
    for k in range(_SIZES.notches):
        body = body - _notch(options, crown + _SIZES.edge).rotate(z=(k + 0.5) * 360 / _SIZES.notches)
    return body


def _line_hole(options: PartOptions) -> Construction:
    """Hole of the line through the foot next to the waist, rounded below, and the slot by which it is laid in."""
    radius = (options.cable + _SIZES.room) / 2
    x, half, height = _SIZES.waist + radius, (options.cable + 0.4) / 2, _SIZES.foot + 0.01
    mouth = Cylinder(0.7, radius + 0.6, radius).move(x, 0, -0.1)
    slot = Prism(((x, -half), (_SIZES.rim + 1, -half), (_SIZES.rim + 1, half), (x, half)), height + 1)
    return Cylinder(height + 1, radius).move(x, 0, -1) + mouth + slot.move(0, 0, -1)


def _notch(options: PartOptions, top: float) -> Construction:
    """A wedge across the rim of the head, wider than the line at the rim, also as printed, sharp at its end."""
    half, outer = options.cable / 2 + 0.1 + options.fit, _SIZES.rim + 0.5
    inner = _SIZES.rim - _SIZES.notch
    wedge = ((inner, 0.0), (_SIZES.rim, -half), (outer, -half - 0.3), (outer, half + 0.3), (_SIZES.rim, half))
    return Prism(wedge, top).move(0, 0, _SIZES.foot + _SIZES.straight / 2)
