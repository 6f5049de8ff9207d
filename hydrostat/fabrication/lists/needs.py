"""What a robot takes, as items of the bill."""

import math

from hydrostat.fabrication.lists.bill import Item
from hydrostat.fabrication.lists.cuts import CableCut, SheathCut
from hydrostat.fabrication.lists.line import FishingLine
from hydrostat.fabrication.lists.list_input import Cloth, FoamNeeds, ListInput
from hydrostat.fabrication.lists.prices import NO_SOURCE, PRICES, Price
from hydrostat.fabrication.parts.motor import Motor

POLYETHYLENE = 0.97e-3
"""Density of the fibres of braided line [g/mm^3] (gel-spun polyethylene floats: 0.97 g/cm^3)."""

PTFE = 2.15e-3
"""Density of the tube [g/mm^3]; ASTM D792, in data sheets of PTFE tube."""

SPOOL = 100e3
"""Thread on a spool [mm]."""

THREAD = 4.0
"""Thread for a length of seam: two threads of a lock stitch, sewn twice. Assumed."""

_BOARD_MOTORS = 6
"""Motors for one board: it has so many outputs that set a speed (PWM)."""

_DRIVER_MOTORS = 2
"""Motors for one driver."""

DOWEL = 15.0
"""Length of a dowel [mm]: a little less than the holes in both pieces are deep."""

_BODY, _CABLES, _WINCHES, _CONTROL, _MOULD = "body", "cables", "winches", "control", "mould"
_SILICONES = ("ecoflex", "dragon skin")
"""Beginnings of names of materials that are poured and are no foam."""

_NEEDLES = Item(
    group=_BODY,
    what="needles",
    specification="sewing, and a long doll needle",
    quantity=1.0,
    price=PRICES["needle"],
)


def all_needs(
    given: ListInput, line: FishingLine, cuts: tuple[CableCut, ...], tubes: tuple[SheathCut, ...]
) -> list[Item]:
    """What a robot takes, group by group."""
    items = []
    if given.cloth is not None:
        items += _plush(given, given.cloth)
    if given.foam is not None:
        items += _foam(given, given.foam)
    items += [*_cables(given, line, cuts, tubes), *_winches(given), *_control(given), *_mould(given)]
    return [item for item in items if item.quantity > 0]


def filling_mass(given: ListInput) -> float:
    """Of what the body is made of: its volume at rest times the density of its material [g]."""
    body = given.robot.body
    return 1e3 * float(body.mesh.volumes.sum()) * (body.thickness or 1.0) * body.material.density


def _plush(given: ListInput, cloth: Cloth) -> list[Item]:
    mass = filling_mass(given)
    zipper = f"{math.ceil(cloth.zipper / 10) * 10:g} mm or longer"
    return [
        Item(
            group=_BODY,
            what="felt",
            specification="that a laser may cut: wool, polyester or acrylic, no PVC; 1 to 2 mm",
            quantity=1e-6 * cloth.felt,
            price=PRICES["felt"],
        ),
        Item(
            group=_BODY,
            what="fibre filling",
            specification=given.robot.body.material.name or "as the robot file says",
            quantity=1e-3 * mass,
            price=PRICES["filling"],
            mass=mass,
        ),
        Item(
            group=_BODY,
            what="all-purpose thread",
            specification=f"polyester, {1e-3 * THREAD * cloth.seam:.0f} m",
            quantity=math.ceil(THREAD * cloth.seam / SPOOL),
            price=PRICES["thread"],
        ),
        Item(
            group=_BODY,
            what="zipper",
            specification=zipper,
            quantity=1.0 if cloth.zipper > 0 else 0.0,
            price=PRICES["zipper"],
        ),
        _NEEDLES,
    ]


def _foam(given: ListInput, foam: FoamNeeds) -> list[Item]:
    kind = foam.material or given.robot.body.material.name or "as the robot file says"
    what = "silicone" if kind.startswith(_SILICONES) else "foam"
    parts = (("A", foam.part_a), ("B", foam.part_b))
    return [
        *(
            Item(
                group=_BODY,
                what=f"{what}, part {letter}",
                specification=kind,
                quantity=1e-3 * mass,
                price=PRICES[what],
                mass=mass,
            )
            for letter, mass in parts
        ),
        Item(group=_BODY, what="skin", specification="knitted glove or sleeve", quantity=1.0, price=PRICES["skin"]),
        Item(
            group=_BODY,
            what="spray glue",
            specification="3M Super 77, between foam and skin",
            quantity=1.0,
            price=PRICES["glue"],
        ),
        _NEEDLES,
    ]


