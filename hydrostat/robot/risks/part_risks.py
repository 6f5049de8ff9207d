"""Risks of parts of other materials, and of rods."""

from collections.abc import Iterator

import numpy as np

from hydrostat.geometry import clearance
from hydrostat.robot.risks.words import Risk, merge_risks, mm, place
from hydrostat.robot.robot import Robot
from hydrostat.robot.rod import sample_rod

POINTS = 3000
"""Number of points at which a part is measured."""

MIN_OUTSIDE = 0.03
"""A part of which less than this share lies outside is drawn to the edge."""

MAX_CHANGED = 0.2
"""Largest relative change of the volume of a part by its mesh."""


def part_risks(robot: Robot) -> Iterator[str]:
    """Rigid parts that reach out of the body, parts that the mesh changes, rods that stick out or are too short."""
    found = list(_judge_parts(robot))
    yield from merge_risks(risk for is_outside, risk in found if is_outside)
    yield from merge_risks(risk for is_outside, risk in found if not is_outside)
    yield from merge_risks(_short_rods(robot))
    yield from merge_risks(_thick_rods(robot))


def _judge_parts(robot: Robot) -> Iterator[tuple[bool, Risk]]:
    """Risks of parts, each with True if the part reaches out of the body."""
    body = robot.body
    for index, part in enumerate(body.parts):
        if part.dim < body.mesh.dim:
            continue  # it goes through all of a body in space
        grid, name = part.grid(POINTS), f'body.part[{index}] "{part.name}"'
        own = grid[part.holds(grid)]
        gaps = body.distances(own)
        far, share = float(gaps.max()), float((gaps > 0).mean())
        if part.is_rigid and share > MIN_OUTSIDE and far > 0.1 * float(np.median(body.mesh.spacings)):
            yield (
                True,
                Risk(
                    name,
                    far,
                    f"reaches {mm(far)} out of the body at {place(own[int(np.argmax(gaps))])}; the {100 * share:.0f} % "
                    "outside have neither stiffness nor mass. Draw it to the edge, or enlarge the body",
                ),
            )
        drawn = float(np.prod(np.ptp(grid, axis=0))) * len(own) / len(grid) * (1 - share)
        meshed = float(body.mesh.volumes[body.element_materials == index + 1].sum())
        change = meshed / drawn - 1 if drawn else 0.0
        if abs(change) > MAX_CHANGED:
            text = f"{100 * change:+.0f} % in volume in the mesh; take a smaller element_size"
            yield False, Risk(name, abs(change), text)


def _short_rods(robot: Robot) -> Iterator[Risk]:
    """Rods that are shorter than the elements."""
    side = float(np.median(robot.body.mesh.spacings))
    for index, rod in enumerate(robot.rods):
        if rod.length < side:
            text = f"{mm(rod.length)} long, shorter than an element, {mm(side)}; the mesh cannot show its stiffness"
            yield Risk(f"rod[{index}] {rod.name}", 1 - rod.length / side, f"{text}. Take a smaller element_size")


def _thick_rods(robot: Robot) -> Iterator[Risk]:
    """Rods that stick out of the body sideways."""
    for index, rod in enumerate(robot.rods):
        if rod.diameter is None:
            continue
        places = sample_rod(rod)
        ends = np.minimum(*(np.linalg.norm(places - places[end], axis=1) for end in (0, -1)))
        inner = places[ends >= min(rod.diameter, 0.99 * float(ends.max()))]
        depths = clearance(robot.body.mesh, inner)
        if robot.body.thickness is not None:
            depths = np.minimum(depths, robot.body.thickness / 2)
        out = rod.diameter / 2 - float(depths.min())
        if out > 0:
            where = place(inner[int(np.argmin(depths))])
            text = f"{mm(rod.diameter)} thick, it sticks {mm(out)} out of the body at {where}; move it or thin it"
            yield Risk(f"rod[{index}] {rod.name}", out, text)
