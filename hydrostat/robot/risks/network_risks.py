"""Risks of winches and cables."""

from collections.abc import Collection, Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from hydrostat.arrays import Bool, Float, Points
from hydrostat.geometry import clearance, locate
from hydrostat.robot.body import Body
from hydrostat.robot.cable import Cable
from hydrostat.robot.risks.words import Risk, known_up_to, merge_risks, mm, place
from hydrostat.robot.robot import Robot
from hydrostat.robot.winch import Mount


def winch_risks(robot: Robot) -> Iterator[str]:
    """Winches that pull nothing or too far, collide, or stick out."""
    yield from merge_risks(_idle(robot))
    yield from merge_risks(_too_far(robot))
    yield from merge_risks(_collisions(robot))
    yield from merge_risks(_sticking_out(robot))


def cover(body: Body, points: Points) -> Float[np.ndarray, " points"]:
    """Distance of points from the edge of a flat body, as drawn, or from the surface of a body in space [m]."""
    if body.outline is None:
        return clearance(body.mesh, points)
    from shapely import distance
    from shapely import points as shapely_points

    return np.asarray(distance(body.outline.polygon.boundary, shapely_points(points)))


def _name(robot: Robot, index: int) -> str:
    return f"winch[{index}] {robot.winches[index].name}"


def _cable_name(robot: Robot, index: int) -> str:
    """Number of a cable in its file, with its name if one was given."""
    name = robot.given_cable_names[index]
    return f"cable[{index}]" + (f' "{name}"' if name else "")


def _idle(robot: Robot) -> Iterator[Risk]:
    for index, winch in enumerate(robot.winches):
        if not any(cable.winch == winch.name for cable in robot.cables):
            yield Risk(_name(robot, index), 0.0, "pulls no cable")
        elif winch.release == 0 and any(cable.reverse for cable in robot.cables if cable.winch == winch.name):
            yield Risk(_name(robot, index), 0.0, "has a reversed cable but no release, so that it never pulls it")


def _too_far(robot: Robot) -> Iterator[Risk]:
    """Travel or release longer than a cable is."""
    for index, winch in enumerate(robot.winches):
        pulled = [
            (abs(ratio), float(cable.segments[cable.bare].sum()))
            for cable, ratio in zip(robot.cables, robot.spool_ratios, strict=True)
            if cable.winch == winch.name
        ]
        if not pulled:
            continue
        ratio, length = min(pulled, key=lambda one: one[1] / one[0])
        for key, far in (("travel", winch.travel), ("release", winch.release)):
            if ratio * far > length:
                step = "" if ratio == 1 else f", {mm(ratio * far)} at its spool,"
                text = (
                    f"the {key} of {mm(far)}{step} is longer than a cable that it pulls ({mm(length)} outside sheaths)"
                )
                yield Risk(_name(robot, index), ratio * far / length, text)


def _collisions(robot: Robot) -> Iterator[Risk]:
    for index, winch in enumerate(robot.winches):
        for other in robot.winches[:index]:
            gap = float(np.linalg.norm(np.subtract(winch.at, other.at)))
            need = robot.largest_spool(winch) + robot.largest_spool(other)
            if gap < need:
                text = f"spool overlaps that of winch {other.name}: {mm(gap)} apart, need {mm(need)}. Move one winch"
                yield Risk(_name(robot, index), -gap, text)


def _sticking_out(robot: Robot) -> Iterator[Risk]:
    inside = [index for index, winch in enumerate(robot.winches) if winch.mount is Mount.BODY]
    if not inside:
        return
    depths = cover(robot.body, np.array([robot.winches[index].at for index in inside], dtype=float))
    for index, depth in zip(inside, depths, strict=True):
        radius = robot.largest_spool(robot.winches[index])
        if depth < radius:
            edge = "edge" if robot.body.mesh.dim == 2 else "surface"
            text = f"a spool of radius {mm(radius)} sticks out, the {edge} is {mm(float(depth))} away; move it inward"
            yield Risk(_name(robot, index), radius - depth, text)


