"""Commands that fix what prevents a kit."""

import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

from hydrostat.cli.design_results import alternative_folder, find_over_budget, kit_options

if TYPE_CHECKING:
    from hydrostat.design import Network
    from hydrostat.fabrication import KitOptions
    from hydrostat.robot import Robot

_MAX_SHORT_SEARCH = 600.0  # longest search that its time limit ended and that more time may help [s]: assumed
_SILICONE = "mold of silicone"  # in reasons that a mold of silicone does not have
_PRINT = "(--mould printed)"  # in reasons that a printed mold does not have


def kit_remedy(robot: "Robot", folder: Path, out: Path, *, options: "KitOptions", reasons: Iterable[str]) -> str:
    """Command that makes a rejected kit buildable: another motor, another mold, a seam, or a new design.

    It is `hydrostat materials` if the material is a cause, `hydrostat check` if no kit can be made of the body itself,
    and empty where no design has room for a motor either.
    """
    from hydrostat.design import find_no_room
    from hydrostat.fabrication import ALL_MOTORS, MATERIAL_FIX, OVER_BUDGET, Method, find_refusals

    place, kit = quote(str(folder)), quote(str(out))
    told = list(reasons)
    if mold := _other_mold(told, foam=options.method_for(robot.body) is Method.FOAM):
        return f"hydrostat fabricate {place} --mould {mold} --out {kit}"
    if any(MATERIAL_FIX in reason for reason in told):
        return f"hydrostat materials, then edit material in {place}"
    if found := next((reason for reason in told if OVER_BUDGET in reason), ""):
        return _cheaper(robot, found, options.budget or 0.0, place, out)
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
    if any("smaller motor" in reason for reason in told) and find_no_room(robot):
        return ""
    winches, cables = max(len(robot.winches), 1), max(len(robot.cables), 1)
    return f"hydrostat design {place} --winches {winches} --cables {cables} --out {quote(f'{out}_design')}"


def _other_mold(reasons: list[str], *, foam: bool) -> str:
    """Kind of mold that all reasons ask for; empty if there is none."""
    if reasons and all(_PRINT in reason for reason in reasons):
        return "printed"
    return "silicone" if foam and all(_SILICONE in reason for reason in reasons) else ""


def note_room(robot: "Robot", place: str, *, options: "KitOptions", reasons: Iterable[str]) -> str:
    """Note how large the body has to be for its motors, or for any motor, if units have no room; else empty."""
    from hydrostat.fabrication import ALL_MOTORS, Motor, fit_motor
    from hydrostat.robot import scaled_robot

    if not any("smaller motor" in reason for reason in reasons):
        return ""
    key = options.motor_for(robot)
    motors = ALL_MOTORS if key == "auto" else (Motor.choose(key),)
    for factor in (1.0, 1.25, 1.5, 2.0, 2.5, 3.0):
        larger = scaled_robot(robot, factor)
        if found := [motor.key for motor in motors if not fit_motor(larger, options, motor)[0]]:
            words = f"a body {factor:g} times as large has room for {', '.join(found)}"
            scale = f"hydrostat scale {place} {factor:g}, then fabricate the larger robot"
            return "" if factor == 1.0 else f"note: {words}: {scale}"
    from hydrostat.design import find_no_room

    return f"note: {find_no_room(robot) or 'a body 3 times as large has no room for these motors there either'}"


def _cheaper(robot: "Robot", reason: str, budget: float, place: str, out: Path) -> str:
    """Command that brings a kit within its budget [USD]: another motor, fewer winches, or else the budget it needs."""
    known = {word: int(number) for word, number in re.findall(r"(costs|about|winches) (\d+)", reason)}
    price, least, winches = known["costs"], known.get("about", known["costs"]), max(len(robot.winches), 1)
    motor = "".join(re.findall(r"--motor \S+ ", reason))
    each = known.get("winches", 0) / winches
    fit = next((number for number in range(winches - 1, 0, -1) if price - each * (winches - number) <= budget), 0)
    if least > budget and fit:
        return (
            f"hydrostat design {place} --winches {fit} --two-way --budget {budget:g}USD --out {quote(f'{out}_design')}"
        )
    spend = f"{budget:g}" if least <= budget else f"{least + 1}"  # prices in reasons are rounded
    return f"hydrostat fabricate {place} {motor}--budget {spend}USD --out {quote(str(out))}"


def design_remedy(
    network: "Network", source: Path, out: Path, *, budget: float | None = None, over: Iterable[str] = ()
) -> str:
    """Command to continue with if the kit of a design would be rejected: an alternative, more time, or fewer winches.

    All keep to the budget [USD], for which `over` are the problems. It is `hydrostat check` if no kit can be made of
    the body itself, or if fewer winches were what was asked for or what was found and rejected. More time is advised if
    a limit of at most 10 min ended the search.
    """
    from hydrostat.design import kit_fits

    if body_refusals(network.source):
        return f"hydrostat check {quote(str(source))}"
    spend = "" if budget is None else f" --budget {budget:g}USD"
    for number, other in enumerate(network.alternatives, start=1):
        if kit_fits(other) and not find_over_budget(replace(network, robot=other.robot), budget):
            place = alternative_folder(out, number, other.robot)
            return f"hydrostat fabricate {quote(str(place))}{spend} --out {quote(str(out / 'kit'))}"
    if reasons := tuple(over):
        options = kit_options(network, budget)
        return kit_remedy(network.robot, out / "robot", out / "kit", options=options, reasons=reasons)
    asked = network.request
    if not network.complete and asked.seconds is not None and asked.seconds <= _MAX_SHORT_SEARCH:
        count = f"--winches {asked.winches} --cables {asked.cables} --time {4 * asked.seconds:g}s"
        return f"hydrostat design {quote(str(source))} {count}{spend} --out {quote(str(out))}"
    found = len(network.robot.winches), len(network.robot.cables)
    winches, cables = (max(number - 1, 1) for number in found)
    if (winches, cables) in (found, (network.request.winches, network.request.cables)):
        return f"hydrostat check {quote(str(out / 'robot'))}"
    return f"hydrostat design {quote(str(source))} --winches {winches} --cables {cables}{spend} --out {quote(str(out))}"


def body_refusals(robot: "Robot") -> tuple[str, ...]:
    """Reasons why no kit can be made of a body, whatever its winches and cables are."""
    from hydrostat.fabrication import find_refusals

    return find_refusals(robot.with_network((), ()))


def kit_warnings(robot: "Robot") -> tuple[str, ...]:
    """Reasons why no kit can be made of a new robot: those of its body, or one sentence on the room for a motor."""
    from hydrostat.errors import NO_KIT
    from hydrostat.fabrication import find_refusals

    reasons = find_refusals(robot)
    if (reasons or not robot.cables) and not body_refusals(robot):
        from hydrostat.design import find_no_room

        if words := find_no_room(robot):
            return (words,)
    return tuple(NO_KIT + reason for reason in reasons)
