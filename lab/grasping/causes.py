"""Causes of a weak grasp: one factor at a time, by the force that pulls a tennis ball out.

    python lab/grasping/causes.py [--step 6] [--factors friction modulus] [--closings 1 2 3 4] [NAME ...]

Around one default (friction 0.5, foam of the gallery, 60 kPa) each row changes the closing, the cable force, Young's
modulus, friction or the position of the ball. The last rows change several together. A row states the peak of the
pull, the tension of the tightest cable during it, and the weakest motor of a kit that holds this tension for long with
the margin of `hydrostat fabricate`.

Friction of a glove is assumed, measured on none: 0.3 smooth felt, 0.5 knitted cotton, 0.8 and 1.2 rubber-dotted.
Moduli: 240 kPa is what the square law of density takes the thesis's other foam to, 1,200 kPa the same for flexfoam-it v
(docs/materials.md).
"""

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

from grasp import EXAMPLES, GRASPS
from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.arrays import Vector
from hydrostat.errors import HydrostatError
from hydrostat.fabrication import MOTORS
from hydrostat.grasp import PullOptions, move_object, pull_out, read_object
from hydrostat.robot import Obstacle, Robot

DEFAULTS = {"caging_gripper": 2.0, "cupping_hand": 1.0, "extended_hand": 1.0}
"""Factor of the contractions of the pose, as in decision 0033."""
FACTORS = ("closing", "cable force", "modulus", "friction", "position", "together")
FRICTIONS, MODULI, ASIDE = (0.3, 0.8, 1.2), (120e3, 240e3, 1200e3), 5e-3


@dataclass(frozen=True, kw_only=True, eq=False)
class Case:
    """One pull: the factor that differs from the default, and what is pulled."""

    factor: str
    value: str
    robot: Robot
    ball: Obstacle
    contractions: Vector


class Grasp:
    """Default grasp of a robot, and the cases around it."""

    def __init__(self, name: str) -> None:
        """Load the robot and find the contractions of its pose."""
        pose, at, self.direction, self.thesis = GRASPS[name]
        self.robot = replace(hs.load_robot(EXAMPLES / name), contact=hs.Contact())
        self.ball = move_object(read_object("sphere:67mm", 3, mass=0.058, friction=0.5), 1e-3 * np.array(at))
        self.simulation = hs.Simulation(self.robot)
        self.travel = np.array([winch.travel for winch in self.robot.winches])
        self.closed = hs.solve_ik(self.simulation, self.robot.pose(pose)).pose.contractions
        self.closing = DEFAULTS[name]

    def case(self, factor: str, value: str, **changes: object) -> Case:
        """Return a case with some fields other than the default's."""
        usual = {"robot": self.robot, "ball": self.ball, "contractions": self.taken(self.closing)}
        return Case(factor=factor, value=value, **{**usual, **changes})

    def taken(self, closing: float) -> Vector:
        """Return the contractions of the pose times a factor, within travel [m]."""
        return np.minimum(closing * self.closed, self.travel)

    def stiff(self, young: float) -> Robot:
        """Return the robot with another Young's modulus [Pa]."""
        return replace(self.robot, body=replace(self.robot.body, material=self.robot.body.material.with_young(young)))

    def tightened(self, force: float) -> tuple[Vector, float]:
        """Return contractions at which the tightest cable pulls with a force [N] without the ball, within travel.

        They are multiples of those of the pose. With them comes the tension [N], less than the force at full travel.
        """
        low, high = 0.0, float((self.travel / np.maximum(self.closed, _IDLE)).max())
        for _ in range(12):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.tension(middle) < force else (low, middle)
        return self.taken(high), self.tension(high)

    def tension(self, closing: float) -> float:
        """Return the tension of the tightest cable without the ball [N]; infinite without an equilibrium."""
        pose = self.simulation.solve(self.taken(closing), strict=False)
        return float(pose.tensions.max()) if pose.result.converged else np.inf

    def forces(self) -> Iterator[Case]:
        """Yield closings at which a cable pulls as hard as each of the two weakest motors of kits holds for long."""
        for motor in MOTORS[:2]:
            force = motor.largest_torque() / self.robot.winches[0].spool_radius
            taken, reached = self.tightened(force)
            ends = reached < 0.99 * force
            yield self.case("cable force", f"{reached:.1f} N{', full travel' * ends}", contractions=taken)
            if ends:
                return

    def cases(self, factors: list[str], closings: list[float]) -> Iterator[Case]:
        """Yield all cases, the default first."""
        yield self.case("default", f"closing x {self.closing:g}, 60 kPa, friction 0.5")
        for closing in closings:
            if closing != self.closing:
                yield self.case("closing", f"x {closing:g}", contractions=self.taken(closing))
        if "cable force" in factors:
            yield from self.forces()
        for young in MODULI:
            yield self.case("modulus", f"{1e-3 * young:,.0f} kPa", robot=self.stiff(young))
        for friction in FRICTIONS:
            yield self.case("friction", f"{friction:g}", ball=replace(self.ball, friction=friction))
        place = self.ball.frame()[0]
        for axis in range(3):
            for sign in (-1.0, 1.0):
                moved = move_object(self.ball, place + sign * ASIDE * np.eye(3)[axis])
                yield self.case("position", f"{'xyz'[axis]} {1e3 * sign * ASIDE:+.0f} mm", ball=moved)
        grippy = replace(self.ball, friction=0.8)
        yield self.case("together", "240 kPa, friction 0.8", robot=self.stiff(240e3), ball=grippy)
        firm = {"robot": self.stiff(240e3), "contractions": self.taken(4.0)}
        yield self.case("together", "closing x 4, 240 kPa", **firm)
        yield self.case("together", "closing x 4, 240 kPa, friction 0.8", **firm, ball=grippy)


