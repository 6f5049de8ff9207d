"""`review_robot`: the one review of a robot before it is built, for fabrication, studio and command line."""

import re
from collections.abc import Iterator

import numpy as np

from hydrostat.design.checks.cables import clearance_violations, gap_violations, hole_violations, turn_violations
from hydrostat.design.checks.parts import Parts
from hydrostat.design.checks.winches import standing_violations
from hydrostat.design.constraints import Constraints
from hydrostat.design.drawn_shapes import find_pinned_drawings
from hydrostat.design.finding import Diagnostic, Severity, places_in
from hydrostat.design.region import body_shell
from hydrostat.design.skin_region import cable_region
from hydrostat.errors import NO_KIT
from hydrostat.fabrication import Demand, KitOptions, find_material_problems, find_refusals
from hydrostat.robot import SEWN_DEPTH, Robot, describe_filled_holes, find_risks


def review_robot(
    robot: Robot,
    *,
    demand: Demand | None = None,
    constraints: Constraints | None = None,
    options: KitOptions | None = None,
) -> tuple[Diagnostic, ...]:
    """Collect diagnostics of a robot before it is built, the most severe first, each with its positions.

    - What a kit is refused for (`find_material_problems`, `find_refusals`): with the demand of its poses all that is
      known before it is made. Without cables it is a warning, as a body may be for simulation alone.
    - Limits of designs that its network does not keep, where constraints are given; one sentence for each kind, with
      the places of all. Travel, release and numbers of cables are limits of the search alone.
    - Risks (`find_risks`), and pins on drawn shapes such as eyes.
    - Holes of the body that its mesh leaves out.

    Raises InputError: an unknown motor, or a demand of another robot.
    """
    known = (*find_material_problems(robot, options=options), *find_refusals(robot, demand, options=options))
    refused = tuple(dict.fromkeys(known))
    risks = (*find_risks(robot), *find_pinned_drawings(robot))
    severity = Severity.REFUSED if robot.cables else Severity.WARNING
    before = "" if robot.cables else NO_KIT
    limits = _limits(robot, constraints) if constraints is not None and robot.cables else ()
    return (
        *(Diagnostic(text=before + text, severity=severity, places=places_in(text, robot)) for text in refused),
        *limits,
        *(Diagnostic(text=text, severity=Severity.WARNING, places=places_in(text, robot)) for text in risks),
        *(
            Diagnostic(text=text, severity=Severity.LIMIT, places=())
            for text in [describe_filled_holes(robot.body)]
            if text
        ),
    )


def _limits(robot: Robot, constraints: Constraints) -> Iterator[Diagnostic]:
    """A finding for each kind of limit: its first sentence, and the places of all."""
    parts = Parts(robot, constraints, cable_region(robot.body, constraints), _sewn_cables(robot))
    for check in (standing_violations, clearance_violations, hole_violations, gap_violations, turn_violations):
        told = list(check(parts))
        if not told:
            continue
        more = _count_others(told)
        places = dict.fromkeys(place for text in told for place in places_in(text, robot))
        yield Diagnostic(text=told[0] + more, severity=Severity.LIMIT, places=tuple(places))


def _sewn_cables(robot: Robot) -> frozenset[int]:
    """Return the numbers of the cables that a kit sews to the skin of a body in space all along."""
    if robot.body.mesh.dim == 2 or find_material_problems(robot):
        return frozenset()
    shell = body_shell(robot.body)
    depths = [-shell.nearest(np.array(cable.points)).distances for cable in robot.cables]
    return frozenset(index for index, depth in enumerate(depths) if depth.max() <= SEWN_DEPTH)


def _count_others(told: list[str]) -> str:
    """Return the number of sentences after the first, in words, and of the cables that all name; empty if it is one."""
    if len(told) == 1:
        return ""
    cables = {number for text in told for number in re.findall(r"cable\[(\d+)\]", text)}
    where = f", on {len(cables)} cables" if len(cables) > 1 else ""
    return f" {len(told) - 1} more such{where}."
