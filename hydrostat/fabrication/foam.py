"""`foam_work`: what a body of foam takes: its mould, and what is poured into it (R50 to R54)."""

from collections.abc import Iterable

from hydrostat.fabrication.body_work import BodyWork
from hydrostat.fabrication.checks.channels import channel_problems
from hydrostat.fabrication.checks.mould_checks import mould_checks
from hydrostat.fabrication.kit_options import KitOptions
from hydrostat.fabrication.lists.list_input import FoamNeeds
from hydrostat.fabrication.moulds.mould import make_mould
from hydrostat.fabrication.moulds.mould_options import MouldKind
from hydrostat.fabrication.moulds.winch_room import WinchRoom
from hydrostat.fabrication.parts.winch_unit import WinchUnit
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Mount, Robot
from hydrostat.units import counted

MANY_PIECES = 40
"""More pieces of a mould than that are a warning: a judgement, each is some hours on a printer."""

MUCH_PLASTIC = 5e3
"""More plastic for a mould than that is a warning [g]: five of the usual spools, a judgement too."""


def foam_work(robot: Robot, options: KitOptions, units: Iterable[WinchUnit]) -> BodyWork:
    """The mould of a body, with room for the winches that sit in it.

    Raises:
        InputError: the body is not closed.
    """
    pockets = {unit.winch: WinchRoom(low=unit.low, high=unit.high) for unit in units if unit.mount is Mount.BODY}
    mould = make_mould(robot, options.mould, pockets=pockets)
    spare = tuple(
        part for part in mould.printed if part.name.startswith("positive") and mould.kind is MouldKind.PRINTED
    )
    printed = tuple(part for part in mould.printed if part not in spare)
    pieces, sides = sum(part.count for part in printed), " x ".join(f"{side:.0f}" for side in mould.box)
    body = mould.casting.body
    return BodyWork(
        printed=printed,
        spare=spare,
        assemblies=(mould.assembly,),
        foam=FoamNeeds(
            volume=body.volume,
            part_a=body.part_a,
            part_b=body.part_b,
            material=body.material,
            silicone=sum(mix.volume for mix in mould.casting.silicone),
            silicone_mass=sum(mix.mass for mix in mould.casting.silicone),
        ),
        mould=mould,
        summary=(
            f"Mould: {counted(pieces, 'piece')}, closed {sides} mm; {100 * mould.share:.1f} % of the skin is undercut",
            f"Pour: {body.mass:.0f} g of {body.material}",
        ),
        problems=(*mould.problems, *channel_problems(robot, options.parts)),
        warnings=(*mould.warnings, *_effort(printed)),
        checks=mould_checks(robot, mould),
    )


def _effort(printed: tuple[Printed, ...]) -> tuple[str, ...]:
    """A sentence if a mould takes more printing than a person has in mind."""
    pieces, mass = sum(part.count for part in printed), sum(part.count * part.mass for part in printed)
    if pieces <= MANY_PIECES and mass <= MUCH_PLASTIC:
        return ()
    return (
        f"the mould takes {counted(pieces, 'piece')} and {1e-3 * mass:.1f} kg of plastic: make the body smaller, use "
        "a printer with a larger bed, or cut the body out of a block of foam",
    )
