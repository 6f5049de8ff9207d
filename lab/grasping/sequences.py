"""Keyframes hand over, rock and spin a box in the gallery's gripper: net motion over friction, and films.

    python lab/grasping/sequences.py [--friction 0.3 0.5 0.8] [--step 0.05] [--films DIR] [SEQUENCE ...]

After Fig 4.9 of the thesis, in space and under gravity: the gripper looks down. A spring of 500 N/m holds a box of 5 g
until two fingers have closed on it. From then on, the fingers alone hold it. Keyframes are set by hand. A coarse mesh
of 633 nodes saves time. A run ends when the box has fallen by 30 mm.
"""

import argparse
import time
from dataclasses import dataclass, replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

from manifold3d import Manifold
from objects import stl_text

import hydrostat as hs
from hydrostat.plot import Frame
from hydrostat.robot import Body, Contact, Obstacle, Robot, closed_mesh, gravity_along
from hydrostat.simulation import find_contacts
from hydrostat_lab.held_object import HeldObject, contractions
from hydrostat_lab.keyframes import ease, save_film

ELEMENT_SIZE, VISCOSITY, MASS = 15e-3, 400.0, 5e-3
"""Size of elements [m], shear viscosity of the foam [Pa s], mass of the box [kg]."""

HOLD, SECONDS, FALLEN, LIGHT = 500.0, 0.5, 30e-3, 5e-3
"""Spring [N/m], time between keyframes [s], way after which the box is lost [m], force that is not listed [N]."""


@dataclass(frozen=True)
class Sequence:
    """Box and keyframes: parts of names of winches with their contractions [mm]; later parts win."""

    size: tuple[float, float, float]  # [mm]
    height: float  # of its center above the palm's [mm]
    keys: dict[str, dict[str, float]]  # the fingers alone hold the box after the first one


SEQUENCES = {
    "hand over": Sequence(
        (24, 24, 50),
        92,
        {
            "closed": {"back": 30, "front": 30},
            "held": {"back": 30, "front": 30},
            "all four": {"": 30},
            "others opened": {"right": 30, "left": 30},
            "later": {"right": 30, "left": 30},
        },
    ),
    "rock": Sequence(
        (12, 30, 40),
        96,
        {
            "closed": {"right": 24, "left": 24},
            "held": {"right": 24, "left": 24},
            "to": {"right a": 25.5, "right b": 22.5, "left a": 25.5, "left b": 22.5},
            "fro": {"right a": 22.5, "right b": 25.5, "left a": 22.5, "left b": 25.5},
            "back": {"right": 24, "left": 24},
        },
    ),
    "spin": Sequence(
        (50, 10, 20),
        100,
        {
            "closed": {"back": 24, "front": 24},
            "held": {"back": 24, "front": 24},
            "pushed": {"back": 24, "front": 24, "right": 10},
            "pushed past": {"back": 24, "front": 24, "right": 24},
            "drawn back": {"back": 24, "front": 24},
        },
    ),
}


def load_gripper(sequence: Sequence, friction: float) -> Robot:
    """Return the coarse gripper, fingers down, with the box of a sequence between them."""
    robot = hs.load_robot("gallery:caging_gripper")
    fine = robot.body
    material = replace(fine.material, viscosity=VISCOSITY)
    size = {"element_size": ELEMENT_SIZE, "volume": fine.volume}
    coarse = Body.from_surface(fine.content, file=fine.file, unit=1e-3, material=material, **size)
    solid = closed_mesh(stl_text(Manifold.cube(sequence.size, center=True)).encode(), "box.stl")
    at = (0.0, 0.0, 1e-3 * sequence.height)
    box = Obstacle(name="box", shape="mesh", at=at, mesh=solid, mass=MASS, friction=friction)
    return replace(robot, body=coarse, gravity=gravity_along("+z", 3), contact=Contact(), obstacles=(box,))


def finger_forces(held: HeldObject) -> dict[str, float]:
    """Return the force of each finger that touches the object [N]."""
    rest, markers = held.robot.body.mesh.nodes, held.robot.markers
    forces: dict[str, np.ndarray] = {}
    for touch in find_contacts(held.simulation, held.motion.pose):
        if touch.obstacle == held.object.name:
            node = rest[np.argmin(np.linalg.norm(held.motion.nodes - touch.place, axis=1))]
            finger = max(markers, key=lambda marker: float(node[:2] @ np.array(marker.at[:2]))).name
            forces[finger] = forces.get(finger, 0.0) - touch.force
    return {finger: size for finger, force in forces.items() if (size := float(np.linalg.norm(force))) > LIGHT}


def run(name: str, friction: float, step: float, films: Path | None) -> None:
    """Print a row for each keyframe of a sequence, and write a film if asked."""
    sequence, frames, began = SEQUENCES[name], [], time.process_time()
    robot = load_gripper(sequence, friction)
    held = HeldObject(robot, hold=HOLD, turning=HOLD, tolerance=1e-5)
    goal, first = np.zeros(len(robot.winches)), next(iter(sequence.keys))
    for key, parts in sequence.keys.items():
        begin, goal = goal, contractions(robot, parts)
        for motion in ease(held.advance, begin, goal, seconds=SECONDS, step=step):
            words = f"friction {friction:g}, {key}: turned by {np.linalg.norm(held.rotation):.0f} degrees"
            frames.append(Frame.of(motion, words=words, obstacles=[held.current_obstacle()]))
            if is_lost := held.place[2] - held.start_place[2] > FALLEN:
                break
        if key == first:
            held.release()
        moved, forces = held.place - held.start_place, finger_forces(held)
        turned, shift = (", ".join(f"{value:.1f}" for value in row) for row in (held.rotation, 1e3 * moved))
        fingers = ", ".join(f"{finger} {force:.2f}" for finger, force in forces.items()) or "none"
        print(
            f"| {name} | {friction:g} | {key} | {turned} | {np.linalg.norm(held.rotation):.0f} | {shift} | {fingers} | "
            f"{motion.tensions.max():.1f} | {time.process_time() - began:.0f} |",
            flush=True,
        )
        if is_lost:
            break
    if films is not None:
        save_film(robot, frames, films / f"{name.replace(' ', '_')}_{friction:g}.gif", step)


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sequences", nargs="*", default=list(SEQUENCES))
    parser.add_argument("--friction", type=float, nargs="+", default=[0.3, 0.5, 0.8])
    parser.add_argument("--step", type=float, default=0.05, help="in time [s]")
    parser.add_argument("--films", type=Path)
    given = parser.parse_args()
    print(machine())
    print("| sequence | friction | keyframe | turned about x, y, z, degrees | in all | moved x, y, z mm ", end="")
    print("| fingers, N | tightest cable N | CPU s |\n|" + 9 * "---|")
    for name in given.sequences:
        for friction in given.friction:
            run(name, friction, given.step, given.films)


if __name__ == "__main__":
    main()
