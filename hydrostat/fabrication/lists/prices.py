"""What things cost, roughly, and where that is from."""

from types import MappingProxyType

from hydrostat.fabrication.moulds.casting import SILICONE_PRICE
from hydrostat.fabrication.price import Price

_SHEET = 0.2286 * 0.3048
"""Of craft felt, 9 by 12 inches [m^2]."""

_BAG = 32 * 0.0283495
"""Of fibre filling, 32 oz [kg]."""

_ANGLER = 91.44
"""Line on a spool, 100 yards [m]."""

_PUPPETS = "a puppet maker's list of costs (The Tucson Puppet Lady)"
_BEARS = "a sewing group's list of costs (Crafting 4 Jesus)"

PRICES = MappingProxyType(
    {
        "felt": Price(
            amount=0.40 / _SHEET, unit="m^2", pack=_SHEET, source=f"{_PUPPETS}: craft felt, 0.40 a sheet of 9 by 12 in"
        ),
        "thread": Price(amount=3.0, unit="spool", source=f"{_PUPPETS}: all-purpose thread, 3 a spool"),
        "filling": Price(
            amount=5.99 / _BAG,
            unit="kg",
            pack=_BAG,
            month="2011-01",
            source=f"{_BEARS}: fibre filling, 5.99 for 32 oz",
        ),
        "zipper": Price(amount=2.0),
        "needle": Price(amount=5.0, unit="set"),
        "line": Price(
            amount=6.95 / _ANGLER,
            unit="m",
            pack=_ANGLER,
            month="2007-10",
            source="an angler's notes (Singlebarbed): braided Dyneema line, 6.95 for 100 yd",
        ),
        "tube": Price(amount=2.0, unit="m"),
        "controller": Price(
            amount=5.44, source="parts list of a drawing robot (RISE STEM kits): board like the Arduino Nano"
        ),
        "servo board": Price(
            amount=28.64,
            source="parts list of a gripper with two Dynamixel servos (force_gripper_hardware): OpenRB-150",
        ),
        "driver": Price(amount=5.0),
        "supply": Price(amount=10.0),
        "screws": Price(amount=0.08, pack=100.0, source="parts list of a printed robot hand: M3 screws, 8 for 100"),
        "pla": Price(
            amount=19.99, unit="kg", month="2023-05", source="parts list of SCUTTLE mini (D. Malawey): filament, 1 kg"
        ),
        "foam": Price(amount=40.0, unit="kg", pack=0.5),
        "silicone": Price(amount=SILICONE_PRICE, unit="kg"),
        "release": Price(amount=15.0, unit="can"),
        "glue": Price(amount=15.0, unit="can"),
        "sealer": Price(amount=8.0, unit="can"),
        "clay": Price(amount=8.0, unit="pack"),
        "plastic glue": Price(amount=5.0, unit="tube"),
        "bolts": Price(amount=0.25),
        "rod": Price(amount=1.0, unit="m", pack=0.3),
        "skin": Price(amount=8.0),
    }
)
"""By key; none is younger than its month says, and those without a source are guesses: ask your shop."""
