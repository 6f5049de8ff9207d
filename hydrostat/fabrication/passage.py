"""`find_stuck_units`: winch units that do not pass through the zipper, and the seam to leave open for them."""

import math
from collections.abc import Sequence

from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.parts.winch_unit import WinchUnit
from hydrostat.fabrication.patches.space_pattern import SpacePattern
from hydrostat.fabrication.patterns.shape import Circle, PatternPart
from hydrostat.fabrication.winch_marks import winch_marks_of
from hydrostat.robot import Mount


def find_stuck_units(plan: KitPlan) -> tuple[WinchUnit, ...]:
    """Units in the body that do not pass through its zipper, the largest first."""
    return _find_stuck(plan.rigid.units, _slit(plan))


def find_stuck_marks(plan: KitPlan) -> tuple[str, ...]:
    """Marks of the winches that do not pass through the zipper, in their order."""
    stuck = {unit.winch for unit in find_stuck_units(plan)}
    return tuple(mark for name, mark in winch_marks_of(plan.robot).items() if name in stuck)


def find_open_seam(plan: KitPlan) -> int:
    """Length of seam to leave open for the winches [mm]; 0 if all pass through the zipper."""
    stuck = find_stuck_units(plan)
    return _seam_for(stuck[0]) if stuck else 0


def find_passage_warnings(plan: KitPlan) -> tuple[str, ...]:
    """Warn of a zipper that is too short for a winch, or missing."""
    return tuple(_warning(unit, _slit(plan)) for unit in find_stuck_units(plan)[:1])


def find_passage_problems(plan: KitPlan) -> tuple[str, ...]:
    """Return a problem if no seam is long enough for the largest winch that does not pass through the zipper."""
    stuck = find_stuck_units(plan)[:1]
    longest = max(_seam_lengths(plan), default=math.inf)
    return tuple(
        f'seam: the unit of winch "{unit.winch}" does not pass through the longest seam ({longest:.0f} mm, minimum '
        f"{_slit_for(unit):.0f} mm). Choose a smaller motor or spool"
        for unit in stuck
        if longest < _slit_for(unit)
    )


def _seam_lengths(plan: KitPlan) -> list[float]:
    """Length of each seam: between two patches, or round a flat panel [mm]."""
    pattern = plan.work.pattern
    if isinstance(pattern, SpacePattern):
        return [seam.length for seam in pattern.seams]
    shapes = [shape for panel in pattern.panels for shape in panel.shapes] if pattern else []
    return [
        shape.geometry.length for shape in shapes if shape.part is PatternPart.SEAM and not isinstance(shape, Circle)
    ]


def _slit(plan: KitPlan) -> float:
    """Length of the slit of the zipper [mm]; 0 without a zipper, infinite where nothing is sewn."""
    if plan.work.pattern is None:
        return math.inf
    opening = plan.work.pattern.opening
    return 0.0 if opening is None else float(opening.slit.length)


def _find_stuck(units: Sequence[WinchUnit], slit: float) -> tuple[WinchUnit, ...]:
    stuck = [unit for unit in units if unit.mount is Mount.BODY and _slit_for(unit) > slit]
    return tuple(sorted(stuck, key=_slit_for, reverse=True))


def _slit_for(unit: WinchUnit) -> float:
    """Length of the shortest slit that a unit passes [mm]: a slit opens to a ring of twice its length."""
    return float(sum(sorted(unit.room.size)[:2]))


def _seam_for(unit: WinchUnit) -> int:
    """Length of seam that a unit passes, with a tenth to spare, in full tens [mm]."""
    return 10 * math.ceil(1.1 * _slit_for(unit) / 10)


def _warning(unit: WinchUnit, slit: float) -> str:
    sides = " x ".join(f"{side:.0f}" for side in sorted(unit.room.size))
    fails = f"does not pass through its opening of {int(slit)} mm" if slit else "has no zipper to pass through"
    return (
        f'zipper: the unit of winch "{unit.winch}" ({sides} mm) {fails} (minimum {_slit_for(unit):.0f} mm). '
        f"Leave {_seam_for(unit)} mm of seam open, and close it by hand. To reach the motor later, undo this seam. "
        "If no seam near it is so long, choose a smaller motor or spool"
    )
