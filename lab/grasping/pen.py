"""Two keyframes roll a pen between two soft fingers in the plane; the net turn over friction.

    python lab/grasping/pen.py [--friction 0.3 0.5 0.8] [--step 0.1] [--films DIR]

After Fig 5.7 of the thesis, in the plane of thumb and index finger, with the pen seen end on. A finger has two cables:
`a` on its inner side bends it onto the pen, `b` on its outer side lifts it off, and both shorten it. Two fingers press,
one of them shortened, and roll the pen as they change over. A weak spring holds the pen in place of gravity and of the
other fingers. Nothing but drag and the fingers keeps it from turning. In the end the fingers are open again: the turn
that is left is the net turn.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

from hydrostat.arrays import Points, Vector
from hydrostat.geometry import Mesh
from hydrostat.plot import Frame
from hydrostat.robot import Body, Cable, Contact, Material, Obstacle, Pin, Robot, Source, Winch
from hydrostat.simulation import Motion
from hydrostat_lab.held_object import HeldObject
from hydrostat_lab.keyframes import ease, save_film

LENGTH, BREADTH, ROOM = 80e-3, 12e-3, 4e-3
"""Length and breadth of a finger, and its distance from the pen [m]."""

FOAM = Material(young=60e3, poisson=0.3, density=40, viscosity=400.0)
HOLD, DRAG, SECONDS = 100.0, 80.0, 0.5
"""Spring that holds the pen [N/m], drag [1/s], time from one keyframe to the next [s]."""

PEN = Obstacle(name="pen", shape="sphere", at=(48e-3, 0.0), radius=6e-3, mass=0.05, friction=0.5)
KEYS = {
    "index shortened": (0, 0, 14, 14),
    "pressed": (9, 0, 23, 14),
    "rolled": (23, 14, 9, 0),
    "let go": (14, 14, 0, 0),
    "open": (0, 0, 0, 0),
}
"""Contractions of thumb a, b and index a, b [mm]; the pen is held at two keyframes."""


def fingers(cells: int = 8) -> Robot:
    """Return thumb (below) and index finger (above), held at x = 0, with the pen between them."""
    nodes, elements, cables = [], [], []
    for number, (name, side) in enumerate((("thumb", -1.0), ("index", 1.0))):
        points, triangles = _strip(cells)
        middle = side * ((PEN.radius or 0.0) + ROOM + 0.5 * BREADTH)
        nodes.append(points + np.array([0.0, middle]))
        elements.append(triangles + number * len(points))
        for cable, off in (("a", -0.4), ("b", 0.4)):
            y = middle + side * off * BREADTH
            along = tuple((float(x), y) for x in np.linspace(2e-3, LENGTH - 3e-3, 6))
            cables.append(Cable(winch=f"{name} {cable}", points=along, smoothing=0.2e-3))
    mesh = Mesh(np.concatenate(nodes), np.concatenate(elements))
    body = Body(source=Source.MESH, file="fingers.vtk", content=b"", material=FOAM, thickness=0.02, mesh=mesh)
    return Robot(
        name="two_fingers",
        body=body,
        pins=(Pin(box=((-1e-4, -0.1), (1e-4, 0.1))),),
        winches=tuple(Winch(name=cable.winch, at=cable.points[0], travel=40e-3) for cable in cables),
        cables=tuple(cables),
        poses={},
        contact=Contact(distance=0.5e-3),
    )


def _strip(cells: int) -> tuple[Points, np.ndarray]:
    """Return nodes and triangles of [0, LENGTH] x [-BREADTH/2, BREADTH/2], its diagonals alternating."""
    x, y = np.meshgrid(np.linspace(0, LENGTH, cells + 1), np.linspace(-0.5 * BREADTH, 0.5 * BREADTH, 3))
    triangles = []
    for row in range(2):
        for column in range(cells):
            a = row * (cells + 1) + column
            b, c, d = a + 1, a + cells + 2, a + cells + 1
            even = (row + column) % 2 == 0
            triangles += [(a, b, c), (a, c, d)] if even else [(a, b, d), (b, c, d)]
    return np.column_stack([x.ravel(), y.ravel()]), np.array(triangles)


class HeldPen(HeldObject):
    """Two fingers and a pen between them, from keyframe to keyframe."""

    def __init__(self, friction: float) -> None:
        robot = replace(fingers(), obstacles=(replace(PEN, friction=friction),))
        super().__init__(robot, hold=HOLD, tolerance=1e-5, drag=DRAG)
        self.turned = 0.0  # [degree], also beyond a full turn

    def advance(self, goal: Vector, step: float) -> Motion:
        """Return the motion one step [s] later."""
        motion = super().advance(goal, step)
        axis, before = self.axes[0] @ self.start_axes.T, np.deg2rad(self.turned)
        change = np.arctan2(axis[1], axis[0]) - before
        self.turned = float(np.rad2deg(before + (change + np.pi) % (2 * np.pi) - np.pi))
        return motion

    def drawn(self) -> list[Obstacle]:
        """Return the pen where it is, with a dot that shows how it turns."""
        radius = self.object.radius or 0.0
        dot = self.place + 0.55 * radius * self.axes[0]
        mark = Obstacle(name="dot", shape="sphere", at=tuple(dot.tolist()), radius=0.3 * radius)
        return [replace(self.object, at=tuple(self.place.tolist())), mark]


def run(friction: float, step: float, films: Path | None) -> None:
    """Print a row for each keyframe, and write a film if asked."""
    held, frames, began = HeldPen(friction), [], time.process_time()
    goal = np.zeros(4)
    for key, taken in KEYS.items():
        begin, goal = goal, 1e-3 * np.array(taken, dtype=float)
        for motion in ease(held.advance, begin, goal, seconds=SECONDS, step=step):
            words = f"friction {friction:g}, {key}: turned by {held.turned:.0f} degrees"
            frames.append(Frame.of(motion, words=words, obstacles=held.drawn()))
        x, y = 1e3 * (held.place - held.start_place)
        print(
            f"| {friction:g} | {key} | {held.turned:.0f} | {x:.1f}, {y:.1f} | {motion.tensions.max():.1f} | "
            f"{time.process_time() - began:.0f} |",
            flush=True,
        )
    if films is not None:
        save_film(held.robot, frames, films / f"pen_{friction:g}.gif", step)


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--friction", type=float, nargs="+", default=[0.3, 0.5, 0.8])
    parser.add_argument("--step", type=float, default=0.1, help="in time [s]")
    parser.add_argument("--films", type=Path)
    given = parser.parse_args()
    print(machine())
    print("| friction | keyframe | turned, degrees | moved x, y mm | tightest cable N | CPU s |\n|" + 6 * "---|")
    for friction in given.friction:
        run(friction, given.step, given.films)


if __name__ == "__main__":
    main()
