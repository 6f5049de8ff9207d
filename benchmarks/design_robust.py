"""What designs are worth once they are built: errors of robots drawn at random, their commands played open loop.

    python benchmarks/design_robust.py [--bodies starfish,puppy] [--methods hand,trees,exact,routes] [--draws 100]
                                       [--held-out 5] [--seeds 3]

A network is found for each body by each method, and its commands by inverse kinematics in the model. Then so many
robots are drawn (`hydrostat.design.Uncertainty`: holes, friction, stiffness, knots, spools), with draws that no design
saw, and solved from rest along the straight loading path with the friction of each. `exact` are routes for a robot
that is built just as its model, as designs were before: cables may cross, lie side by side and turn by 75 degrees.
Further methods, not among those that are usually printed: `reach` are routes with `RouteOptions.reach` of 1, `family`
routes that are designed for the half-way poses too, `two_way` routes whose winches may pull both ways.

Columns, errors in mm rms over markers and poses: `model`, as designed; `built`, median and 90 % of the draws;
`corrected`, the same after one round of correction: up to five markers of each pose are measured on the built robot,
each coordinate to 0.5 mm, and the contractions are solved again in the model for targets moved by what it missed;
`mu 0.3`, 90 % with friction 0.3 in all cables; `held out`, poses that hidden networks reach, solved again in the model.
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace

from design_bodies import BODIES, Body, body_robot
from machine import machine

import numpy as np  # isort: skip

from hydrostat.design import (
    BuildTolerances,
    DesignMethod,
    DesignRequest,
    RouteOptions,
    built_errors,
    corrected_errors,
    find_network,
    nearest_shares,
    turns,
)
from hydrostat.errors import HydrostatError
from hydrostat.ik import Limits, solve_ik
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Simulation

METHODS = ("hand", "trees", "exact", "routes")

EVERY = (
    "starfish",
    "starfish_3",
    "robot",
    "pig",
    "letter_e",
    "letter_s",
    "puppy",
    "squid",
    "five_poses",
    "trunk",
    "fish_tail",
)


def network(method: str, robot: Robot, body: Body, poses: Sequence[PoseTarget]) -> Robot | None:
    """The robot with the network that a method finds; None if it finds none."""
    if method == "hand":
        return robot
    constraints, uncertainty = body.constraints, None
    if method == "exact":
        constraints = replace(constraints, cable_gap=0.0, turn=75.0, built_in=False)
        uncertainty = BuildTolerances.none()
    if method == "two_way":
        constraints = replace(constraints, two_way=True)
    if method == "family":
        poses = [*poses, *(half_way(robot, pose) for pose in poses)]
    request = DesignRequest(
        poses=tuple(poses), winches=body.winches, cables=body.cables, constraints=constraints, uncertainty=uncertainty,
        method=DesignMethod.TREES if method == "trees" else DesignMethod.ROUTES,
        options=RouteOptions(reach=1.0) if method == "reach" else None,
    )  # fmt: skip
    try:
        return find_network(robot, request).robot
    except HydrostatError as error:
        print(f"  {method}: {error}")
        return None


def half_way(robot: Robot, pose: PoseTarget) -> PoseTarget:
    """The pose with each target half as far from where its marker rests."""
    rest = {marker.name: np.array(marker.at) for marker in robot.markers}
    targets = {name: tuple((0.5 * (rest[name] + np.array(to))).tolist()) for name, to in pose.targets.items()}
    return PoseTarget(name=f"{pose.name}, half way", targets=targets)


def row(name: str, method: str, draws: int, held_out: Sequence[PoseTarget]) -> str:
    """One line of the table."""
    robot, body = body_robot(name), BODIES[name]
    poses = list(robot.poses.values())
    began = time.process_time()
    found = network(method, robot, body, poses)
    seconds = time.process_time() - began
    if found is None:
        return f"| {name} | {method} | none found |"
    simulation, limits = Simulation(found), Limits(tension=body.constraints.tension_limit)
    reached = [solve_ik(simulation, pose, limits=limits) for pose in poses]
    commands = [one.pose.contractions for one in reached]
    uncertainty = BuildTolerances.of(robot.body)
    built = built_errors(found, poses, commands, uncertainty, draws=draws, seed=1)
    corrected = corrected_errors(found, reached, uncertainty, limits=limits, draws=draws, seed=1)
    rough = built_errors(found, poses, commands, replace(uncertainty, friction=(0.3, 0.3)), draws=draws, seed=1)
    unseen = [solve_ik(simulation, pose, limits=limits).rms_error for pose in held_out]
    held = f"{1e3 * np.sqrt(np.mean(np.square(unseen))):.2f}" if unseen else ""
    sharp, crossings = sharp_turns(found), crossed(found)
    holes = sum(len(cable.points) - 1 for cable in found.cables)
    pull = max(one.pose.tensions.max() for one in reached)
    return (
        f"| {name} | {method} | {len(found.winches)}/{len(found.cables)} | {1e3 * built.model:.2f} | "
        f"{1e3 * built.median:.2f} | {1e3 * built.most:.2f} | "
        f"{1e3 * corrected.median:.2f} | {1e3 * corrected.most:.2f} | {1e3 * rough.most:.2f} | {held} | {holes} | "
        f"{crossings} | {sharp} | {pull:.1f} | {seconds:.0f} |"
    )


def sharp_turns(robot: Robot) -> int:
    """Via points at which a cable turns by more than 60 degrees."""
    return sum(int((np.degrees(turns(np.array(cable.points))) > 60).sum()) for cable in robot.cables)


def crossed(robot: Robot) -> int:
    """Pairs of segments nearer than 1 mm, but beside a winch that both cables have; adjacent ones left out."""
    runs = [
        (index, at, np.array(cable.points[at : at + 2]))
        for index, cable in enumerate(robot.cables)
        for at in range(len(cable.points) - 1)
    ]
    found = 0
    for number, (index, at, one) in enumerate(runs):
        for other, there, two in runs[number + 1 :]:
            if other == index and there <= at + 1:
                continue
            share, far = nearest_shares(one[None], two[None])
            places = one[0] + share[0] * (one[1] - one[0]), two[0] + far[0] * (two[1] - two[0])
            winch = robot.winch(robot.cables[index].winch)
            beside = (
                robot.cables[other].winch == winch.name
                and max(float(np.linalg.norm(place - winch.at)) for place in places) <= 2 * winch.spool_radius
            )
            found += not beside and float(np.linalg.norm(places[0] - places[1])) < 1e-3
    return found


def poses_of_others(name: str, count: int, seeds: int) -> list[PoseTarget]:
    """Poses that dense hidden networks reach, some for each seed."""
    from design_held_out import HIDDEN, family

    HIDDEN.setdefault(name, 12)
    return [pose for seed in range(seeds) for pose in family(name, seed).held_out[:count]]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bodies", default=",".join(EVERY))
    parser.add_argument("--methods", default=",".join(METHODS))
    parser.add_argument("--draws", type=int, default=100)
    parser.add_argument("--held-out", type=int, default=5)
    parser.add_argument("--seeds", type=int, default=3)
    given = parser.parse_args()
    print(machine())
    print()
    print(
        "| body | method | winches/cables | model | built median | built 90 % | corrected median | "
        "corrected 90 % | mu 0.3 90 % | held out | holes | crossings | turns > 60 | N | CPU s |"
    )
    print("|" + "---|" * 15)
    for name in given.bodies.split(","):
        unseen = poses_of_others(name, given.held_out, given.seeds) if given.held_out else []
        for method in given.methods.split(","):
            if method == "trees" and body_robot(name).body.mesh.dim == 3:
                continue
            print(row(name, method, given.draws, unseen), flush=True)


if __name__ == "__main__":
    main()
