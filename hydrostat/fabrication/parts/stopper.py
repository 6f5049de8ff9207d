"""`screw_stopper`: the clamp in two pieces that ends a cable and is adjusted with a screwdriver (thesis, Fig 3.3)."""

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


@dataclass(frozen=True, kw_only=True)
class _StopperSizes:
    """Sizes of a stopper in millimeters.

    Attributes:
        post: radius of the post that the cable goes round.
        key: radius of the key on the post.
        flat: distance of the flat of the key from the axis.
        room: excess width of the holes and the track over the cable.
        lid: thickness of the lid.
        key_height: height of the key in the lid.
        rim: width of the rim behind the track.
        rib: width of a rib.
        floor: thickness of the floor.
        tip: plastic and air below the point of the screw.
        chamfer: chamfer of edges that lie on the cloth or that a hand touches.
        off_center: distance of the middle of the button from the screw towards the cable, so that it is pulled flat.
        exit: angle where the cable leaves, round the post from where it comes up [degrees].
    """

    post: float = 2.4
    key: float = 2.2
    flat: float = 1.5
    room: float = 0.8
    lid: float = 2.6
    key_height: float = 1.2
    rim: float = 1.0
    rib: float = 0.8
    floor: float = 0.8
    tip: float = 0.4
    chamfer: float = 0.6
    off_center: float = 0.8
    exit: float = 300.0


_SIZES = _StopperSizes()


@dataclass(frozen=True, eq=False, kw_only=True)
class Stopper:
    """End of a cable."""

    printed: tuple[Printed, ...]  # the piece that lies on the cloth first
    # of the clamp with its screw, closed on a cable that is pressed to half its thickness; the cloth is at z = 0
    assembly: PartAssembly
    screw: str | None  # title of the screw that closes it; None without
    hold: float  # tension at which the cable begins to slip, estimated [N]
    tail: float  # line beyond it, to hold while it is set and to let out when it is adjusted [mm], assumed
    begin: str  # command that puts it on for the time being
    place: str  # command that puts it on the {surface} at the last point of its cable
    fix: str  # command that makes it hold the line
    reset: str  # command that takes up slack
    check: str  # its final state


