"""Networks that were drawn by hand, with care, for the bodies of the benchmark of designs.

    python lab/designs/drawn_networks.py [BODY ...]

Each has the counts of `BODIES` and keeps the constraints there. They were drawn on pictures of the body and its poses,
and redrawn after seeing what each marker misses, as a good maker would: the puppy in three rounds, the starfish in
seventeen. What helped: a cable that ends early and hugs the edge bends more for what the winch takes in; one that goes
a long way round, or out and back, bends less, so that limbs on one winch come to the same pace; a sheath up to where
bending should begin. The cupping hand keeps the network of the example, which has its counts and keeps its constraints
but for via points too near to a stopper.
"""

import argparse
from collections.abc import Mapping
from dataclasses import dataclass, replace

from design_bodies import BODIES, body_robot, judged
from machine import machine

import numpy as np  # isort: skip

from hydrostat.design import Region, violations
from hydrostat.robot import Cable, Robot, Winch


@dataclass(frozen=True)
class Line:
    """One cable.

    Attributes:
        winch: that pulls it.
        points: after the winch, the last at the stopper [mm].
        lead: so many of its first segments run in a sheath.
    """

    winch: str
    points: str
    lead: int = 0


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """A network.

    Attributes:
        winches: places by name [mm]; empty for a winch of the example that stands in the world.
        cables: of them.
    """

    winches: Mapping[str, str]
    cables: tuple[Line, ...]


def hand_network(name: str) -> Robot:
    """The body with the network that was drawn for it."""
    robot = body_robot(name)
    if name not in DRAWINGS:
        return _with_holes_apart(robot, BODIES[name].constraints.hole_gap)
    drawing, constraints = DRAWINGS[name], BODIES[name].constraints
    winches = {
        called: Winch(
            name=called,
            at=_points(at)[0] if at else robot.winch(called).at,
            spool_radius=constraints.spool_radius,
            travel=constraints.travel,
            mount=robot.winches[0].mount,
        )
        for called, at in drawing.winches.items()
    }
    cables = [
        Cable(
            winch=line.winch,
            points=(winches[line.winch].at, *_points(line.points)),
            sheathed=((0, line.lead),) if line.lead else (),
        )
        for line in drawing.cables
    ]
    return robot.with_network(winches.values(), cables)


def _points(text: str) -> list[tuple[float, ...]]:
    """Points [m] of millimeters in words: "20 -8, 34 2"."""
    return [tuple(round(1e-3 * float(value), 6) for value in point.split()) for point in text.split(",")]


def _with_holes_apart(robot: Robot, gap: float) -> Robot:
    """Without the points that are nearer than `gap` to the stopper of their cable."""
    cables = []
    for cable in robot.cables:
        away = np.linalg.norm(np.subtract(cable.points, cable.points[-1]), axis=1)
        kept = [point for point, distance in zip(cable.points[:-1], away[:-1], strict=True) if distance >= gap]
        cables.append(replace(cable, points=(*kept, cable.points[-1])))
    return robot.with_network(robot.winches, cables)


