"""`ShapeTarget`: the body boundary on a target outline or surface; `load_target_outline` reads one from a file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from numbers import Integral
from pathlib import Path

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.errors import InputError
from hydrostat.files import read_stranger
from hydrostat.geometry import Curve, Mesh, Nearest, Outline, Shell, Surface, read_drawing, read_outline
from hydrostat.given import path_of
from hydrostat.ik.objectives.objective import (
    EquilibriumState,
    Jacobian,
    Objective,
    Residual,
    Rows,
    StateJacobian,
    describe,
    not_negative,
)
from hydrostat.robot import Robot, Source
from hydrostat.simulation import Simulation


@dataclass(frozen=True, kw_only=True)
class ShapeTarget(Objective):
    """Target shape for the body's boundary, by distances in both directions.

    1/2 (mean of d^2 over the boundary's nodes + mean of e^2 over sample points of the shape): d is the distance of a
    node from the shape, e that of a sample point from the body. With d alone, a finger may hide in the palm; with e
    alone, it may point anywhere if another part covers its target. Material may slide along the shape.

    Correspondence is by nearest point, so it is only as good as the current pose. A shape far from rest can lead to a
    wrong pose; add marker targets, or intermediate shapes, to guide the search.

    Attributes:
        outline: target shape for a flat body [m], in robot coordinates: `load_target_outline` reads one from a drawing.
        surface: closed target surface for a body in space [m], in robot coordinates: use the coordinates and the unit
            of the body's file.
        weight: weight of the root-mean-square distance relative to a marker's error.
        samples: number of sample points on the shape; None for the number of boundary nodes, at least 200.
    """

    outline: Outline | None = field(default=None, repr=False)
    surface: Surface | None = field(default=None, repr=False)
    weight: float = 1.0
    samples: int | None = None

    def bind(self, simulation: Simulation) -> Residual:
        """Return the residual on this robot.

        Raises:
            InputError: not exactly one shape, a shape of another dimension than the body, far larger or smaller than
                it, or not closed; a weight below 0; too few or too many samples.
        """
        mesh = simulation.robot.body.mesh
        weight = not_negative("weight of a shape", self.weight)
        most = 1_000_000
        if self.samples is not None and not (
            isinstance(self.samples, Integral) and _MIN_POINTS <= self.samples <= most
        ):
            raise InputError(
                f"samples of a shape must be a whole number from {_MIN_POINTS} to {most}, not {describe(self.samples)}"
            )
        name, shell = self._shell(mesh)
        _check(name, shell, mesh)
        samples = 200
        count = self.samples or max(len(mesh.boundary_nodes), samples)
        if self.outline is not None:
            places = _along(self.outline, count)
        else:
            assert self.surface is not None
            places = _over(self.surface, count)
        return _Shape(name, shell, places, mesh, weight)

    def _shell(self, mesh: Mesh) -> tuple[str, Shell]:
        if (self.outline is None) == (self.surface is None):
            raise InputError("a shape goal needs either an outline, for a flat body, or a surface, for one in space")
        if self.outline is not None:
            if mesh.dim != 2:
                raise InputError("an outline is a goal for flat bodies; this one is in space, give a surface")
            if not isinstance(self.outline, Outline):
                raise InputError(
                    f"outline must be an Outline [m], not {describe(self.outline)}; drawn_pose(robot, file) reads one"
                )
            return "outline", Shell.of_outline(self.outline)
        assert self.surface is not None
        if mesh.dim != 3:
            raise InputError("a surface is a goal for bodies in space; this one is flat, give an outline")
        if not isinstance(self.surface, Surface):
            raise InputError(f"surface must be a Surface(vertices, triangles) [m], not {describe(self.surface)}")
        return "surface", Shell(self.surface.vertices, self.surface.triangles)


_MIN_POINTS = 3


class _Shape(Residual):
    """Shape goal on one robot: signed distances, positive outside, each times the root of its share."""

    def __init__(self, name: str, target: Shell, places: Points, mesh: Mesh, weight: float) -> None:
        """Take the name of the error, the shape, sample points on it, the body, and the weight."""
        self.name, self.target, self.places = name, target, places
        self._body, self._rim = Shell(mesh.nodes, mesh.boundary), mesh.boundary_nodes
        self._roots = np.sqrt(np.concatenate([_shares(mesh), np.full(len(places), 1 / len(places))]) / 2)
        self._weight = weight
        self._last: tuple[Nodes, Nearest, Nearest] | None = None

    def residual(self, posture: EquilibriumState) -> Rows:
        return self._weight * self._distances(posture)

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        shape, body = self._nearest(posture)
        nodes = np.einsum("pd,pdw->pw", shape.directions, moves.nodes[self._rim])
        places = np.einsum("pc,pd,pcdw->pw", body.shares, -body.directions, moves.nodes[body.stencils], optimize=True)
        return (self._weight * self._roots)[:, None] * np.concatenate([nodes, places])

    def errors(self, posture: EquilibriumState) -> Mapping[str, float]:
        """Root mean square distance between the body's boundary and the shape, in both directions [m]."""
        return {self.name: float(np.linalg.norm(self._distances(posture)))} if self._weight > 0 else {}

    def _distances(self, posture: EquilibriumState) -> Rows:
        shape, body = self._nearest(posture)
        return self._roots * np.concatenate([shape.distances, body.distances])

    def _nearest(self, posture: EquilibriumState) -> tuple[Nearest, Nearest]:
        """Nearest points from the boundary to the shape, and from its samples to the body; the last are cached."""
        nodes = posture.nodes
        if self._last is None or self._last[0] is not nodes:
            body = self._body.with_nodes(nodes)
            self._last = nodes, self.target.nearest(nodes[self._rim]), body.nearest(self.places)
        return self._last[1:]


def _shares(mesh: Mesh) -> Vector:
    """Share of the boundary at rest that belongs to each of its nodes."""
    measures = Shell(mesh.nodes, mesh.boundary).measures
    own = np.bincount(mesh.boundary.ravel(), np.repeat(measures, mesh.dim), len(mesh.nodes))[mesh.boundary_nodes]
    return own / own.sum()


def _along(outline: Outline, count: int) -> Points:
    """Places spread evenly along the rings of an outline, about `count`."""
    curves = [Curve(ring) for ring in outline.rings]
    length = sum(curve.length for curve in curves)
    pieces = [
        curve.at((np.arange(number) + 0.5) * curve.length / number)
        for curve in curves
        for number in [max(round(count * curve.length / length), _MIN_POINTS)]
    ]
    return np.concatenate(pieces)


def _over(surface: Surface, count: int) -> Points:
    """So many places over a surface, each for as much of its area: at even steps through the areas of its triangles."""
    areas = np.cumsum(np.linalg.norm(surface.crosses, axis=1))
    steps = np.arange(count) + 0.5
    owners = np.searchsorted(areas, steps / count * areas[-1])
    # multiples of these spread evenly over a square (Roberts 2018)
    even = (0.7548776662466927, 0.5698402909980532)
    one, two = (steps * share % 1 for share in even)
    over = one + two > 1
    one, two = np.where(over, 1 - one, one), np.where(over, 1 - two, two)
    weights = np.column_stack([1 - one - two, one, two])
    return np.einsum("pc,pcd->pd", weights, surface.vertices[surface.triangles[owners]])


def _check(name: str, shell: Shell, mesh: Mesh) -> None:
    """Refuse a shape that a body cannot lie on."""
    size = float(np.ptp(shell.nodes[np.unique(shell.facets)], axis=0).max())
    largest = 10.0  # a body does not get so many times longer or shorter
    if not 1 / largest < size / mesh.size < largest:
        raise InputError(
            f"the {name} is {1e3 * size:.4g} mm large, the body {1e3 * mesh.size:.4g} mm; give it in meters"
        )
    if not (shell.measures > 0).all():
        raise InputError(f"the {name} has {np.sum(shell.measures == 0)} triangles without area; heal it first")
    if not shell.is_closed:
        raise InputError(f"the {name} is not closed; heal it first")


def load_target_outline(robot: Robot, drawing: Path | str) -> Outline:
    """Load the outline of a pose in robot coordinates, for `ShapeTarget`.

    Copy the drawing or picture of the body, and bend its contents; keep the page unchanged. Without the page, a drawing
    would be centered on its own bounding box, and the pose would be shifted. A changed page is detected by the page and
    unit of an SVG drawing, the unit of a DXF drawing, or the pixels of a picture. DXF has no page, so a different
    origin shifts the pose without an error.

    Args:
        robot: flat robot with a drawn body.
        drawing: file of the same kind as the body's: SVG, DXF, PNG or JPG.

    Raises:
        InputError: a body without a drawing, or a file that cannot be read.
        OutlineError: a drawing that gives no pose, or has another page.
    """
    body, file = robot.body, path_of(drawing, "a pose is read from the path of a drawing")
    if body.source is not Source.OUTLINE:
        raise InputError(f"{file.name}: a pose can be drawn over a drawing only, the body is of a {body.source} file")
    content = read_stranger(file)
    page = read_drawing(
        body.content, name=body.file, size=body.size, inner=body.inner, part=body.drawing_part or 1
    ).page
    return read_outline(content, name=file.name, page=page, inner=body.inner, part=body.drawing_part or 1)
