"""Keyframes twist a ball within the gallery's gripper and hands: how far it turns, and films.

    python lab/push_and_twist/twist.py [--friction 0.56 0.8 1.04] [--step 0.02] [--films DIR] [HAND ...]

After Fig 4.10 of the thesis, where three hands twist a ball, each its way. The gripper swings its four fingers round
the ball as one opens a jar; the hands roll it between thumb and fingers, by keyframes that a random search of some
tens of tries found at friction 0.8 and time steps of 0.05 s: what they do with other friction was not looked at. The
ball is a free body that Coulomb friction
takes along, in dynamics; a spring of 100 N/m keeps it about its place in place of a palm under it, as there is no
gravity here, and nothing keeps it from turning but drag. In the end the hand is open again: what the ball has turned
by then stays.
"""

import argparse
import time
from dataclasses import dataclass, replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.plot import Frame
from hydrostat.robot import Contact, Obstacle, Robot
from hydrostat_lab.held_object import HeldObject, contractions
from hydrostat_lab.keyframes import ease, save_film

EXAMPLES = Path(__file__).parents[2] / "examples"
HOLD, VISCOSITY, SECONDS = 100.0, 400.0, 0.5
"""Spring of the ball [N/m], shear viscosity of the foam [Pa s], time from one keyframe to the next [s]."""


@dataclass(frozen=True)
class Twist:
    """Keyframes, in parts of winches' names with what they take in [mm]; later parts win."""

    at: tuple[float, float, float]  # middle of the ball [mm]
    radius: float  # of the ball [mm]
    keys: dict[str, dict[str, float]]
    robot: str = ""  # if it has another name than the twist
    length: float = 0.0  # of the straight part of an upright rod with round ends, in place of a ball [mm]

    def obstacle(self, friction: float) -> Obstacle:
        """What is turned."""
        known = {"name": "ball", "radius": 1e-3 * self.radius, "mass": 0.03, "friction": friction}
        middle, half = 1e-3 * np.array(self.at), 5e-4 * self.length * np.eye(3)[2]
        if not self.length:
            return Obstacle(shape="sphere", at=tuple(middle.tolist()), **known)
        return Obstacle(
            shape="capsule", at=tuple((middle - half).tolist()), to=tuple((middle + half).tolist()), **known
        )


_SWING = {
    "swung back": {" a": 14, " b": 0},
    "closed there": {" a": 24, " b": 10},
    "swung round": {" a": 10, " b": 24},
    "opened there": {" a": 0, " b": 14},
}
TWISTS = {
    "caging_gripper": Twist(
        (0, 0, 78),
        33.5,
        {**_SWING, "open": {}},
    ),
    "rod": Twist(
        (0, 0, 88),
        24,
        {
            **_SWING,
            **{f"{word}, again": keys for word, keys in _SWING.items()},
            "open": {},
        },
        robot="caging_gripper",
        length=50,
    ),
    "cupping_hand": Twist(
        (24, -43, 115),
        15,
        {
            "closed": {"thumb flexor": 36, "index flexor": 25, "index extensor": 28, "middle flexor": 30},
            "rolled": {
                **{"thumb flexor": 18, "thumb extensor": 29, "index flexor": 30, "index extensor": 7},
                **{"middle flexor": 23, "ring flexor": 27},
            },
            "let go": {
                **{"thumb flexor": 9, "thumb extensor": 1, "index flexor": 20, "index extensor": 14},
                **{"middle flexor": 8, "ring flexor": 23},
            },
            "open": {},
        },
    ),
    "extended_hand": Twist(
        (30, -53, 127),
        15,
        {
            "closed": {
                **{"thumb opponens": 5, "index flexor": 23, "index side": 14, "middle flexor": 30, "ring flexor": 17}
            },
            "rolled": {
                **{"thumb flexor": 28, "thumb opponens": 4, "index flexor": 25, "middle flexor": 2, "ring flexor": 26}
            },
            "let go": {"index flexor": 11, "index side": 3, "middle flexor": 1, "ring flexor": 6},
            "open": {},
        },
    ),
}


def robot_with(robot: Robot, twist: Twist, friction: float) -> Robot:
    """Return a robot with viscous foam and what it turns."""
    body = replace(robot.body, material=replace(robot.body.material, viscosity=VISCOSITY))
    return replace(robot, body=body, contact=Contact(), obstacles=(twist.obstacle(friction),))


def mark_object(held: HeldObject) -> list[Obstacle]:
    """Return the ball where it is, with dots on it, which show how it turns."""
    radius = held.object.radius or 0.0
    dots = held.place + 0.94 * radius * np.concatenate([held.axes, -held.axes])[:: 1 if held.object.to is None else 2]
    made = [Obstacle(name="dot", shape="sphere", at=tuple(dot), radius=0.16 * radius) for dot in dots.tolist()]
    return [held.current_obstacle(), *made]


def run(name: str, friction: float, step: float, films: Path | None) -> None:
    """Print a row for each keyframe of a hand, and write a film if asked."""
    twist = TWISTS[name]
    robot = hs.load_robot(EXAMPLES / (twist.robot or name))
    held, frames, began = HeldObject(robot_with(robot, twist, friction), hold=HOLD), [], time.process_time()
    goal = np.zeros(len(robot.winches))
    for key in twist.keys:
        begin, goal = goal, contractions(robot, twist.keys[key])
        for motion in ease(held.advance, begin, goal, seconds=SECONDS, step=step):
            words = f"{key}: the ball has turned by {np.linalg.norm(held.rotation):.0f} degrees"
            frames.append(Frame.of(motion, words=words, obstacles=mark_object(held)))
        x, y, z = held.rotation
        away = 1e3 * float(np.linalg.norm(held.place - held.start_place))
        print(
            f"| {name} | {friction:g} | {key} | {x:.1f}, {y:.1f}, {z:.1f} | {np.linalg.norm(held.rotation):.1f} | "
            f"{away:.1f} | {time.process_time() - began:.0f} |",
            flush=True,
        )
    if films is not None:
        save_film(robot, frames, films / f"{name}.gif", step)


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("hands", nargs="*", default=list(TWISTS))
    parser.add_argument("--friction", type=float, nargs="+", default=[0.8])
    parser.add_argument("--step", type=float, default=0.02, help="in time [s]")
    parser.add_argument("--films", type=Path)
    given = parser.parse_args()
    print(machine())
    print("| hand | friction | keyframe | ball turned about x, y, z, degrees | in all | moved mm | s |\n|" + 7 * "---|")
    for name in given.hands:
        for friction in given.friction:
            run(name, friction, given.step, given.films)


if __name__ == "__main__":
    main()
