"""`BuildCost`: what it takes to sew and to motorise a network, in plain units."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hydrostat.design.checks.cables import HOLE_TOLERANCE
from hydrostat.design.polyline import nearest_shares, turns
from hydrostat.fabrication import CableWork, KitOptions, Method, drive_price, find_motor, shaft_torques
from hydrostat.ik import IKResult
from hydrostat.robot import Cable, Mount, Robot, sewn_robot, sewn_sides
from hydrostat.units import plural

SHARP_TURN = 60.0  # a turn of more than this [degrees] is called sharp


@dataclass(frozen=True, kw_only=True)
class BuildCost:
    """Labour and money that a network asks of who builds it."""

    holes: int  # those in the cloth of a flat plush body; else points that cables are led through, but at winches
    crossings: int  # places where cables cross, but beside the winch of both
    sharp_turns: int  # via points at which a cable turns by more than `SHARP_TURN` degrees
    sheaths: int  # tubes
    length: float  # of all cables along their routes [m]
    minutes: float  # of cutting cables and tubes, and of stitching or threading them [min]
    price: float  # rough, of motors with boards, drivers and supply, of line and tube as used up [USD]
    motors: int  # winches that have cables: one motor each
    motor: str  # key of the kind of motor, the same for all; empty where there is none
    work: str = "sewing"  # of those minutes: sewing of a plush body, threading of a printed or a cast one

    def __str__(self) -> str:
        """Such as "18 holes, 52 min of sewing, 165 USD (3 motors, power, cables)"; crossings if there are any."""
        crossed = f", {plural(self.crossings, 'crossing')}" if self.crossings else ""
        return (
            f"{plural(self.holes, 'hole')}{crossed}, {self.minutes:.0f} min of {self.work}, {self.price:.0f} USD "
            f"({plural(self.motors, 'motor')}, power, cables)"
        )

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> "BuildCost":
        """Cost of the values of a file (ValueError, TypeError: they are none)."""
        cost = cls(**values)
        numbers = [value for name, value in vars(cost).items() if name not in ("motor", "work")]
        if not isinstance(cost.motor, str) or any(isinstance(one, bool) or not 0 <= one < math.inf for one in numbers):
            raise ValueError("not the cost of a design")
        return cost

    @property
    def as_values(self) -> dict[str, float | int | str]:
        """The fields by their names, as plain values for a file."""
        return dict(vars(self))

    @staticmethod
    def of_robot(robot: Robot, reached: Sequence[IKResult]) -> "BuildCost":
        """Count what a network takes; an "auto" motor follows from the tensions of the poses that it reaches.

        Cables in pairs are sewn twice: all but motors counts for both. Printed and cast bodies have no pairs.
        """
        plush = KitOptions().method_for(robot.body) is Method.PLUSH
        cables, work = (sewn_robot(robot) if plush else robot).cables, CableWork.of_robot(robot)
        motors = len({cable.winch for cable in cables})
        length = float(sum(cable.length for cable in cables))
        price, key = 0.0, ""
        if motors:
            rows = [shaft_torques(robot, pose.pose.tensions) for pose in reached]
            torques = np.array(rows).reshape(-1, len(robot.winches)).max(axis=0, initial=0.0).tolist()
            chosen = find_motor(robot, torques, KitOptions())
            price, key = drive_price(robot, torques, chosen, options=KitOptions()), chosen.key
        return BuildCost(
            holes=work.holes,
            crossings=(len(sewn_sides(robot)) if plush else 1) * _crossings(robot),
            sharp_turns=sum(_sharp(cable) for cable in cables),
            sheaths=sum(len(cable.sheathed) for cable in cables),
            length=length,
            minutes=work.minutes,
            price=price,
            motors=motors,
            motor=key,
            work=BuildCost.cable_work(robot),
        )

    @staticmethod
    def cable_work(robot: Robot) -> str:
        """Work that the cables of a robot take by the usual method of its body: "sewing" or "threading"."""
        return "sewing" if KitOptions().method_for(robot.body) is Method.PLUSH else "threading"

    @staticmethod
    def cable_minutes(robot: Robot) -> float:
        """Minutes that it takes to cut the cables and tubes of a robot, and to stitch or thread them [min]."""
        return CableWork.of_robot(robot).minutes


def front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of pairs (effort, error) that have a smaller error than all of as little effort, in order of effort."""
    kept: list[int] = []
    for index in sorted(range(len(points)), key=points.__getitem__):
        if not kept or points[index][1] < points[kept[-1]][1]:
            kept.append(index)
    return kept


def _sharp(cable: Cable) -> int:
    return int((np.degrees(turns(np.array(cable.points))) > SHARP_TURN).sum())


def _crossings(robot: Robot) -> int:
    """Pairs of segments that meet: not neighbors of one cable, and not within two spool radii of a shared winch."""
    winches = {winch.name: winch for winch in robot.winches}
    runs = [
        (index, at, np.array(cable.points[at : at + 2]))
        for index, cable in enumerate(robot.cables)
        for at in range(int(winches[cable.winch].mount is Mount.WORLD), len(cable.points) - 1)
    ]
    found = 0
    for number, (index, at, ends) in enumerate(runs):
        for other, there, ends_there in runs[number + 1 :]:
            if other == index and there <= at + 1:
                continue
            shares = nearest_shares(ends[None], ends_there[None])
            place = ends[0] + shares[0][0] * (ends[1] - ends[0])
            meet = ends_there[0] + shares[1][0] * (ends_there[1] - ends_there[0])
            winch = winches[robot.cables[index].winch]
            beside = winch.name == robot.cables[other].winch and winch.mount is Mount.BODY
            if beside and np.linalg.norm(place - np.array(winch.at)) < 2 * winch.spool_radius:
                continue
            found += int(np.linalg.norm(place - meet) < HOLE_TOLERANCE)
    return found
