"""`Pin`: a boundary condition that holds nodes in space, by its stiffness."""
# Of the thesis (docs/thesis.md): R29, E10, M2

from dataclasses import dataclass

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry import Anchors, Mesh, locate
from hydrostat.given import Point, check_not_negative, check_point, check_positive

DEFAULT_STIFFNESS = 100e3  # stiffness of a pin [N/m] (M2): about a hundred times that of a plush body


@dataclass(frozen=True, kw_only=True)
class Pin:
    """Boundary condition: holds every node within `radius` of `at`, or in a box; if none, the point itself.

    Attributes:
        at: center of the pin [m]; None with `box`.
        radius: radius within which nodes are held [m].
        box: two opposite corners [m].
        stiffness: stiffness of the whole pin [N/m], shared equally by all nodes that it holds.
        drive: name of the drive that moves it; None: it stands still.
    """

    at: Point | None = None
    radius: float = 0.0
    box: tuple[Point, Point] | None = None
    stiffness: float = DEFAULT_STIFFNESS
    drive: str | None = None

    def __post_init__(self) -> None:
        if (self.at is None) == (self.box is None):
            raise InputError("give either at (with a radius) or box")
        if self.at is not None:
            check_point("at", self.at)
        for corner, point in enumerate(self.box or ()):
            check_point(f"box[{corner}]", point)
        if self.box is not None and self.radius:
            raise InputError("radius goes with at, not with box; remove it")
        check_not_negative("radius", self.radius, "m")
        check_positive("stiffness", self.stiffness, "N/m")

    def anchors(self, mesh: Mesh) -> Anchors:
        """Find the nodes that the pin holds (InputError: the pin lies outside the body and holds nothing)."""
        held = np.flatnonzero(self.holds(mesh))
        if len(held) > 0:
            anchors = Anchors.at_nodes(mesh, held)
        else:
            middle = self.at if self.box is None else np.mean(self.box, axis=0)
            anchors = locate(mesh, np.array([middle], dtype=float))
        if not anchors.inside.all():
            raise InputError("the pin lies outside the body and holds no node; move it, or widen its radius or box")
        return anchors

    def holds(self, mesh: Mesh) -> np.ndarray:
        """Mask of the nodes inside the pin, (nodes,)."""
        if self.box is not None:
            low, high = np.min(self.box, axis=0), np.max(self.box, axis=0)
            return ((mesh.nodes >= low) & (mesh.nodes <= high)).all(axis=1)
        return np.linalg.norm(mesh.nodes - np.array(self.at), axis=1) <= self.radius
