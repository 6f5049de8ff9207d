"""`ListInput`: all that the lists are made of."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from hydrostat.errors import InputError
from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.kit_options import Method, PartOptions
from hydrostat.fabrication.lists.line import FishingLine
from hydrostat.fabrication.parts.motor import Motor
from hydrostat.fabrication.patterns.stitches import CableStitches
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Robot


@dataclass(frozen=True, kw_only=True)
class Cloth:
    """Cloth that the pattern of a plush robot takes."""

    felt: float  # of all panels [mm^2]
    seam: float  # length of all seams [mm]
    zipper: float = 0.0  # length of the opening [mm]; 0 for none


@dataclass(frozen=True, kw_only=True)
class FoamNeeds:
    """Foam and silicone that casting the body takes."""

    volume: float  # of the cavity [mm^3]
    part_a: float  # of the foam [g]
    part_b: float  # of the foam [g]
    silicone: float = 0.0  # for the mould [mm^3]; 0 for a printed one
    silicone_mass: float = 0.0  # [g]
    material: str = ""  # name of the foam; empty: that of the robot's body


@dataclass(frozen=True, eq=False, kw_only=True)
class ListInput:
    """Facts that the lists are made of; lengths in millimetres, cables by their index."""

    robot: Robot  # that is built
    demand: Demand  # what its poses ask for
    motor: Motor  # of all its winches
    method: Method = Method.PLUSH  # how the body is made
    options: PartOptions = field(default_factory=PartOptions)  # of the printed parts: line, tube and spare wraps
    printed: tuple[Printed, ...] = ()  # the parts for all winches, stoppers, and the base
    mould: tuple[Printed, ...] = ()  # printed pieces of the mould, or the positive for a silicone one
    bolts: int = 0  # how many M4 bolts hold the mould, each with a nut
    dowels: int = 0  # how many of 3 mm join pieces of the mould
    # how many of each kind, nuts too, by what they are called; motors among them are not counted twice
    screws: Mapping[str, int] = field(default_factory=dict)
    leads: Mapping[int, float] = field(default_factory=dict)  # from each winch's exit to its spool [mm]
    seats: Mapping[int, float] = field(default_factory=dict)  # depth of the seat of the tube at each winch [mm]
    # tube from the base with the motors to where each cable begins [mm]
    outside: Mapping[int, float] = field(default_factory=dict)
    stitches: tuple[CableStitches, ...] = ()  # of each cable of a plush robot
    cloth: Cloth | None = None  # of a plush robot
    foam: FoamNeeds | None = None  # of a robot of foam
    line: FishingLine | None = None  # what the cables are made of; None: the strongest as thick as the options say
    stopper_hold: float | None = None  # tension at which a cable begins to slip in its stopper [N]; None: not known

    def __post_init__(self) -> None:
        for name in ("leads", "seats", "outside"):
            for index, length in getattr(self, name).items():
                if not 0 <= index < len(self.robot.cables):
                    raise InputError(f"{name}[{index}]: the robot has {len(self.robot.cables)} cables, counted from 0")
                if not length >= 0:
                    raise InputError(f"{name}[{index}] must not be negative, not {length:g} mm")
        for name in ("bolts", "dowels"):
            if getattr(self, name) < 0:
                raise InputError(f"{name} must not be negative, not {getattr(self, name)}")

    @property
    def units(self) -> int:
        """Winches that have cables: only these are built, and get a motor."""
        return len({cable.winch for cable in self.robot.cables})
