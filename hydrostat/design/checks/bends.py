"""`bend_violations`: how far cables turn, how long and how loose they are, and on which spools they wind."""

from collections.abc import Iterator

import numpy as np

from hydrostat.design.checks.parts import ANGLE, LENGTH, Parts, mm


def bend_violations(parts: Parts) -> Iterator[str]:
    """Turns and arcs that are too sharp, cables that are too long or too loose, spools that differ too much."""
    for index in parts.new_cables:
        yield from _turns(parts, index)
        yield from _sizes(parts, index)
    yield from _spools(parts)


def _turns(parts: Parts, index: int) -> Iterator[str]:
    """The arc fits a turn if it touches both segments no farther from the corner than the middle of the shorter."""
    limits, spans = parts.constraints, np.diff(parts.points[index], axis=0)
    if len(spans) < 2:
        return
    lengths = np.linalg.norm(spans, axis=1)
    units = spans / lengths[:, None]
    before, after = units[:-1], units[1:]
    turns = 2 * np.arctan2(np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1))
    tangents = 0.5 * np.minimum(lengths[:-1], lengths[1:])
    arcs = tangents / np.maximum(np.tan(0.5 * turns), np.finfo(float).tiny)
    gentler = np.tan(0.5 * np.maximum(turns - np.radians(ANGLE), 0.0))
    for corner, (turn, arc) in enumerate(zip(np.degrees(turns), arcs, strict=True)):
        name = f"cable[{index}].points[{corner + 1}]"
        if turn > limits.turn + ANGLE:
            yield f"{name} turns by {turn:.4g} degrees, more than the turn of {limits.turn:g}"
        if limits.bend_radius * gentler[corner] > tangents[corner] + LENGTH:
            yield f"{name} bends with a radius of {mm(arc)}, less than the bend_radius of {mm(limits.bend_radius)}"


def _sizes(parts: Parts, index: int) -> Iterator[str]:
    cable, limits = parts.robot.cables[index], parts.constraints
    if limits.longest is not None and cable.length > limits.longest + LENGTH:
        yield f"cable[{index}] is {mm(cable.length)} long, more than the longest of {mm(limits.longest)}"
    if cable.slack > limits.slack + LENGTH:
        yield f"cable[{index}] has a slack of {mm(cable.slack)}, more than {mm(limits.slack)}"


def _spools(parts: Parts) -> Iterator[str]:
    most, ratios = parts.constraints.spool_ratio * (1 + _ROUNDING), parts.robot.spool_ratios
    for index in parts.new_cables:
        if not 1 / most <= ratios[index] <= most:
            yield (
                f"cable[{index}] winds on a spool {ratios[index]:.4g} times as large as its winch's, "
                f"beyond the spool_ratio of {parts.constraints.spool_ratio:g}"
            )


_ROUNDING = 1e-5
"""Radii are rounded by no larger a share."""