def screw_stopper(options: PartOptions) -> Stopper:
    """The clamp for the end of a cable: a button in two pieces, closed by one countersunk screw.

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
            lid.rotate(x=180).move(0, 0, _SIZES.lid),
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
            solid=solid_of(M2X6.envelope.move(0, 0, closed + _SIZES.lid)),
            pulled=(0, 0, 14),
            printed=False,
        ),
    )
    return Stopper(
        printed=printed,
        assembly=PartAssembly(name="stopper", pieces=pieces),
        screw=M2X6.title,
        hold=holding_force(),
        tail=80.0,
        begin="put the stopper on loosely",
        place="Slide its stopper along the line until it touches the {surface} at the cable's last point",
        fix="clamp it there",
        reset="loosen its stopper by half a turn, pull the line straight and tighten the screw",
        check="screws tight",
    )


def holding_force(
    preload: float = PRELOAD, friction: float = FRICTION, *, wrap: float = math.radians(_SIZES.exit)
) -> float:
    """Tension at which a cable begins to slip [N].

    Along the wrap [rad] both faces rub with friction times the pressure q of the screw, and the post as a capstan does:
    dT/dphi = 2 mu q r + mu T with q r = F / wrap and no tension at the loose end, so T = 2 F (exp(mu wrap) - 1) / wrap.
    The quarter turn from the hole into the track multiplies it by exp(mu pi / 2).
    """
    clamped = 2 * preload * math.expm1(friction * wrap) / wrap
    return clamped * math.exp(friction * math.pi / 2)


def _deck() -> float:
    """Height of the floor of the track above the cloth [mm]."""
    return _SIZES.floor + _SIZES.tip + M2X6.length - _SIZES.lid - 0.4


def _track(options: PartOptions) -> float:
    """Outer radius of the track [mm]."""
    return _SIZES.post + options.cable + 1.0


def _button(options: PartOptions, height: float) -> Construction:
    """The outline of both pieces: a disc about a point between the screw and the cable, its lower edge smooth."""
    radius = _SIZES.off_center + _track(options) + _SIZES.rim
    side = ((0, 0), (radius - _SIZES.chamfer, 0), (radius, _SIZES.chamfer), (radius, height), (0, height))
    return Revolve(side).move(_SIZES.off_center, 0, 0)


def _rib_angles(options: PartOptions) -> list[float]:
    """Angles of the ribs [degrees]; those of base and lid take turns, with room for the cable between them."""
    apart = (_SIZES.rib + 1.3 * options.cable) / (_SIZES.post + options.cable / 2)
    first, last = 45.0, _SIZES.exit - 30
    count = max(2, math.floor(math.radians(last - first) / apart))
    return [first + (last - first) * k / count for k in range(count + 1)]


def _rib(angle: float, height: float, inside: float, outside: float) -> Construction:
    """A wall across the track at an angle [degrees], between two distances from the axis."""
    return Box((outside - inside, _SIZES.rib, height)).move(inside, -_SIZES.rib / 2, 0).rotate(z=angle)


def _key(radius: float, flat: float, height: float) -> Construction:
    """A post with one flat, on the side away from the cable."""
    return Cylinder(height, radius) & Box((2 * radius + 2, 4 * radius, height)).move(-flat, -2 * radius, 0)


def _base(options: PartOptions, rib: float) -> Construction:
    deck, track = _deck(), _track(options)
    body: Construction = _button(options, deck + rib) - Cylinder(rib + 1, track).move(0, 0, deck)
    for angle in _rib_angles(options)[::2]:
        body = body + _rib(angle, rib + 0.2, _SIZES.post - 0.2, track + 0.2).move(0, 0, deck - 0.2)
    body = body + Cylinder(rib + options.cable / 4 + 0.2, _SIZES.post).move(0, 0, deck - 0.2)
    body = body + _key(_SIZES.key, _SIZES.flat, rib + _SIZES.key_height).move(0, 0, deck - 0.2)
    body = body - Cylinder(20, M2X6.pilot / 2).move(0, 0, _SIZES.floor)
    body = body - _way_up(options)
    notch = Box((20, options.cable + _SIZES.room, 20)).move(_SIZES.post, -(options.cable + _SIZES.room) / 2, deck)
    return body - notch.rotate(z=_SIZES.exit)


def _way_up(options: PartOptions) -> Construction:
    """Channel of the cable next to the post: a hole with chamfers, and the slot by which it is laid in."""
    deck, radius = _deck(), (options.cable + _SIZES.room) / 2
    x, slot = _SIZES.post + radius, options.cable + 0.4
    below = Cylinder(0.7, radius + 0.7, radius).move(x, 0, -0.1)
    above = Cylinder(0.5, radius, radius + 0.5).move(x, 0, deck - 0.4)
    track = Cylinder(20, _track(options)) - Cylinder(20, _SIZES.post)
    sides = Box((20, slot, 30)).move(x, -slot / 2, -1)
    return Cylinder(20, radius).move(x, 0, -1) + below + (above & track) + sides


def _lid(options: PartOptions, rib: float) -> Construction:
    """Lid with its lower face at z = 0, as it lies on the base; ribs hang below."""
    free = options.fit
    body: Construction = _button(options, _SIZES.lid).rotate(x=180).move(0, 0, _SIZES.lid)
    for angle in _rib_angles(options)[1::2]:
        body = body + _rib(angle, rib + 0.2, _SIZES.post + free, _track(options) - 0.2).move(0, 0, -rib)
    body = body - _key(_SIZES.key + free, _SIZES.flat + free, _SIZES.key_height + 1).move(0, 0, -1)
    body = body - Cylinder(20, M2X6.passage / 2).move(0, 0, -1)
    sunk = (M2X6.head - M2X6.passage) / 2 + 0.1
    return body - Cylinder(sunk + 0.1, M2X6.passage / 2, M2X6.head / 2 + 0.2).move(0, 0, _SIZES.lid - sunk)
