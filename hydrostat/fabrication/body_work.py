"""`BodyWork`: what making the soft body takes, by either method."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from hydrostat.fabrication.lists.list_input import Cloth, FoamNeeds
from hydrostat.fabrication.moulds.mould import Mould
from hydrostat.fabrication.patterns.stitches import CableStitches
from hydrostat.fabrication.self_check import Check
from hydrostat.fabrication.solids.assembly import PartAssembly
from hydrostat.fabrication.solids.printed import Printed


@dataclass(frozen=True, eq=False, kw_only=True)
class BodyWork:
    """Work of making the soft body: files, parts, and what is said of them."""

    files: Mapping[str, bytes] = field(default_factory=dict)  # content by path in the kit
    printed: tuple[Printed, ...] = ()  # pieces of a mould
    spare: tuple[Printed, ...] = ()  # what is printed only if the body is to be cast in another way
    assemblies: tuple[PartAssembly, ...] = ()  # of the mould
    holes: int = 0  # pinholes in the cloth, each for a grommet
    stitches: tuple[CableStitches, ...] = ()  # of each cable of a plush robot
    gusset: bool = False  # whether a strip between front and back makes a plush body thick
    cloth: Cloth | None = None  # of a plush robot
    foam: FoamNeeds | None = None  # of a robot of foam
    mould: Mould | None = None  # of a robot of foam, for the sheet
    summary: tuple[str, ...] = ()  # what it is, a line each
    problems: tuple[str, ...] = ()  # why it cannot be built well
    warnings: tuple[str, ...] = ()  # what to mind
    checks: tuple[Check, ...] = ()  # that it is true to the simulation
