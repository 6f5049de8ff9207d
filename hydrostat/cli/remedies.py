"""Commands that fix what prevents a kit."""

import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

from hydrostat.cli.design_results import alternative_folder

if TYPE_CHECKING:
    from hydrostat.design import Network
    from hydrostat.fabrication import KitOptions
    from hydrostat.robot import Robot

_SILICONE = "mould of silicone"  # in reasons that a mold of silicone does not have


def kit_remedy(robot: "Robot", folder: Path, out: Path, *, options: "KitOptions", reasons: Iterable[str]) -> str:
    """Command that makes a rejected kit buildable: another motor, a mold of silicone, a seam, or a new design.

    It is `hydrostat materials` if the material is a cause, and `hydrostat check` if no kit can be made of the body
    itself.
    """
    from hydrostat.fabrication import ALL_MOTORS, MATERIAL_FIX, OVER_BUDGET, Method, find_refusals

    place, kit = quote(str(folder)), quote(str(out))
    told = list(reasons)
    if options.method_for(robot.body) is Method.FOAM and all(_SILICONE in reason for reason in told):
        return f"hydrostat fabricate {place} --mould silicone --out {kit}"
    if any(MATERIAL_FIX in reason for reason in told):
        return f"hydrostat materials, then edit material in {place}"
    if found := next((reason for reason in told if OVER_BUDGET in reason), ""):
        budget, fewer = f"--budget {options.budget:g}USD", max(len(robot.winches) - 1, 1)
        if motor := re.search(r"--motor (\S+)", found):
            return f"hydrostat fabricate {place} --motor {motor[1]} {budget} --out {kit}"
        return f"hydrostat design {place} --winches {fewer} {budget} --out {quote(f'{out}_design')}"
    known = set(find_refusals(robot, options=options))
    for motor in ("auto", *(each.key for each in ALL_MOTORS)) if known and known >= set(told) else ():
        if motor != options.motor and not find_refusals(robot, options=replace(options, motor=motor)):
            return f"hydrostat fabricate {place} --motor {motor} --out {kit}"
    if told and set(body_refusals(robot)) >= set(told):
        for seam in (6, 5, 4, 3):
            narrow = replace(options, pattern=replace(options.pattern, seam_allowance=float(seam)))
            if seam < options.pattern.seam_allowance and not find_refusals(robot, options=narrow):
                return f"hydrostat fabricate {place} --seam {seam}mm --out {kit}"
        return f"hydrostat check {place}"
    winches, cables = max(len(robot.winches), 1), max(len(robot.cables), 1)
    return f"hydrostat design {place} --winches {winches} --cables {cables} --out {quote(f'{out}_design')}"


def design_remedy(network: "Network", source: Path, out: Path) -> str:
    """Command to continue with if the kit of a design would be rejected: an alternative, or fewer winches.

    It is `hydrostat check` if no kit can be made of the body itself.
    """
    from hydrostat.design import kit_fits

    if body_refusals(network.source):
        return f"hydrostat check {quote(str(source))}"
    for number, other in enumerate(network.alternatives, start=1):
        if kit_fits(other):
            place = alternative_folder(out, number, other.robot)
            return f"hydrostat fabricate {quote(str(place))} --out {quote(str(out / 'kit'))}"
    winches, cables = len(network.robot.winches), len(network.robot.cables)
    fewer = f"--winches {max(winches - 1, 1)} --cables {max(cables - 1, 1)}"
    return f"hydrostat design {quote(str(source))} {fewer} --out {quote(str(out))}"


def body_refusals(robot: "Robot") -> tuple[str, ...]:
    """Reasons why no kit can be made of a body, whatever its winches and cables are."""
    from hydrostat.fabrication import find_refusals

    return find_refusals(robot.with_network((), ()))


def kit_warnings(robot: "Robot") -> tuple[str, ...]:
    """Reasons why no kit can be made of a new robot: those of its body, or one sentence on the room for a motor."""
    from hydrostat.errors import NO_KIT
    from hydrostat.fabrication import find_refusals

    reasons = find_refusals(robot)
    if reasons and not body_refusals(robot):
        from hydrostat.design import find_no_room

        if words := find_no_room(robot):
            return (words,)
    return tuple(NO_KIT + reason for reason in reasons)
