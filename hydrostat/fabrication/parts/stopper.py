"""`stopper`: the clamp in two pieces that ends a cable and is adjusted with a screwdriver (thesis, Fig 3.3)."""

import math
from dataclasses import dataclass

from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.screws import M2X6
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.construct import Box, Construction, Cylinder, Revolve, solid_of
from hydrostat.fabrication.solids.printed import Printed

PRELOAD = 50.0
"""Clamping force that the screw keeps [N], assumed: 0.05 N m of a small screwdriver give about 80 N by T = K F d with
K = 0.3 in plastic, of which creep of PLA takes a third. Measured on none, check yours."""

FRICTION = 0.1
"""Friction coefficient of braided polyethylene on plastic: the lower end of 0.1 to 0.2 for UHMWPE. Not measured."""

_POST = 2.4
_KEY = 2.2
_FLAT = 1.5
"""Radius of the post that the cable goes round, of the key above it, and how far the flat of the key is from the axis
[mm]."""

_ROOM = 0.8  # excess width of the holes and the track over the cable [mm]

_LID = 2.6
_KEY_HEIGHT = 1.2
_RIM = 1.0
_RIB = 0.8  # thickness of the lid, height of the key in it, width of the rim behind the track, width of a rib [mm]

_FLOOR = 0.8
_TIP = 0.4  # below the point of the screw: plastic, and air [mm]
_SMOOTH = 0.6  # chamfer of what lies on the cloth and of what a hand feels [mm]

_OFF_CENTER = 0.8
"""Distance of the middle of the button from the screw towards the cable, so that it is pulled flat [mm]."""

_EXIT = 300.0  # angle where the cable leaves, round the post from where it comes up [degrees]


@dataclass(frozen=True, eq=False, kw_only=True)
class Stopper:
    """A clamp for the end of a cable."""

    printed: tuple[Printed, ...]  # the base, which lies on the cloth, and the lid
    # both with the screw, closed on a cable that is pressed to half its thickness; the cloth is at z = 0
    assembly: PartAssembly
    screw: str  # title of the screw that closes it
    hold: float  # tension at which the cable begins to slip, estimated [N]


def stopper(options: PartOptions) -> Stopper:
    """The stopper for a cable: a button in two pieces, closed by one countersunk screw.

    The cable comes up from the cloth beside the screw (it is laid in through the slot, nothing is threaded), goes 300
    degrees round the post of the screw between ribs of base and lid that bend it up and down, and leaves through the
    notch. Loosen by half a turn, pull the cable, tighten. The top of the post is the key that keeps the lid from
    turning along. The slot is narrower than a pinhole, and the cable is pulled away from it, towards the post.

    How much it holds is `holding_force` at `PRELOAD` and `FRICTION`. The ribs are not counted: they spread the pressure
    evenly on a print that is not even, and what the braid gains by biting into them is unknown. Where a cable pulls
    harder, tie a knot in it behind the notch once it is adjusted.
    """
    rib = max(0.4, options.cable)
    base, lid = _base(options, rib), _lid(options, rib)
    closed = _deck() + rib + options.cable / 2
    printed = (
        Printed.of(
            base,
            name="stopper_base",
            title="Stopper base",
            note="Flat side on the bed, no support, 0.12 mm layers, all walls (100 % infill).",
        ),
        Printed.of(
            lid.rotate(x=180).move(0, 0, _LID),
            name="stopper_lid",
            title="Stopper lid",
            note="Outer side on the bed, ribs up, no support, 0.12 mm layers, all walls (100 % infill).",
        ),
    )
    pieces = (
        Placed(name="stopper_base", title="Stopper base", solid=solid_of(base)),
        Placed(name="stopper_lid", title="Stopper lid", solid=solid_of(lid.move(0, 0, closed)), pulled=(0, 0, 6)),
        Placed(
            name="stopper_screw",
            title=M2X6.title,
            solid=solid_of(M2X6.envelope.move(0, 0, closed + _LID)),
            pulled=(0, 0, 14),
            printed=False,
        ),
    )
    return Stopper(
        printed=printed, assembly=PartAssembly(name="stopper", pieces=pieces), screw=M2X6.title, hold=holding_force()
    )