DRAWINGS = {
    "starfish": Drawing(
        winches={"right": "0 -42", "left": "-20 0"},
        cables=(
            # Lifts the right arm.
            Line(
                "right",
                "18 -24, 32 -2, 45 14.5, 58 17.5, 70 21.5, 82 25.7, 94 31",
                lead=2,
            ),
            # Swings the right foot out; it comes half the way back, so that it pulls half as far.
            Line(
                "right",
                "28 -43, 45 -54, 56 -71, 68 -87, 79 -100, 85.5 -109, 83.5 -117, 76 -118, 64 -104, 53 -90, 43 -76, "
                "35 -64",
            ),
            # Swings the left foot out.
            Line(
                "right",
                "-28 -43, -45 -54, -56 -71, -68 -87, -79 -100, -85.5 -109, -83.5 -117, -76 -118, -64 -104, -53 "
                "-90, -43 -76, -35 -64",
            ),
            # Lifts the left arm.
            Line(
                "left",
                "-33 6, -46 13.5, -61 17, -76 22.5, -91 29, -106 37",
                lead=1,
            ),
            # Tips the top arm; out and back.
            Line(
                "left",
                "-20 22, -20 42, -16 62, -11 80, -5 97, -2 107, 3 112, 8 109.5, 8.5 99, 3 80, -2 62",
            ),
            # Helps the left foot.
            Line(
                "left",
                "-38 -12, -44 -32, -40 -50, -49 -68, -60 -85, -71 -99",
                lead=3,
            ),
        ),
    ),
    "robot": Drawing(
        winches={"left": "-20 -13", "right": "20 -13"},
        cables=(
            # Bends the left forearm: it ends half-way to the hand.
            Line(
                "left",
                "-30 2, -42 8.5, -58 15, -72 13.5, -86 11, -101 6.5",
                lead=2,
            ),
            # Kicks the left foot out.
            Line(
                "left",
                "-33 -34, -37 -56, -38 -74, -38.5 -91, -39 -108, -42 -121, -50 -132",
                lead=3,
            ),
            # Tips the head to the left; a long way round, so that it pulls less.
            Line(
                "left",
                "-36 -16, -47 -6, -48 12, -36 25, -20 30, -12 41, -14 54, -20 68",
            ),
            # Bends the right forearm: it ends half-way to the hand.
            Line(
                "right",
                "30 2, 42 8.5, 58 15, 72 13.5, 86 11, 101 6.5",
                lead=2,
            ),
            # Kicks the right foot out.
            Line(
                "right",
                "33 -34, 37 -56, 38 -74, 38.5 -91, 39 -108, 42 -121, 50 -132",
                lead=3,
            ),
            # Tips the head to the right; a long way round, so that it pulls less.
            Line(
                "right",
                "36 -16, 47 -6, 48 12, 36 25, 20 30, 12 41, 14 54, 20 68",
            ),
        ),
    ),
    "pig": Drawing(
        winches={"nod": "15 7"},
        cables=(
            # Pulls the chin down from the belly on.
            Line(
                "nod",
                "-5 -20, -30 -15, -57 -13, -72 -15.5, -90 -15, -105 -10",
                lead=1,
            ),
            # Lifts the tail.
            Line(
                "nod",
                "40 11, 63 17, 82 24, 102 32, 118 33, 134 37, 142 46",
                lead=1,
            ),
        ),
    ),
    "letter_e": Drawing(
        winches={"arms": "-69 -5"},
        cables=(
            # Pulls the middle arm up.
            Line(
                "arms",
                "-53 0, -25 7, -7 7, 11 8, 30 10, 48 14",
                lead=1,
            ),
            # Pulls the bottom arm up.
            Line(
                "arms",
                "-67 -34, -66 -60, -57 -81, -42 -94, -17 -97, 6 -99, 30 -99, 53 -97, 76 -93",
                lead=2,
            ),
            # Shortens the top arm, which one pose wants up and the other down.
            Line(
                "arms",
                "-67 25, -66 52, -59 76, -42 95, -21 101, 2 103, 25 105, 47 107, 71 110",
                lead=4,
            ),
        ),
    ),
    "letter_s": Drawing(
        winches={"stretch": "5 0"},
        cables=(
            # Uncurls the head, outside: to stretch is worth more than to curl, and one winch does one.
            Line(
                "stretch",
                "-20 -6, -37 -2, -53 10, -66 27, -74 46, -75 62, -70 82, -60 96, -45 110, -22 113, 2 115",
                lead=2,
            ),
            # Uncurls the tail.
            Line(
                "stretch",
                "25 6, 40 -4, 55 -15, 68 -32, 74 -52, 73.5 -67, 69 -82, 58 -98, 41 -111, 20 -116, -5 -117",
                lead=2,
            ),
        ),
    ),
    "puppy": Drawing(
        winches={"reach": "20 -8", "gather": "-51 -6", "push": "-86 -4"},
        cables=(
            # Swings the outer front leg forward.
            Line(
                "reach",
                "36 -25, 50 -42, 55 -58, 56 -74, 57.5 -90, 59.5 -102",
                lead=2,
            ),
            # Swings the inner hind leg forward.
            Line(
                "gather",
                "-53 -26, -55 -44, -51 -61, -50.2 -77, -49.4 -92, -48.5 -104",
                lead=2,
            ),
            # Swings the outer hind leg back.
            Line(
                "push",
                "-97 -21, -109 -38, -117 -54, -118 -72, -117.5 -88, -116 -102",
                lead=2,
            ),
        ),
    ),
    "squid": Drawing(
        winches={
            "fins": "0 88",
            "far_left": "-46 4",
            "left": "-33 37",
            "right": "44 6",
            "close_left": "-30 -24",
            "close_right": "30 -24",
            "sway_left": "-14 12",
            "sway_right": "14 12",
        },
        cables=(
            # Flaps the left fin down.
            Line(
                "fins",
                "-22 80, -40 70, -54 73.5, -67 77.3",
                lead=1,
            ),
            # Flaps the right fin down.
            Line(
                "fins",
                "22 80, 40 70, 54 73.5, 67 77.3",
                lead=1,
            ),
            # Has no pose of its own: the tip takes up what the fins have too much.
            Line(
                "fins",
                "0 110, 0 130",
                lead=1,
            ),
            # Spreads the outermost left tentacle.
            Line(
                "far_left",
                "-60 -14, -69.5 -33, -76.3 -48, -84.3 -64.5, -95.7 -79.5, -108.8 -88.3",
                lead=1,
            ),
            # Spreads its neighbor.
            Line(
                "left",
                "-30 10, -42 -12, -47 -36, -50 -56, -53 -76, -57.5 -95, -66 -114, -76 -127",
                lead=2,
            ),
            # Spreads the outermost right tentacle.
            Line(
                "right",
                "60 -14, 69.5 -33, 76.3 -48, 84.3 -64.5, 95.7 -79.5, 107.5 -87.8",
                lead=1,
            ),
            # Spreads its neighbor.
            Line(
                "right",
                "46 -12, 47 -36, 50 -56, 53 -76, 57.2 -95, 65.5 -114, 75 -126.5",
                lead=1,
            ),
            # Curls the outermost left tentacle inwards.
            Line(
                "close_left",
                "-48 -32, -65.5 -53.5, -74 -66.5, -84.5 -82, -98 -95.3, -112 -101.4",
                lead=1,
            ),
            # Curls the outermost right tentacle inwards.
            Line(
                "close_right",
                "48 -32, 65.5 -53.5, 74 -66.5, 84.5 -82, 98 -95.3, 112 -101.4",
                lead=1,
            ),
            # Sways the middle left tentacle outwards.
            Line(
                "sway_left",
                "-17 -19, -20.5 -42, -20.8 -64, -20.8 -86, -21.5 -105, -23.4 -121",
                lead=1,
            ),
            # Sways the middle right tentacle outwards.
            Line(
                "sway_right",
                "17 -19, 20.5 -42, 20.8 -64, 20.8 -86, 21.5 -105, 23.4 -121",
                lead=1,
            ),
        ),
    ),
    "trunk": Drawing(
        winches={"right": "", "front": "", "back": "", "upper front": ""},
        cables=(
            # Bends it to the right.
            Line(
                "right",
                "20.6 -1 -9.1, 18.7 0.1 -38.9, 16.9 1.2 -68.6, 15.1 3 -98.4, 13.4 5.3 -128, 12 5.7 -157.8, 10.6 3 "
                "-187.4, 9.5 -3.4 -216.4, 8.8 -16.7 -242.7, 8.4 -34.7 -266.5",
                lead=1,
            ),
            # Bends all of it forwards.
            Line(
                "front",
                "7.2 -18.5 -9.6, 6.5 -15.9 -39.3, 5.9 -13.2 -69.2, 5.3 -9.9 -99.3, 4.7 -6.3 -128.6, 4.2 -4.6 "
                "-157.3, 3.7 -5.9 -186.1, 3.3 -10.8 -213.8, 3.1 -22.6 -238.6, 2.9 -39.9 -262.4",
                lead=1,
            ),
            # The same, on the other side.
            Line(
                "front",
                "-7.2 -18.5 -9.6, -6.5 -15.9 -39.3, -5.9 -13.2 -69.2, -5.3 -9.9 -99.3, -4.7 -6.3 -128.6, -4.2 "
                "-4.6 -157.3, -3.7 -5.9 -186.1, -3.3 -10.8 -213.8, -3.1 -22.6 -238.6, -2.9 -39.9 -262.4",
                lead=1,
            ),
            # Bends all of it back.
            Line(
                "back",
                "7.2 16.6 -8.7, 6.5 16 -38.5, 5.9 15.7 -68.1, 5.3 16 -97.5, 4.7 16.8 -127.5, 4.2 16 -158.3, 3.7 "
                "11.8 -188.7, 3.3 4.1 -218.9, 3.1 -10.8 -246.8, 2.9 -29.5 -270.5",
                lead=1,
            ),
            # The same, on the other side.
            Line(
                "back",
                "-7.2 16.6 -8.7, -6.5 16 -38.5, -5.9 15.7 -68.1, -5.3 16 -97.5, -4.7 16.8 -127.5, -4.2 16 -158.3, "
                "-3.7 11.8 -188.7, -3.3 4.1 -218.9, -3.1 -10.8 -246.8, -2.9 -29.5 -270.5",
                lead=1,
            ),
            # Bends its upper part forwards.
            Line(
                "upper front",
                "0 -12.7 -9.4, 0 -10.6 -39.1, 0 -8.4 -69, 0 -5.6 -99, 0 -2.5 -128.4",
                lead=1,
            ),
        ),
    ),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("bodies", nargs="*", help="names of bodies; all of them if left out")
    options = parser.parse_args()
    print(f"{machine()}; networks drawn by hand\n")
    print("| body | winches | cables | mm rms |\n|---|---|---|---|")
    for name in options.bodies or BODIES:
        body, robot = BODIES[name], hand_network(name)
        error = judged(robot, list(robot.poses.values()), body.constraints)
        print(f"| {name} | {len(robot.winches)} | {len(robot.cables)} | {1e3 * error:.2f} |", flush=True)
        for wrong in violations(robot, body.constraints, Region.of_body(robot.body, body.constraints.clearance)):
            print(f"  cannot be built: {wrong}")


if __name__ == "__main__":
    main()
