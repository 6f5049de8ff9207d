"""The bill: what is counted, weighed and paid."""

import math
from dataclasses import replace

import pytest
from kit_plans import change_plan
from small_inputs import box, given, square

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_plan import Cloth, FoamNeeds, KitPlan
from hydrostat.fabrication.lists.bill import NO_SOURCE, PRICES, BillGroup, Item, Price, bill_table, cost_of
from hydrostat.fabrication.lists.cuts import cable_cuts, sheath_cuts
from hydrostat.fabrication.lists.line import line_for
from hydrostat.fabrication.lists.motors import power_plan
from hydrostat.fabrication.lists.needs import all_needs, filling_mass
from hydrostat.fabrication.lists.searches import SEARCHES, search_term
from hydrostat.fabrication.parts.motor import ALL_MOTORS, MOTORS, Motor
from hydrostat.fabrication.solids.construct import Box, solid_of
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Winch

CUBE = Printed(name="cube", title="Cube", solid=solid_of(Box((10.0, 10.0, 10.0))), count=3)
CUBES = 3 * 1.24e-3 * (1.2 * 600 + 0.15 * (1000 - 1.2 * 600))
"""Mass of the three [g]: a shell of 1.2 mm under 600 mm^2, 15 % of the rest."""


def needs(this: KitPlan) -> dict[str, Item]:
    cuts = cable_cuts(this.robot, leads={}, outside=this.rigid.outside, spare_wraps=2.0, tail=80.0)
    tubes = sheath_cuts(this.robot, seats={}, outside=this.rigid.outside)
    power = power_plan({cable.winch: 10.0 for cable in this.robot.cables}, this.rigid.motor)
    return {item.what: item for item in all_needs(this, line_for(0.4), cuts, tubes, power)}


def test_totals_of_groups_and_of_all() -> None:
    price = Price(amount=2.0, unit="m", pack=5.0)
    items = (
        Item(group=BillGroup.BODY, what="x", specification="", quantity=1.5, price=price, mass=4.0),
        Item(group=BillGroup.BODY, what="y", specification="", quantity=2.0, price=price),
        Item(group=BillGroup.MOULD, what="z", specification="", quantity=6.0, price=price, mass=1.0),
    )
    table = bill_table(items)
    assert tuple(row.cost_used for row in table.rows) == pytest.approx((3.0, 4.0, 7.0, 12.0, 12.0, 19.0))
    assert tuple(row.cost_packs for row in table.rows) == pytest.approx((10.0, 10.0, 20.0, 20.0, 20.0, 40.0))
    assert tuple(row.mass for row in table.rows) == (4.0, None, 4.0, 1.0, 1.0, 5.0)
    assert cost_of(items) == 19.0
    assert [row.is_total for row in table.rows] == [False, False, True, False, True, True]
    assert cost_of(items, BillGroup.BODY) == 7.0


def test_currencies_are_not_added() -> None:
    price = Price(amount=2.0, currency="EUR")
    with pytest.raises(InputError, match="the price of x must be in USD, not EUR"):
        bill_table((Item(group=BillGroup.BODY, what="x", specification="", quantity=1.0, price=price),))


def test_a_full_pack_is_one_pack() -> None:
    price = Price(amount=1.0, pack=0.1)
    assert [price.packs(quantity) for quantity in (0.1, 0.3, 0.31)] == [1, 3, 4]
    with pytest.raises(InputError, match="pack must be above 0"):
        Price(amount=1.0, pack=0.0)


def test_filling_is_volume_times_density() -> None:
    robot = square()
    assert filling_mass(given(robot)) == pytest.approx(100 * 100 * 30 * 1e-6 * robot.body.material.density)
    assert filling_mass(given(box((-0.05, 0.08, 0.08), (0.1, 0.08, 0.08)))) == pytest.approx(0.2 * 0.16**2 * 40 * 1e3)


def test_a_plush_robot() -> None:
    found = needs(
        given(
            square(),
            cloth=Cloth(felt=2e5, seam=1e3, zipper=96.0),
            printed=(CUBE,),
            screws={"M2 x 6": 4},
        )
    )
    assert found["felt"].quantity == pytest.approx(0.2)
    assert found["all-purpose thread"].quantity == 1
    assert "100 mm" in found["zipper"].specification
    assert found["PLA for printed parts"].mass == pytest.approx(CUBES)
    assert found["screw or nut"].quantity == 4
    assert found["geared motor"].cost == 20.0
    assert not {"silicone", "skin", "release agent", "PTFE tube"} & set(found)
    assert found["braided fishing line"].mass == pytest.approx(0.97e-3 * math.pi / 4 * 0.405**2 * 360)