def holding_force(preload: float = PRELOAD, friction: float = FRICTION, *, wrap: float = math.radians(_EXIT)) -> float:
    """Tension at which a cable begins to slip [N].

    Along the wrap [rad] both faces rub with friction times the pressure q of the screw, and the post as a capstan does:
    dT/dphi = 2 mu q r + mu T with q r = F / wrap and no tension at the loose end, so T = 2 F (exp(mu wrap) - 1) / wrap.
    The quarter turn from the hole into the track multiplies it by exp(mu pi / 2).
    """
    clamped = 2 * preload * math.expm1(friction * wrap) / wrap
    return clamped * math.exp(friction * math.pi / 2)


def _deck() -> float:
    """Height of the floor of the track above the cloth [mm]."""
    return _FLOOR + _TIP + M2X6.length - _LID - 0.4


def _track(options: PartOptions) -> float:
    """Outer radius of the track [mm]."""
    return _POST + options.cable + 1.0


def _button(options: PartOptions, height: float) -> Construction:
    """The outline of both pieces: a disc about a point between the screw and the cable, its lower edge smooth."""
    radius = _OFF_CENTER + _track(options) + _RIM
    side = ((0, 0), (radius - _SMOOTH, 0), (radius, _SMOOTH), (radius, height), (0, height))
    return Revolve(side).move(_OFF_CENTER, 0, 0)


def _rib_angles(options: PartOptions) -> list[float]:
    """Angles of the ribs [degrees]; those of base and lid take turns, with room for the cable between them."""
    apart = (_RIB + 1.3 * options.cable) / (_POST + options.cable / 2)
    first, last = 45.0, _EXIT - 30
    count = max(2, math.floor(math.radians(last - first) / apart))
    return [first + (last - first) * k / count for k in range(count + 1)]


def _rib(angle: float, height: float, inside: float, outside: float) -> Construction:
    """A wall across the track at an angle [degrees], between two distances from the axis."""
    return Box((outside - inside, _RIB, height)).move(inside, -_RIB / 2, 0).rotate(z=angle)


def _key(radius: float, flat: float, height: float) -> Construction:
    """A post with one flat, on the side away from the cable."""
    return Cylinder(height, radius) & Box((2 * radius + 2, 4 * radius, height)).move(-flat, -2 * radius, 0)


def _base(options: PartOptions, rib: float) -> Construction:
    deck, track = _deck(), _track(options)
    body: Construction = _button(options, deck + rib) - Cylinder(rib + 1, track).move(0, 0, deck)
    for angle in _rib_angles(options)[::2]:
        body = body + _rib(angle, rib + 0.2, _POST - 0.2, track + 0.2).move(0, 0, deck - 0.2)
    body = body + Cylinder(rib + options.cable / 4 + 0.2, _POST).move(0, 0, deck - 0.2)
    body = body + _key(_KEY, _FLAT, rib + _KEY_HEIGHT).move(0, 0, deck - 0.2)
    body = body - Cylinder(20, M2X6.pilot / 2).move(0, 0, _FLOOR)
    body = body - _way_up(options)
    notch = Box((20, options.cable + _ROOM, 20)).move(_POST, -(options.cable + _ROOM) / 2, deck)
    return body - notch.rotate(z=_EXIT)


def _way_up(options: PartOptions) -> Construction:
    """Channel of the cable next to the post: a hole with chamfers, and the slot by which it is laid in."""
    deck, radius = _deck(), (options.cable + _ROOM) / 2
    x, slot = _POST + radius, options.cable + 0.4
    below = Cylinder(0.7, radius + 0.7, radius).move(x, 0, -0.1)
    above = Cylinder(0.5, radius, radius + 0.5).move(x, 0, deck - 0.4)
    track = Cylinder(20, _track(options)) - Cylinder(20, _POST)
    sides = Box((20, slot, 30)).move(x, -slot / 2, -1)
    return Cylinder(20, radius).move(x, 0, -1) + below + (above & track) + sides


def _lid(options: PartOptions, rib: float) -> Construction:
    """Lid with its lower face at z = 0, as it lies on the base; ribs hang below."""
    free = options.fit
    body: Construction = _button(options, _LID).rotate(x=180).move(0, 0, _LID)
    for angle in _rib_angles(options)[1::2]:
        body = body + _rib(angle, rib + 0.2, _POST + free, _track(options) - 0.2).move(0, 0, -rib)
    body = body - _key(_KEY + free, _FLAT + free, _KEY_HEIGHT + 1).move(0, 0, -1)
    body = body - Cylinder(20, M2X6.passage / 2).move(0, 0, -1)
    sunk = (M2X6.head - M2X6.passage) / 2 + 0.1
    return body - Cylinder(sunk + 0.1, M2X6.passage / 2, M2X6.head / 2 + 0.2).move(0, 0, _LID - sunk)
