"""How far the flat model is from the filled body, for each face that its cables may be sewn on.

    python lab/flat_or_round/flat_or_round.py [--bodies starfish,puppy] [--element-size MM] [--table | --along]

A flat robot's poses are solved by inverse kinematics; the same contractions are played on the body in space that its
outline becomes when it is filled (`hydrostat.robot.inflated_robot`). Columns, in mm: how far a marker moves in the flat
model, `moved`; how far it comes out of the plane, `out`; how far it is from the flat model within the plane, `aside`:
each the largest over markers and poses. Then rms errors of poses: in the flat model, `flat`; on the filled body with
its commands, `played`, and with commands solved there, `solved`. `N` are the largest tensions; `s` is the CPU of all
poses of a face.

With `--table` the body lies on a hard table under its weight, its pins clamped at their height: `up`, with the sewn
face up, `down`, with it on the table; how far markers leave the plane, against the body in the air. With `--along` the
first pose is played in pairs by shares of its contractions: how far the marker that moves most leaves the plane, and
how far it would give way to a newton across the plane; where that grows without bound, the limb buckles.
"""

import argparse
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace

from design_bodies import BODIES, body_robot
from machine import machine

import numpy as np  # isort: skip

from hydrostat.ik import Limits, solve_ik
from hydrostat.mechanics import Energy
from hydrostat.robot import CableSide, PoseTarget, gravity_along, inflated_robot
from hydrostat.simulation import Equilibrium, Simulation, solve_stuffed_motion

EVERY = ("starfish", "robot", "pig", "letter_e", "letter_s", "puppy", "squid")


def rows(name: str, element_size: float | None) -> Iterator[str]:
    """The lines of one body, one for each face."""
    robot = body_robot(name)
    simulation, limits = Simulation(robot), Limits(tension=BODIES[name].constraints.tension_limit)
    poses = [solve_ik(simulation, pose, limits=limits).pose for pose in robot.poses.values()]
    pull = max(float(pose.tensions.max(initial=0.0)) for pose in poses)
    for face in (face for face in CableSide if face is not CableSide.BACK):
        began = time.process_time()
        found = solve_stuffed_motion(robot, [pose.contractions for pose in poses], face, element_size=element_size)
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


class Table(Energy):
    """A table under the body: a spring for each node that is below its top."""

    def __init__(self, nodes: int, top: float, stiffness: float) -> None:
        """Take its height [m] and the stiffness of each spring [N/m]."""
        self.stencils, self.top, self.stiffness = np.arange(nodes)[:, None], top, stiffness

    def value(self, nodes, controls):
        """Energy of all springs [J]."""
        return float(0.5 * self.stiffness * (np.minimum(nodes[:, 2] - self.top, 0.0) ** 2).sum())

    def gradient(self, nodes, controls):
        """Forces along z [N]."""
        found = np.zeros((len(nodes), 1, 3))
        found[:, 0, 2] = self.stiffness * np.minimum(nodes[:, 2] - self.top, 0.0)
        return found

    def hessian(self, nodes, controls):
        """Their stiffness where they touch [N/m]."""
        found = np.zeros((len(nodes), 3, 3))
        found[:, 2, 2] = self.stiffness * (nodes[:, 2] < self.top)
        return found


STIFF = 500.0  # of the table under each node [N/m]


def table_rows(name: str, element_size: float | None) -> Iterator[str]:
    """A line for each face: in the air, and on a table."""
    robot = body_robot(name)
    pulled = [solve_ik(Simulation(robot), pose).pose.contractions for pose in robot.poses.values()]
    for face, lies in ((CableSide.FRONT, "up"), (CableSide.BACK, "down"), (CableSide.PAIRS, "both")):
        solid = replace(inflated_robot(robot, face, element_size=element_size), gravity=gravity_along("-z", 3))
        mesh = solid.body.mesh
        table = Table(len(mesh.nodes), float(mesh.nodes[:, 2].min()), STIFF)
        air, lying = ([Simulation(solid, energies=more).solve(each) for each in pulled] for more in ((), (table,)))
        sunk = max(max(0.0, table.top - float(pose.nodes[:, 2].min())) for pose in lying)
        yield f"| {name} | {lies} | {1e3 * out(air):.1f} | {1e3 * out(lying):.1f} | {1e3 * sunk:.1f} |"


def out(poses: Sequence[Equilibrium]) -> float:
    """How far the farthest marker leaves the plane [m]."""
    return max(abs(float(place[2])) for pose in poses for place in pose.markers.values())


SHARES = (0.0, 0.4, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 1.0)


def along_rows(name: str, element_size: float | None) -> Iterator[str]:
    """A line for each share of the contractions of the first pose."""
    robot = body_robot(name)
    flat, solid = Simulation(robot), Simulation(inflated_robot(robot, CableSide.PAIRS, element_size=element_size))
    reached = solve_ik(flat, next(iter(robot.poses.values()))).pose
    marker = max(robot.markers, key=lambda one: float(np.linalg.norm(reached.markers[one.name] - one.at)))
    mesh = solid.robot.body.mesh
    near = np.linalg.norm(mesh.nodes - [*marker.at, 0.0], axis=1) < PATCH
    push = np.zeros(mesh.nodes.shape)
    push[near, 2] = 1.0 / near.sum()
    for share in SHARES:
        pose = solid.solve(share * reached.contractions)
        stiffness = pose.result.stiffness
        gives = float("nan") if stiffness is None else float(push.ravel() @ stiffness.solve(push.ravel()))
        high = float(pose.markers[marker.name][2])
        yield (
            f"| {name} | {len(mesh.nodes)} | {share:g} | {1e3 * share * reached.contractions.max():.1f} | "
            f"{marker.name} | {1e3 * high:.2f} | {1e3 * gives:.0f} |"
        )


PATCH = 0.025  # the push is spread over all nodes so near to the marker [m]


def rms(poses: Sequence[Equilibrium], targets: Sequence[PoseTarget]) -> float:
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
    parser.add_argument("--table", action="store_true", help="lying on a table")
    parser.add_argument("--along", action="store_true", help="along the way to the first pose, in pairs")
    given = parser.parse_args()
    print(machine())
    print()
    heads, lines = "body | face | moved | out | aside | flat | played | solved | N flat | N filled | nodes | s", rows
    if given.table:
        heads, lines = "body | sewn face | out in the air | out on a table | sunk into it", table_rows
    elif given.along:
        heads, lines = "body | nodes | share | taken in | marker | out | gives way [mm/N]", along_rows
    print(f"| {heads} |")
    print("|" + "---|" * (heads.count("|") + 1))
    for name in given.bodies.split(","):
        for line in lines(name, None if given.element_size is None else 1e-3 * given.element_size):
            print(line, flush=True)


if __name__ == "__main__":
    main()
