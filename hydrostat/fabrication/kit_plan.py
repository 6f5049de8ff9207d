"""`KitPlan`: all that the lists, the sheet and the files of a kit are made of."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from hydrostat.errors import InputError
from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.inserts import Insert, find_inserts
from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.kit_options import KitOptions, Method
from hydrostat.fabrication.moulds.mould import Mold
from hydrostat.fabrication.parts.rigid_parts import RigidParts
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.stitches import CableStitches
from hydrostat.fabrication.solids.assembly import PartAssembly
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Robot
from hydrostat.units import plural


@dataclass(frozen=True, kw_only=True)
class Cloth:
    """Cloth that the pattern of a plush robot takes."""

    felt: float  # area of all panels [mm^2]
    seam: float  # length of all seams [mm]
    zipper: float = 0.0  # length of the opening [mm]; 0 for none
    panels: tuple[tuple[float, float], ...] = ()  # width and height of each panel [mm]


@dataclass(frozen=True, kw_only=True)
class FoamNeeds:
    """Foam, silicone and hardware that casting the body takes (InputError: a count below 0)."""

    volume: float  # volume of the cavity [mm^3]
    part_a: float  # mass of part A of the foam [g]
    part_b: float  # mass of part B of the foam [g]
    silicone: float = 0.0  # for the mold [mm^3]; 0 for a printed one
    silicone_mass: float = 0.0  # [g]
    material: str = ""  # name of the foam; empty: that of the robot's body
    bolts: int = 0  # number of M4 bolts that hold the mold, each with a nut
    dowels: int = 0  # number of dowels of 3 mm that join pieces of the mold

    def __post_init__(self) -> None:
        for name in ("bolts", "dowels"):
            if getattr(self, name) < 0:
                raise InputError(f"{name} must not be negative, not {getattr(self, name)}")


@dataclass(frozen=True, eq=False, kw_only=True)
class BodyWork:
    """Results of planning the soft body: of felt its pattern (R10), of foam its mold and mixes (R50 to R54)."""

    files: Mapping[str, bytes] = field(default_factory=dict)  # content by path in the kit
    printed: tuple[Printed, ...] = ()  # pieces of a mold, or the positive for a silicone one
    spare: tuple[Printed, ...] = ()  # pieces that are printed only if the body is to be cast in another way
    assemblies: tuple[PartAssembly, ...] = ()  # assemblies of the mold
    holes: int = 0  # pinholes in the cloth, each for a grommet
    pattern: Pattern | None = None  # pattern of a plush robot
    stitches: tuple[CableStitches, ...] = ()  # stitches of each cable of a plush robot
    gusset: bool = False  # True if strips between front and back make a plush body thick
    cloth: Cloth | None = None  # cloth of a plush robot
    foam: FoamNeeds | None = None  # foam of a foam robot
    mould: Mold | None = None  # mold of a foam robot
    summary: tuple[str, ...] = ()  # a line for each result
    problems: tuple[str, ...] = ()  # why it cannot be built well
    warnings: tuple[str, ...] = ()  # sentences on what may fail later
    notes: tuple[str, ...] = ()  # information for the builder
    checks: tuple[Check, ...] = ()  # comparisons with the simulation


@dataclass(frozen=True, eq=False, kw_only=True)
class KitPlan:
    """A robot with the parts and the body that it is built from; lengths in millimeters, cables by their index.

    Raises:
        InputError: a length of a cable that the robot does not have, or one below 0.
    """

    drawn: Robot  # robot as it was given
    robot: Robot  # robot as it is built: both cables of each pair
    options: KitOptions  # choices of the kit
    demand: Demand  # loads of its poses
    rigid: RigidParts  # winches, base, seat, stoppers
    work: BodyWork  # work on its soft body

    def __post_init__(self) -> None:
        for name in ("leads", "seats", "outside"):
            for index, length in getattr(self.rigid, name).items():
                if not 0 <= index < len(self.robot.cables):
                    raise InputError(f"{name}[{index}]: the robot has {len(self.robot.cables)} cables, counted from 0")
                if not length >= 0:
                    raise InputError(f"{name}[{index}] must not be negative, not {length:g} mm")

    @property
    def method(self) -> Method:
        """Method by which the body is made."""
        return self.options.method_for(self.drawn.body)

    @property
    def is_silicone(self) -> bool:
        """True if the body is cast of silicone, which does not expand as foam does."""
        return self.work.mould is not None and self.work.mould.casting.expansion <= 1

    @property
    def cast_material(self) -> str:
        """Word for the casting material of the body."""
        return "silicone" if self.is_silicone else "foam"

    @cached_property
    def printed(self) -> tuple[Printed, ...]:
        """All pieces for a 3D printer."""
        return (*self.rigid.printed, *self.work.printed)

    @property
    def pieces(self) -> str:
        """Number of printed pieces in words, such as "24 pieces, and 118 optional grommets"."""
        optional = self.rigid.grommet.count if self.rigid.grommet is not None else 0
        needed = plural(sum(part.count for part in self.printed) - optional, "piece")
        return needed + (f", and {plural(optional, 'optional grommet')}" if optional else "")

    @property
    def print_hours(self) -> float:
        """Hours for which one printer is busy with all parts, about.

        Assumed: a third of their volume is plastic, the rest the air of the infill, and 15 cm^3 are laid an hour.
        """
        return sum(part.count * part.volume for part in self.printed) / 3 / 15e3

    @cached_property
    def inserts(self) -> tuple[Insert, ...]:
        """Parts and rods that are put into the body."""
        return find_inserts(self.drawn)

    @property
    def num_motors(self) -> int:
        """Number of winches that have cables: only these are built, and get a motor."""
        return len({cable.winch for cable in self.robot.cables})

    @property
    def panels(self) -> tuple[str, ...]:
        """Panels of a flat plush robot that cables are sewn on, by their names."""
        return tuple(dict.fromkeys(sewn.panel for sewn in self.work.stitches))

    @property
    def pairs(self) -> int:
        """Number of cables that have a twin on the other panel; 0 where cables are sewn on one alone."""
        return len(self.robot.cables) // 2 if len(self.panels) > 1 else 0


@dataclass(frozen=True, kw_only=True)
class KitFindings:
    """Results of the checks of a kit."""

    checks: tuple[Check, ...] = ()  # checks of the kit on itself
    problems: tuple[str, ...] = ()  # why the robot cannot be built well, each once
    warnings: tuple[str, ...] = ()  # sentences on what may fail later
    notes: tuple[str, ...] = ()  # information for the builder
