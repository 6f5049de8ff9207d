"""Plans of kits from a few facts, without winches and molds being made."""

from types import MappingProxyType
from typing import Any

from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.kit_options import KitOptions, PartOptions
from hydrostat.fabrication.kit_plan import BodyWork, KitPlan
from hydrostat.fabrication.parts.body_seat import BodySeat
from hydrostat.fabrication.parts.cleat import cleat
from hydrostat.fabrication.parts.motor import MOTORS
from hydrostat.fabrication.parts.rigid_parts import RigidParts
from hydrostat.robot import Robot


class FewParts(RigidParts):
    """Rigid parts whose facts are given in place of being computed; none if left out."""

    printed = ()
    screws = MappingProxyType({})
    leads = MappingProxyType({})
    seats = MappingProxyType({})
    outside = MappingProxyType({})
    stopper_hold = None
    winch_assembly = None
    base_assembly = None
    seat_assembly = None
    stopper_assembly = None

    def __init__(self, **facts: Any) -> None:
        stopper = cleat(PartOptions())
        super().__init__(motor=MOTORS[0], units=(), base=None, seat=BodySeat(), stopper=stopper, grommet=None, cables=0)
        self.__dict__.update(facts)


_OF_PARTS = {"motor", "units", *(name for name in vars(FewParts) if not name.startswith("_"))}
_OF_WORK = set(BodyWork.__dataclass_fields__)
_OF_OPTIONS = {"method", "paper"}


def make_plan(robot: Robot, demand: Demand, **facts: Any) -> KitPlan:
    """A plan of a robot; facts of its parts, its body and its options go by their names, "pieces" are of a mold."""
    plan = KitPlan(drawn=robot, robot=robot, options=KitOptions(), demand=demand, rigid=FewParts(), work=BodyWork())
    return change_plan(plan, **facts)


def change_plan(plan: KitPlan, **facts: Any) -> KitPlan:
    """A plan with other facts."""
    if "robot" in facts:
        facts["drawn"] = facts["robot"]
    work = {"printed": facts.pop("pieces")} if "pieces" in facts else {}
    own = {name: vars(plan)[name] for name in KitPlan.__dataclass_fields__}
    parts = {name: facts.pop(name) for name in list(facts) if name in _OF_PARTS}
    work |= {name: facts.pop(name) for name in list(facts) if name in _OF_WORK}
    options = {name: facts.pop(name) for name in list(facts) if name in _OF_OPTIONS}
    own["rigid"] = FewParts(**(vars(plan.rigid) | parts))
    own["work"] = BodyWork(**(vars(plan.work) | work))
    own["options"] = KitOptions(**(vars(plan.options) | options))
    return KitPlan(**(own | facts))