def test_boards_and_drivers_for_many_motors() -> None:
    assert needs(given(square()))["motor driver"].quantity == 1
    servo = needs(given(square(), motor=next(motor for motor in MOTORS if motor.horn is not None)))
    assert "motor driver" not in servo
    assert servo["controller board for servos"].quantity == 1


def test_a_winch_without_cables_buys_nothing() -> None:
    """Oracle: two winches, one of them with a cable."""
    robot = square()
    idle = replace(robot, winches=(*robot.winches, Winch(name="idle", at=(0.0, 0.0))))
    assert idle.cables
    for this in (robot, idle):
        found = needs(change_plan(given(robot), robot=this))
        assert found["geared motor"].quantity == 1
        assert found["motor driver"].quantity == 1
    none = needs(change_plan(given(robot), robot=replace(robot, cables=())))
    assert not {"geared motor", "controller board", "power supply"} & set(none)


def test_what_closes_a_mould() -> None:
    """Oracle: what is asked for, and nothing of it else."""
    robot = box((-0.05, 0.08, 0.08), (0.1, 0.08, 0.08))
    foam = FoamNeeds(volume=4e5, part_a=32.0, part_b=32.0)
    plain = needs(given(robot, foam=foam, pieces=(CUBE,)))
    assert not {"bolt M4 with nut", "rod of 3 mm", "glue for plastic", "modeling clay"} & set(plain)
    assert plain["sealer"].quantity == 1
    cut = needs(given(robot, foam=replace(foam, bolts=8, dowels=6), pieces=(CUBE,)))
    assert cut["bolt M4 with nut"].quantity == 8
    assert cut["rod of 3 mm"].quantity == pytest.approx(6 * 0.015)
    assert "6 dowels" in cut["rod of 3 mm"].specification
    assert cut["glue for plastic"].quantity == 1
    silicone = needs(given(robot, foam=replace(foam, silicone=1e6, silicone_mass=1180.0, dowels=2), pieces=(CUBE,)))
    assert "modeling clay" in silicone
    assert "sealer" not in silicone
    with pytest.raises(InputError, match="bolts must not be negative, not -1"):
        replace(foam, bolts=-1)


def test_motors_keep_the_source_of_their_price() -> None:
    for motor in ALL_MOTORS:
        price = needs(given(square(), motor=motor))["geared motor"].price
        assert price.amount == motor.price
        assert motor.price_source in price.words
        assert motor.price_month in price.words
        assert motor.title in needs(given(square(), motor=motor))["geared motor"].specification


def test_a_robot_without_a_zipper_buys_none() -> None:
    assert "zipper" not in needs(given(square(), cloth=Cloth(felt=1e5, seam=1e3)))


def test_a_hand_of_foam_costs_what_the_thesis_paid() -> None:
    robot = box((-0.05, 0.08, 0.08), (0.1, 0.08, 0.08))
    hand = FoamNeeds(volume=4e5, part_a=32.0, part_b=32.0, silicone=3e6, silicone_mass=3540.0)  # 0.4 l at 0.16 g/ml
    items = needs(given(robot, foam=hand)).values()
    core = sum(item.cost for item in items if item.what.startswith("foam"))
    assert 1 < core < 5  # "a few dollars each" (N2)
    assert 50 < cost_of(items, BillGroup.MOULD) < 200  # "about 100 USD" (N2)


def test_the_foam_that_is_poured_may_be_another_than_was_simulated() -> None:
    robot = box((-0.05, 0.08, 0.08), (0.1, 0.08, 0.08))
    foam = FoamNeeds(volume=4e5, part_a=30.0, part_b=35.0, material="flexfoam-it x")
    found = needs(given(robot, foam=foam))
    assert found["foam, part A"].specification == "flexfoam-it x"
    assert (found["foam, part A"].mass, found["foam, part B"].mass) == (30.0, 35.0)
    assert "polyurethane" in found["release agent"].specification
    cast = needs(given(robot, foam=replace(foam, material="ecoflex 00-30")))
    assert cast["release agent"].specification == "for silicone"
    assert "spray glue" in found
    assert "spray glue" not in cast


