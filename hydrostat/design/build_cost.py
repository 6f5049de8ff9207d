"""`BuildCost`: what it takes to sew and to motorise a network, in plain units."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.design.checks.cables import SAME
from hydrostat.design.polyline import nearest_shares, turns
from hydrostat.fabrication import PRICES, KitOptions, Method, find_motor, motors_price, shaft_torques
from hydrostat.ik import IKResult
from hydrostat.robot import Cable, Mount, Robot, sewn_sides
from hydrostat.units import plural

SHARP = 60.0  # a turn of more than this [degrees] is called sharp


@dataclass(frozen=True, kw_only=True)
class SewingTimes:
    """Minutes that the work on cables takes. All are assumed; none was measured.

    A cable with five holes is stitched in ten minutes, as the assembly sheet says of every cable.
    """

    cut: float = 3.0  # to cut and mark a line or a tube, as on the assembly sheet
    begin: float = 2.5  # to begin a cable at its winch
    hole: float = 1.5  # to lead it through a hole, from the one before; at the last with its stopper
    sheath: float = 2.0  # to tie a tube down at both its ends
    thread: float = 5.0  # to draw a cable through the hole of a printed body, as on its sheet
    draw: float = 15.0  # to draw a cable through a cast body by a needle, as on its sheet


@dataclass(frozen=True, kw_only=True)
class BuildCost:
    """Labour and money that a network asks of who builds it."""

    holes: int  # points that cables are led through, that of the stopper included, not where they begin
    crossings: int  # places where cables cross, but beside the winch of both
    sharp_turns: int  # via points at which a cable turns by more than `SHARP` degrees
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

    @property
    def as_values(self) -> dict[str, float | int | str]:
        """The fields by their names, as plain values for a file."""
        return dict(vars(self))

    @staticmethod
    def of_robot(robot: Robot, reached: Sequence[IKResult], *, times: SewingTimes | None = None) -> "BuildCost":
        """Count what a network takes; an "auto" motor follows from the tensions of the poses that it reaches.

        Cables in pairs are sewn twice: all but motors counts for both. Printed and cast bodies have no pairs.
        """
        cables, twice = robot.cables, _num_sides(robot)
        motors = len({cable.winch for cable in cables})
        holes = twice * sum(len(cable.points) - 1 for cable in cables)
        sheaths = twice * sum(len(cable.sheathed) for cable in cables)
        length = twice * float(sum(cable.length for cable in cables))
        tube = twice * float(sum(cable.segments[~cable.bare].sum() for cable in cables))
        price, key = PRICES["line"].amount * length + PRICES["tube"].amount * tube, ""
        if motors:
            rows = [shaft_torques(robot, pose.pose.tensions) for pose in reached]
            torques = np.array(rows).reshape(-1, len(robot.winches)).max(axis=0, initial=0.0).tolist()
            chosen = find_motor(robot, torques, KitOptions())
            used = {cable.winch for cable in cables}
            pulled = [each for winch, each in zip(robot.winches, torques, strict=True) if winch.name in used]
            price += motors_price(pulled, chosen)
            key = chosen.key
        return BuildCost(
            holes=holes,
            crossings=twice * _crossings(robot),
            sharp_turns=twice * sum(_sharp(cable) for cable in cables),
            sheaths=sheaths,
            length=length,
            minutes=BuildCost.cable_minutes(robot, times=times),
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
    def cable_minutes(robot: Robot, *, times: SewingTimes | None = None) -> float:
        """Minutes that it takes to cut the cables and tubes of a robot, and to stitch or thread them [min]."""
        clock, method = times or SewingTimes(), KitOptions().method_for(robot.body)
        sheaths = (clock.cut + clock.sheath) * sum(len(cable.sheathed) for cable in robot.cables)
        if method is not Method.PLUSH:
            return (clock.cut + (clock.thread if method is Method.PRINT else clock.draw)) * len(robot.cables) + sheaths
        holes = sum(len(cable.points) - 1 for cable in robot.cables)
        return _num_sides(robot) * ((clock.cut + clock.begin) * len(robot.cables) + clock.hole * holes + sheaths)


def _num_sides(robot: Robot) -> int:
    """Number of times that each cable is there: two in pairs, which only a plush body has."""
    return len(sewn_sides(robot)) if KitOptions().method_for(robot.body) is Method.PLUSH else 1


def front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of pairs (effort, error) that have a smaller error than all of as little effort, in order of effort."""
    kept: list[int] = []
    for index in sorted(range(len(points)), key=points.__getitem__):
        if not kept or points[index][1] < points[kept[-1]][1]:
            kept.append(index)
    return kept


def _sharp(cable: Cable) -> int:
    return int((np.degrees(turns(np.array(cable.points))) > SHARP).sum())


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
            found += int(np.linalg.norm(place - meet) < SAME)
    return found
