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
    """Work of making the soft body: files, parts, and what is said of them.

    Attributes:
        files: content by path in the kit.
        printed: pieces of a mould.
        spare: what is printed only if the body is to be cast in another way.
        assemblies: of the mould.
        holes: pinholes in the cloth, each for a grommet.
        stitches: of each cable of a plush robot.
        gusset: whether a strip between front and back makes a plush body thick.
        cloth: of a plush robot.
        foam: of a robot of foam.
        mould: of a robot of foam, for the sheet.
        summary: what it is, a line each.
        problems: why it cannot be built well.
        warnings: what to mind.
        checks: that it is true to the simulation.
    """

    files: Mapping[str, bytes] = field(default_factory=dict)
    printed: tuple[Printed, ...] = ()
    spare: tuple[Printed, ...] = ()
    assemblies: tuple[PartAssembly, ...] = ()
    holes: int = 0
    stitches: tuple[CableStitches, ...] = ()
    gusset: bool = False
    cloth: Cloth | None = None
    foam: FoamNeeds | None = None
    mould: Mould | None = None
    summary: tuple[str, ...] = ()
    problems: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    checks: tuple[Check, ...] = ()