MIN_COVER = 0.003  # a cable nearer to the edge or the surface than this [m] tears out
SEWN_DEPTH = 0.004  # a point of a cable at most so deep in a body of foam [m] is sewn to its skin
_STEP = 0.5 * MIN_COVER  # distance of the places at which a cable is looked at [m]
_MAX_STEPS = 400  # places on one segment
MAX_FREE_SHARE = 0.15
"""Length of a line that may run free from one rigid part to the next, as a share of the body's size."""


def cable_risks(robot: Robot) -> Iterator[str]:
    """Cables that leave the body, tear out of it, or would squeeze it too far."""
    leaving = list(_leaving(robot))
    yield from merge_risks(leaving)
    gone = {risk.part for risk in leaving}
    yield from merge_risks(risk for risk in _near_the_surface(robot) if risk.part not in gone)
    yield from merge_risks(_squeezing(robot))


def _points_in_body(robot: Robot, cable: Cable) -> Points:
    outside = robot.winch(cable.winch).mount is Mount.WORLD
    return np.array(cable.points[1:] if outside else cable.points, dtype=float)


def _sample_line(points: Points) -> Float[np.ndarray, "places dim"]:
    """Points and places between them, at most `_STEP` apart, with `_MAX_STEPS` on a segment at most."""
    places = [points[:1]]
    for start, end in pairwise(points):
        steps = min(int(np.ceil(np.linalg.norm(end - start) / _STEP)), _MAX_STEPS)
        places.append(start + np.linspace(0, 1, max(steps, 1) + 1)[1:, None] * (end - start))
    return np.concatenate(places)


def _leaving(robot: Robot) -> Iterator[Risk]:
    """Cables of which a straight piece lies outside: of a drawing however little, of a mesh more than a corner."""
    corner = 0.02  # a straight line may cut a corner of a coarse surface by this many elements
    spans = 1e-3  # a line that is sewn to the skin may span a dent by this [m]
    for index, cable in enumerate(robot.cables):
        inside = _points_in_body(robot, cable)
        if len(inside) < 2:
            continue
        if robot.body.outline is None:
            runs = [_sample_line(inside[at : at + 2]) for at in np.flatnonzero(~_spans_rigid_parts(robot.body, inside))]
            if not runs:
                continue
            places = np.concatenate(runs)
            out = locate(robot.body.mesh, places).distances
            sewn = cover(robot.body, inside).max() <= SEWN_DEPTH
            leaves = out.max() > max(corner * float(np.median(robot.body.mesh.spacings)), spans if sewn else 0.0)
        else:
            from shapely import LineString, distance, points

            places = _sample_line(inside)
            drawing, line = robot.body.outline.polygon, LineString(inside)
            leaves = not drawing.covers(line)
            if leaves:  # the middle of what is outside too: a slit may be narrower than a step
                places = np.concatenate([places, [line.difference(drawing).centroid.coords[0]]])
            out = np.asarray(distance(drawing, points(places)))
        if leaves:
            where = place(places[np.argmax(out)])
            way = "add a point to lead it round, unless it crosses a slit"
            text = f"leaves the body by {mm(float(out.max()))} at {where}; {way}"
            yield Risk(_cable_name(robot, index), float(out.max()), text)


def _spans_rigid_parts(body: Body, points: Points) -> Bool[np.ndarray, " segments"]:
    """True for short segments from one rigid part to another, such as disks of a spine: the line runs free there."""
    anchors, parts = locate(body.mesh, points), np.zeros(len(points), dtype=int)
    for index, part in enumerate(body.parts, start=1):
        if part.is_rigid:
            in_part = np.zeros(len(body.mesh.nodes), dtype=bool)
            in_part[body.mesh.elements[body.element_materials == index]] = True
            parts[np.all(in_part[anchors.stencils] | (anchors.weights < 1e-9), axis=1)] = index
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    apart = (parts[:-1] > 0) & (parts[1:] > 0) & (parts[:-1] != parts[1:])
    return apart & (lengths <= MAX_FREE_SHARE * body.mesh.size)


