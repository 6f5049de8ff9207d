"""Whether printed parts are whole, fit together, and take in cable as the robot file says."""

from collections.abc import Iterable

from hydrostat.fabrication.self_check import Check
from hydrostat.fabrication.solids.assembly import LEAST, Assembly, interferences
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.fabrication.solids.sound import watertight_problems


def solid_checks(printed: Iterable[Printed], assemblies: Iterable[Assembly]) -> tuple[Check, ...]:
    """Every part watertight, by its edges as they are written; no two of an assembly in one place, by booleans."""
    printed, assemblies = tuple(printed), tuple(assemblies)
    faults = [fault for part in printed for fault in watertight_problems(part)]
    clashes = [
        f"{clash.one} and {clash.other} share {clash.volume:.2f} mm^3"
        for assembly in assemblies
        for clash in interferences(assembly)
    ]
    pieces = sum(len(assembly.pieces) for assembly in assemblies)
    return (
        Check(
            what=f"all {len(printed)} printed parts are watertight",
            measured="; ".join(faults) or "each edge joins two triangles",
            allowed="no hole",
            passed=not faults,
        ),
        Check(
            what=f"the {pieces} pieces of {len(assemblies)} assemblies do not overlap",
            measured="; ".join(clashes) or "nothing shared",
            allowed=f"a film of {1e3 * LEAST:g} micrometre",
            passed=not clashes,
        ),
    )


def too_large(printed: Iterable[Printed], bed: tuple[float, float, float]) -> tuple[str, ...]:
    """Why parts do not fit on the bed of the printer [mm], a line each; they may be turned on it, not tilted."""
    return tuple(
        f"{part.name} of {' x '.join(f'{side:.0f}' for side in part.size)} mm is more than the printer takes "
        f"({' x '.join(f'{side:.0f}' for side in bed)} mm): use a larger printer"
        for part in printed
        if any(side > most + 1e-6 for side, most in zip(_turned(part.size), _turned(bed), strict=True))
    )


def _turned(size: tuple[float, float, float]) -> tuple[float, float, float]:
    """Longer side first in the plane."""
    return max(size[:2]), min(size[:2]), size[2]
