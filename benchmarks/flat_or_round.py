"""How far the flat model is from the filled body, for each face that its cables may be sewn on.

    python benchmarks/flat_or_round.py [--bodies starfish,puppy] [--element-size MM]

A flat robot's poses are solved by inverse kinematics; the same contractions are played on the body in space that its
outline becomes when it is filled (`hydrostat.robot.inflated_robot`). Columns, in mm: how far a marker moves in the flat
model, `moved`; how far it comes out of the plane, `out`; how far it is from the flat model within the plane, `aside`:
each the largest over markers and poses. Then rms errors of poses: in the flat model, `flat`; on the filled body with
its commands, `played`, and with commands solved there, `solved`. `N` are the largest tensions; `s` is the CPU of all
poses of a face.
"""

import argparse
import time
from collections.abc import Iterator, Sequence

from design_bodies import BODIES, body_robot
from machine import machine

import numpy as np  # isort: skip

from hydrostat.ik import Limits, solve_ik
from hydrostat.robot import Face, Pose, inflated_robot
from hydrostat.simulation import Simulation, SolvedPose, filled_motion

EVERY = ("starfish", "robot", "pig", "letter_e", "letter_s", "puppy", "squid")


def rows(name: str, element_size: float | None) -> Iterator[str]:
    """The lines of one body, one for each face."""
    robot = body_robot(name)
    simulation, limits = Simulation(robot), Limits(tension=BODIES[name].constraints.tension_limit)
    poses = [solve_ik(simulation, pose, limits=limits).pose for pose in robot.poses.values()]
    pull = max(float(pose.tensions.max(initial=0.0)) for pose in poses)
    for face in (face for face in Face if face is not Face.BACK):
        began = time.process_time()
        found = filled_motion(robot, [pose.contractions for pose in poses], face, element_size=element_size)
        seconds = time.process_time() - began
        solid = Simulation(inflated_robot(robot, face, element_size=element_size))
        targets = list(solid.robot.poses.values())
        played = rms([solid.solve(pose.contractions) for pose in poses], targets)
        solved = rms([solve_ik(solid, target, limits=limits).pose for target in targets], targets)
        yield (
            f"| {name} | {face} | {1e3 * found.moved:.1f} | {1e3 * found.out:.2f} | {1e3 * found.aside:.2f} | "
            f"{1e3 * rms(poses, list(robot.poses.values())):.2f} | {1e3 * played:.2f} | {1e3 * solved:.2f} | "
            f"{pull:.1f} | {found.tension:.1f} | {found.nodes} | {seconds:.1f} |"
        )


def rms(poses: Sequence[SolvedPose], targets: Sequence[Pose]) -> float:
    """Root of the mean squared distance of the markers from their targets over all poses [m]."""
    squares = [
        np.mean([np.sum(np.subtract(pose.markers[name], place) ** 2) for name, place in target.targets.items()])
        for pose, target in zip(poses, targets, strict=True)
    ]
    return float(np.sqrt(np.mean(squares)))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bodies", default=",".join(EVERY))
    parser.add_argument("--element-size", type=float, help="of the tetrahedra [mm]")
    given = parser.parse_args()
    print(machine())
    print()
    print("| body | face | moved | out | aside | flat | played | solved | N flat | N filled | nodes | s |")
    print("|" + "---|" * 12)
    for name in given.bodies.split(","):
        for line in rows(name, None if given.element_size is None else 1e-3 * given.element_size):
            print(line, flush=True)


if __name__ == "__main__":
    main()
