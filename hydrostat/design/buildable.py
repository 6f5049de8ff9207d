"""`violations` and `pulls`: everything about a network that breaks its constraints."""

from collections.abc import Sequence

import numpy as np

from hydrostat.design.checks.cables import bend_violations, clearance_violations, gap_violations, hole_violations
from hydrostat.design.checks.parts import LENGTH, Parts, mm
from hydrostat.design.checks.winches import mirror_violations, winch_violations
from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.ik import IKResult
from hydrostat.robot import Robot


def violations(robot: Robot, constraints: Constraints, region: Region) -> list[str]:
    """Find violated limits of a network: a sentence with part, value and limit for each broken constraint.

    Lengths may miss a limit by 0.02 mm and angles by 0.1 degrees, for coordinates are rounded to 0.01 mm. What is
    locked is not looked at, but what is new must keep its distances from it. The region is `cable_region(robot.body,
    constraints)`.

    - Points of cables keep the clearance from the edge or surface, straight segments half of it. Where a cable enters
      from the world, or begins at a winch that is locked, neither that point nor a clearance's way on from it counts.
    - Where cables run at a depth under the skin, points lie there to half a millimeter, and straight segments neither
      leave the body nor dive 3 mm deeper.
    - Segments keep out of `keep_out` along their whole length, bare ones out of `passive_zones`; without `leads`,
      sheaths are for `passive_zones` alone.
    - Holes are all points of cables but the first. Two that coincide are one. In the body, winches keep two spool
      radii from holes of cables that others pull.
    - Cables keep the `cable_gap` from each other all along, and two spool radii from winches of others. Two of one
      winch may be nearer within two spool radii of it.
    - The turn where a cable enters from the world does not count: its tube hangs there as it likes. A way back past its
      own winch is refused.
    - The bend at a point is the arc that touches both segments half-way along the shorter.
    - Whether a winch in the world stands where one may is not looked at.
    """
    parts = Parts(robot, constraints, region)
    return [
        *winch_violations(parts),
        *clearance_violations(parts),
        *hole_violations(parts),
        *gap_violations(parts),
        *bend_violations(parts),
        *mirror_violations(parts),
    ]


def pulls(robot: Robot, reached: Sequence[IKResult], constraints: Constraints) -> list[str]:
    """Find loads of poses beyond the limits of winches and cables: sentences on tension, contraction and torque.

    Tensions and torques may exceed their limit by 0.1 %, contractions by 0.02 mm. Travel and release are each winch's
    own. Each sentence names the pose, the part, its value and the limit.
    """
    return [
        sentence for number, one in enumerate(reached) for sentence in _check_pulls(robot, number, one, constraints)
    ]


_SHARE = 1.001  # forces may be so many times their limit: solvers end near it


def _check_pulls(robot: Robot, number: int, reached: IKResult, constraints: Constraints) -> list[str]:
    name = f'pose "{reached.target.name}"' if reached.target is not None else f"pose {number}"
    tensions, contractions = reached.pose.tensions, reached.pose.contractions
    most, found = constraints.tension_limit, []
    found += [
        f"{name}: cable[{index}]: tension too high ({tension:.4g} N). Maximum: {most:.4g} N. "
        "Ease the pose or add cables."
        for index, tension in enumerate(tensions)
        if tension > _SHARE * most
    ]
    for index, (winch, contraction) in enumerate(zip(robot.winches, contractions, strict=True)):
        which = f"{name}: winch[{index}] {winch.name}"
        if contraction > winch.travel + LENGTH:
            found.append(
                f"{which}: contraction too large ({mm(contraction)}). Maximum travel: {mm(winch.travel)}. "
                "Ease the pose or raise travel."
            )
        if contraction < -winch.release - LENGTH:
            found.append(
                f"{which}: payout too large ({mm(-contraction)}). Maximum release: {mm(winch.release)}. "
                "Ease the pose or raise release."
            )
    return found + _check_torques(robot, name, tensions, constraints)


def _check_torques(robot: Robot, name: str, tensions: np.ndarray, constraints: Constraints) -> list[str]:
    """Check motors for torques above their limit."""
    if constraints.torque is None:
        return []
    found = []
    for index, winch in enumerate(robot.winches):
        own = [number for number, cable in enumerate(robot.cables) if cable.winch == winch.name]
        torque = abs(float(winch.spool_radius * (robot.spool_ratios[own] * tensions[own]).sum()))
        if torque > _SHARE * constraints.torque:
            found.append(
                f"{name}: winch[{index}] {winch.name}: torque too high ({torque:.4g} N m). "
                f"Maximum: {constraints.torque:.4g} N m. Ease the pose or raise torque."
            )
    return found
