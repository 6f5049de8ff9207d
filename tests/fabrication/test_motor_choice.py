"""The motor of a kit: the cheapest that fits, holds the poses for long, turns far enough and is not slow."""

import math
import re
from dataclasses import replace

import pytest
from builders import gallery_robot

from hydrostat.fabrication import KitOptions
from hydrostat.fabrication.lists.motors import SLOW_TRAVEL_TIME, power_plan
from hydrostat.fabrication.lists.needs import control_needs
from hydrostat.fabrication.motor_choice import MotorOffer, find_motor, fit_motor, motor_offers, motors_price
from hydrostat.fabrication.parts.motor import ALL_MOTORS, MARGIN, Motor
from hydrostat.robot import Robot

AUTO = KitOptions()


def offers_of(robot: Robot, torque: float) -> dict[str, MotorOffer]:
    """Offers for a torque on each winch [N m], by key."""
    return {offer.motor.key: offer for offer in motor_offers(robot, [torque] * len(robot.winches), AUTO)}


def offer(monkeypatch: pytest.MonkeyPatch, *motors: Motor) -> None:
    """Let the table hold these motors alone."""
    for name in ("ALL_MOTORS", "AUTO_MOTORS"):
        monkeypatch.setattr(f"hydrostat.fabrication.motor_choice.{name}", motors)


@pytest.mark.parametrize("torque", [0.01, 0.06, 0.19, 0.25, 0.29])
def test_auto_is_the_cheapest_that_does(torque: float) -> None:
    """Oracle: the rows of the table, each judged by hand from the catalog; outside the body all fit."""
    robot = gallery_robot("trunk")
    torques = [torque] * len(robot.winches)
    able = []
    for motor in ALL_MOTORS:
        share = 1e3 * torque / motor.stall_torque
        if MARGIN * 1e3 * torque > motor.rated_torque:
            continue
        turns = max(each.travel / (2 * math.pi * each.spool_radius) for each in robot.winches)
        if turns > motor.turns:
            continue
        if turns / (motor.speed / 60) * -math.log(1 - share) / share > SLOW_TRAVEL_TIME:
            continue
        items = control_needs(power_plan({each.name: 1e3 * torque for each in robot.winches}, motor))
        able.append((len(torques) * motor.price + sum(item.cost for item in items), motor.key))
    assert find_motor(robot, torques, AUTO).key == min(able)[1] != "xc330"
    offers = offers_of(robot, torque)
    assert {key for key, offer in offers.items() if not offer.problem} == {key for _, key in able}
    assert [offer.price for offer in offers.values()] == sorted(offer.price for offer in offers.values())
    assert offers[min(able)[1]].price == pytest.approx(min(able)[0])


def test_what_does_not_fit_is_not_taken() -> None:
    """The room of the starfish, 40 mm thick, is too small for servos of the size of STS3215 (one above the other)."""
    robot = gallery_robot("starfish")
    offers = offers_of(robot, 0.02)
    assert offers["sts3215"].problem == "has no room in the body"
    assert offers["sts3215"].price < offers["n20"].price
    assert find_motor(robot, [0.02] * 3, AUTO).key == "n20"
    assert find_motor(robot, [0.02] * 3, replace(AUTO, motor="sts3215")).key == "sts3215"


def test_in_the_body_motors_hold_for_seconds_if_none_holds_for_long() -> None:
    """Oracle: a quarter of the stall torque of the 25D is 0.343 N m; its continuous torque with the margin 0.17 N m."""
    robot = gallery_robot("starfish")
    assert find_motor(robot, [0.17] * 3, AUTO).key == "25d"
    assert find_motor(robot, [0.33] * 3, AUTO).key == "25d"


def test_a_shaft_that_turns_less_than_the_spool_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = gallery_robot("extended_hand")
    most = max(each.travel + each.release for each in robot.winches) / (2 * math.pi * 0.006)
    short = replace(Motor.choose("sts3215"), turns=0.99 * most)
    offer(monkeypatch, short, Motor.choose("xl330"))
    offers = offers_of(robot, 0.01)
    assert offers["sts3215"].problem == f"turns {360 * 0.99 * most:.0f} of {360 * most:.0f} degrees"
    assert find_motor(robot, [0.01] * 10, AUTO).key == "xl330"
    offer(monkeypatch, replace(short, turns=most), Motor.choose("xl330"))
    assert find_motor(robot, [0.01] * 10, AUTO).key == "sts3215"


def test_the_spool_radius_that_a_refusal_names_is_enough() -> None:
    """Oracle: the refusal itself, of the same robot with that radius."""
    robot, servo = gallery_robot("starfish"), Motor.choose("scs0009")
    (line, *_), _ = fit_motor(robot, AUTO, servo)
    named = re.search(r"at least ([\d.]+) mm, which takes 2\.4 times the torque", line)
    assert named, line
    wider = tuple(replace(winch, spool_radius=1e-3 * float(named[1])) for winch in robot.winches)
    problems, _ = fit_motor(robot.with_network(wider, robot.cables), AUTO, servo)
    assert not any("turns by" in problem for problem in problems)


def test_a_motor_beaten_in_everything_is_named() -> None:
    """Oracle: the 25D is dearer, slower, weaker and larger than the STS3215."""
    offers = offers_of(gallery_robot("trunk"), 0.1)
    assert offers["25d"].better == "sts3215"
    assert offers["sts3215"].better == ""
    assert motors_price([], Motor.choose("n20")) == 0.0


def test_what_auto_never_takes_says_so() -> None:
    """Oracle: what docs/fabrication.md says that auto never chooses, and what fails anyway."""
    offers = offers_of(gallery_robot("trunk"), 0.06)
    assert {key for key, offer in offers.items() if offer.remark.startswith("only by --motor")} == {"xc330", "st3020"}
    assert offers["scs0009"].remark == offers["scs0009"].problem != ""


def test_what_is_optional_is_not_priced() -> None:
    """Oracle: prices of the table, two winches of N20."""
    items = control_needs(power_plan({"one": 10.0, "two": 10.0}, Motor.choose("n20")))
    assert not [item.what for item in items if "optional" in item.specification]