_IDLE = 1e-3  # contraction below which a cable does not limit the closing [m]


def motor_for(robot: Robot, tension: float) -> str:
    """Return the weakest motor that holds a tension for long, with the margin of a kit."""
    torque = tension * max(winch.spool_radius for winch in robot.winches)
    return next((motor.key for motor in MOTORS if motor.largest_torque() >= torque), "none")


def study(name: str, step: float, factors: list[str], closings: list[float]) -> None:
    """Print the rows of one robot."""
    grasp = Grasp(name)
    options, default = PullOptions(direction=grasp.direction, step=step), None
    print(f"\n{name}, thesis {grasp.thesis} N\n")
    print("| factor | value | peak N | times the default | tightest cable N | motor | end | CPU s |\n|" + 8 * "---|")
    for case in grasp.cases(factors, closings):
        if case.factor not in ("default", *factors):
            continue
        begin, row = time.process_time(), f"| {case.factor} | {case.value}"
        try:
            pull = pull_out(case.robot, case.ball, case.contractions, options)
        except HydrostatError as error:
            print(f"{row} | {error} ||||||", flush=True)
            continue
        default = default or pull.peak
        tight = max(float(pose.tensions.max()) for pose in pull.poses)
        print(
            f"{row} | {pull.peak:.2f} | {pull.peak / default:.2f} | {tight:.1f} | {motor_for(case.robot, tight)} | "
            f"{pull.status} | {time.process_time() - begin:.0f} |",
            flush=True,
        )


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", default=["caging_gripper", "cupping_hand"])
    parser.add_argument("--step", type=float, default=6.0, help="of the pull [mm]")
    parser.add_argument("--factors", nargs="+", default=list(FACTORS), choices=FACTORS)
    parser.add_argument("--closings", type=float, nargs="+", default=[1.0, 2.0, 3.0, 4.0], help="times the pose's")
    given = parser.parse_args()
    print(machine())
    for name in given.names:
        study(name, 1e-3 * given.step, given.factors, given.closings)


if __name__ == "__main__":
    main()