def _cables(
    given: ListInput, line: FishingLine, cuts: tuple[CableCut, ...], tubes: tuple[SheathCut, ...]
) -> list[Item]:
    length = sum(cut.cut for cut in cuts)
    tube = sum(cut.length for cut in tubes)
    ring = math.pi / 4 * (given.options.tube**2 - given.options.bore**2)
    return [
        Item(
            group=_CABLES,
            what="braided fishing line",
            specification=f"{line.name}, {line.diameter:g} mm",
            quantity=1e-3 * length,
            price=PRICES["line"],
            mass=POLYETHYLENE * math.pi / 4 * line.diameter**2 * length,
        ),
        Item(
            group=_CABLES,
            what="PTFE tube",
            specification=f"{given.options.bore:g} mm inside, {given.options.tube:g} mm outside",
            quantity=1e-3 * tube,
            price=PRICES["tube"],
            mass=PTFE * ring * tube,
        ),
    ]


def _motor_price(motor: Motor) -> Price:
    if motor.price_source.startswith(NO_SOURCE):
        return Price(amount=motor.price)
    return Price(amount=motor.price, source=f"the table of motors ({motor.price_source})", month="dated as told there")


def _winches(given: ListInput) -> list[Item]:
    count = given.units
    printed = sum(part.count * part.mass for part in given.printed)
    pieces = sum(part.count for part in given.printed)
    return [
        Item(
            group=_WINCHES,
            what="geared motor",
            specification=given.motor.title,
            quantity=float(count),
            price=_motor_price(given.motor),
            mass=count * given.motor.mass,
        ),
        *(
            Item(
                group=_WINCHES, what="screw or nut", specification=title, quantity=float(number), price=PRICES["screws"]
            )
            for title, number in given.screws.items()
            if title != given.motor.title
        ),
        Item(
            group=_WINCHES,
            what="PLA for printed parts",
            specification=f"{pieces} pieces, with a little infill",
            quantity=1e-3 * printed,
            price=PRICES["pla"],
            mass=printed,
        ),
    ]


def _control(given: ListInput) -> list[Item]:
    count = given.units
    supply = Item(
        group=_CONTROL,
        what="power supply",
        specification="of the motors' voltage, with current for those that pull at once",
        quantity=1.0 if count else 0.0,
        price=PRICES["supply"],
    )
    if given.motor.horn is not None:
        board = Item(
            group=_CONTROL,
            what="controller board for servos",
            specification="OpenRB-150 or alike, drives the servos by their bus",
            quantity=1.0 if count else 0.0,
            price=PRICES["servo board"],
        )
        return [board, supply]
    return [
        Item(
            group=_CONTROL,
            what="controller board",
            specification=f"Arduino Nano or alike, one for {_BOARD_MOTORS} motors",
            quantity=float(math.ceil(count / _BOARD_MOTORS)),
            price=PRICES["controller"],
        ),
        Item(
            group=_CONTROL,
            what="motor driver",
            specification="H-bridge for two motors, for their stall current, such as TB6612FNG for small ones",
            quantity=float(math.ceil(count / _DRIVER_MOTORS)),
            price=PRICES["driver"],
        ),
        supply,
    ]


def _mould(given: ListInput) -> list[Item]:
    printed = sum(part.count * part.mass for part in given.mould)
    foam = given.foam
    return [
        Item(
            group=_MOULD,
            what="silicone",
            specification=f"for moulds, Mold Max 30 or alike, both parts, {1e-6 * foam.silicone if foam else 0:.2f} l",
            quantity=1e-3 * foam.silicone_mass if foam else 0.0,
            price=PRICES["silicone"],
            mass=foam.silicone_mass if foam else None,
        ),
        Item(
            group=_MOULD,
            what="PLA for the mould",
            specification=f"{sum(part.count for part in given.mould)} pieces, with a little infill",
            quantity=1e-3 * printed,
            price=PRICES["pla"],
            mass=printed,
        ),
        *_closing(given),
        Item(
            group=_MOULD,
            what="release agent",
            specification="for polyurethane foam",
            quantity=1.0 if foam else 0.0,
            price=PRICES["release"],
        ),
    ]


def _closing(given: ListInput) -> list[Item]:
    """What joins, holds and seals the pieces of a mould."""
    silicone = given.foam is not None and given.foam.silicone_mass > 0
    return [
        Item(
            group=_MOULD,
            what="bolt M4 with nut",
            specification="and two washers, longer than the closed mould is thick; or threaded rod",
            quantity=float(given.bolts),
            price=PRICES["bolts"],
        ),
        Item(
            group=_MOULD,
            what="rod of 3 mm",
            specification=f"wood or steel, for {given.dowels} dowels of {DOWEL:g} mm",
            quantity=1e-3 * DOWEL * given.dowels,
            price=PRICES["rod"],
        ),
        Item(
            group=_MOULD,
            what="glue for plastic",
            specification="for pieces with dowels between them",
            quantity=1.0 if given.dowels else 0.0,
            price=PRICES["plastic glue"],
        ),
        Item(
            group=_MOULD,
            what="modelling clay",
            specification="without sulphur, seals the frames of the silicone",
            quantity=1.0 if silicone else 0.0,
            price=PRICES["clay"],
        ),
        Item(
            group=_MOULD,
            what="sealer",
            specification="shellac or acrylic varnish, two coats on the printed mould",
            quantity=1.0 if given.mould and not silicone else 0.0,
            price=PRICES["sealer"],
        ),
    ]