def test_a_printed_mould_needs_no_silicone() -> None:
    robot = box((-0.05, 0.08, 0.08), (0.1, 0.08, 0.08))
    found = needs(given(robot, foam=FoamNeeds(volume=4e5, part_a=32.0, part_b=32.0), pieces=(CUBE,)))
    assert "silicone" not in found
    assert found["PLA for the mold"].mass == pytest.approx(CUBES)


GUESSED = {
    *("zipper", "needle", "decoration", "tube", "shifter", "driver", "servo cable", "small parts", "foam", "silicone"),
    *("glue", "sealer", "clay", "plastic glue", "bolts", "rod", "skin", "wire", "soft part", "stiff part"),
}
"""Prices for which no source was found; any other without one fails."""


def test_every_price_says_where_it_is_from() -> None:
    for price in PRICES.values():
        assert price.amount >= 0
        assert price.currency == "USD"
        assert price.words == NO_SOURCE or price.words.startswith("rough, from ")
    assert {key for key, price in PRICES.items() if price.words == NO_SOURCE} == GUESSED
    assert [key for key, price in PRICES.items() if price.amount == 0] == ["servo's own cable"]


def test_every_part_has_words_to_search_for() -> None:
    """Oracle: what the author would type into a shop's search box."""
    assert SEARCHES.keys() == PRICES.keys()
    screw = "M2 x 20 mm countersunk screw (housing), machine thread, with a nut"
    assert search_term("screws", screw) == "M2 x 20 mm countersunk screw"
    assert search_term("supply", "12 V, 8 A or more") == "power supply 12 V 8 A"
    assert search_term("switch", "for 25 A, large enough to be hit") == "toggle switch 25 A"
    assert search_term("uno board", "Arduino Uno or alike") == "Arduino Uno R3"
    assert search_term("", "Feetech STS3215-C001, 7.4 V (DFRobot: SER0069)") == "Feetech STS3215-C001, 7.4 V"
    assert search_term("foam", "as the robot file says") == "flexible foam kit"
    found = needs(given(square(), cloth=Cloth(felt=2e5, seam=1e3, zipper=96.0)))
    assert found["zipper"].search == "nylon zipper of 100 mm"
    assert all(item.search for item in found.values())


def test_no_robot_uses_up_a_tool() -> None:
    """Oracle: needles of 5 USD are bought, and are left when the robot is done."""
    needles = needs(given(square(), cloth=Cloth(felt=1e5, seam=1e3)))["needles"]
    assert (needles.cost, needles.cost_packs) == (0.0, 5.0)


def test_a_servo_brings_its_cable() -> None:
    """Oracle: packages of the makers; that of an SCS0009 is not known."""
    keys = {"sts3215": 0.0, "sts3215-12v": 0.0, "st3020": 2.0, "scs0009": 2.0, "xl330": 2.0}
    costs = {key: needs(given(square(), motor=Motor.choose(key)))["servo cable"].cost for key in keys}
    assert costs == keys


@pytest.mark.parametrize(
    ("panels", "words"),
    [
        ([(200.0, 90.0), (290.2, 200.0)], "; largest panel 291 x 200 mm"),
        ([(296.0, 283.0), (290.2, 200.0)], "; largest panel 296 x 283 mm, larger than craft sheets of 229 x 305 mm"),
        (
            [(400.0, 60.0), (220.0, 290.0)],
            "; largest panel 220 x 290 mm, one of 400 x 60 mm is larger than craft sheets of 229 x 305 mm",
        ),
        ([(304.8, 200.0)], "; largest panel 305 x 200 mm"),
        ([(310.0, 50.0)], "larger than craft sheets"),
        ((), "that a laser may cut"),
    ],
)
def test_felt_is_bought_in_pieces_that_hold_each_panel(panels, words):
    """Oracle: a craft sheet of 9 x 12 inches, in either direction."""
    found = needs(given(square(), cloth=Cloth(felt=1e5, seam=1e3, panels=tuple(panels))))["felt"].specification
    assert words in found
    assert ("craft" in found) == ("craft" in words)