def _near_the_surface(robot: Robot) -> Iterator[Risk]:
    """Cables that tear out: holes near the edge of cloth; in foam also runs between two points deeper than the skin."""
    flat = robot.body.mesh.dim == 2
    for index, cable in enumerate(robot.cables):
        inside = _points_in_body(robot, cable)
        places = inside if flat else _unsewn_places(robot.body, inside)
        if robot.winch(cable.winch).mount is Mount.WORLD:  # it has to come in somewhere
            places = places[np.linalg.norm(places - inside[0], axis=1) > 2 * MIN_COVER]
        if not len(places):
            continue
        depths = cover(robot.body, places)
        if depths.min() < MIN_COVER:
            nearest = int(np.argmin(depths))
            edge = f"{'edge' if flat else 'surface'} at {place(places[nearest])}"
            text = f"only {mm(float(depths[nearest]))} inside the {edge}, it may tear out"
            yield Risk(_cable_name(robot, index), -float(depths[nearest]), text)


def _unsewn_places(body: Body, inside: Points) -> Float[np.ndarray, "places dim"]:
    """Places along the runs of a cable in space of which neither end is sewn to the skin."""
    deep = cover(body, inside) > SEWN_DEPTH
    runs = [_sample_line(inside[at : at + 2]) for at in np.flatnonzero(deep[:-1] & deep[1:])]
    return np.concatenate([inside[:0], *runs])


def _length_inside(robot: Robot, cable: Cable) -> float:
    """Length of a cable outside sheaths and inside the body [m]; the rest cannot be compressed."""
    length = float(cable.segments[cable.bare].sum())
    if robot.winch(cable.winch).mount is Mount.BODY or not cable.bare[0]:
        return length
    way = np.linspace(cable.points[0], cable.points[1], 201)
    return length - float(cable.segments[0]) * float((robot.body.distances(way) > 0).mean())


def _safe_ranges(robot: Robot) -> tuple[dict[str, float], dict[str, float]]:
    """Largest travel and release of each winch that neither use up a cable nor squeeze the body too far [m]."""
    travels = {winch.name: winch.travel for winch in robot.winches}
    releases = {winch.name: winch.release for winch in robot.winches}
    for cable, ratio in zip(robot.cables, robot.spool_ratios, strict=True):
        found = releases if cable.reverse else travels
        found[cable.winch] = min(found[cable.winch], _squeezing_travel(robot, cable, abs(float(ratio))))
    return travels, releases


def limit_travels(robot: Robot, kept: Collection[str] = ()) -> Robot:
    """The robot with travels that neither use up a cable nor squeeze the body too far, rounded down to a millimeter.

    So are releases that pull reversed cables. Winches that are kept, by name, stay as they are.
    """
    travels, releases = _safe_ranges(robot)
    winches = [
        winch
        if winch.name in kept
        else replace(
            winch,
            travel=_round_down(winch.travel, travels[winch.name]),
            release=_round_down(winch.release, releases[winch.name]),
        )
        for winch in robot.winches
    ]
    return robot.with_network(winches, robot.cables)


def _round_down(length: float, most: float) -> float:
    """A length [m], or a millimeter or more below its maximum."""
    return length if most >= length else max(int(1e3 * most) / 1e3, 1e-3)


def _squeezing_travel(robot: Robot, cable: Cable, ratio: float) -> float:
    """Travel at which a cable has squeezed the body as far as the material is known, or is used up [m]."""
    share = robot.body.material.largest_squeeze
    return ((1.0 if share is None else share) * _length_inside(robot, cable) + cable.slack) / ratio


def _squeezing(robot: Robot) -> Iterator[Risk]:
    """Estimate compression from lengths alone: the body along a cable must shorten by the winch's contraction."""
    material = robot.body.material
    if material.largest_squeeze is None:
        return
    for index, (cable, ratio) in enumerate(zip(robot.cables, robot.spool_ratios, strict=True)):
        winch = robot.winch(cable.winch)
        key, far = ("release", winch.release) if cable.reverse else ("travel", winch.travel)
        length = _length_inside(robot, cable)
        taken = abs(float(ratio)) * far
        squeeze = (taken - cable.slack) / length
        if taken <= length and squeeze > material.largest_squeeze:
            most = _squeezing_travel(robot, cable, abs(float(ratio)))
            limit = known_up_to(material, f"{100 * material.largest_squeeze:.0f} %")
            text = (
                f"the full {key} of {mm(far)} would squeeze the body along the cable by "
                f"{100 * squeeze:.0f} % on average; {limit}; a {key} of {mm(most)} stays within"
            )
            yield Risk(_cable_name(robot, index), squeeze, text)
