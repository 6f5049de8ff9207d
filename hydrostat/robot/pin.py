"""`Pin`: a boundary condition that holds nodes in space, by its stiffness."""
# Of the thesis (docs/thesis.md): R29, E10, M2

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry import Anchors, Mesh, locate
from hydrostat.given import Point, check_not_negative, check_point, check_positive

if TYPE_CHECKING:
    from hydrostat.robot.body import Body

_ENOUGH = {2: 5, 3: 15}  # least stiffness of a pin in that of the elements that it holds, in the plane and in space
_RIGID = 100  # the same of a pin that would have less


class DefaultStiffness(float):
    """Stiffness of a pin that nobody gave [N/m]; a robot replaces it by one that holds its body."""


DEFAULT_STIFFNESS = DefaultStiffness(100e3)  # of a pin in plush [N/m] (M2)


@dataclass(frozen=True, kw_only=True)
class Pin:
    """Boundary condition: holds every node within `radius` of `at` or in a box; if there is none, the point itself.

    Attributes:
        at: center of the pin [m]; None with `box`.
        radius: radius within which nodes are held [m].
        box: two opposite corners [m].
        stiffness: stiffness of the whole pin [N/m], shared equally by its nodes. The default is 100 kN/m, or 100 times
            its `held_stiffness` if 100 kN/m is less than 5 times (in space 15 times) that value.
        drive: name of the drive that moves it; None for a fixed pin.
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

    @property
    def is_sized(self) -> bool:
        """True if its stiffness was derived from the body, above the default for plush."""
        return isinstance(self.stiffness, DefaultStiffness) and self.stiffness != DEFAULT_STIFFNESS

    def held_stiffness(self, body: "Body") -> float:
        """Return the stiffness of an element of the stiffest material at the held nodes, times their number [N/m].

        A rigid part counts as the body's material.
        """
        anchors, mesh = self.anchors(body.mesh), body.mesh
        own = np.isin(mesh.elements, anchors.stencils[anchors.weights > 0]).any(axis=1)
        materials = [body.material, *(part.material or body.material for part in body.parts)]
        youngs = np.array([material.young for material in materials])[body.element_materials[own]]
        young = float((youngs * body.stiffness_factors[own]).max())
        length = (body.thickness or 1.0) if mesh.dim == 2 else float(np.cbrt(6 * mesh.volumes.mean()))
        return len(anchors.weights) * young * length

    def sized_for(self, body: "Body") -> Self:
        """Return the pin with the default stiffness for a body; itself if its stiffness was given."""
        if not isinstance(self.stiffness, DefaultStiffness):
            return self
        needed = self.held_stiffness(body)
        enough = _ENOUGH[body.mesh.dim] * needed <= DEFAULT_STIFFNESS
        stiffness = DEFAULT_STIFFNESS if enough else DefaultStiffness(f"{_RIGID * needed:.3g}")
        return self if stiffness == self.stiffness else replace(self, stiffness=stiffness)

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
        """Return the mask of the nodes inside the pin, (nodes,)."""
        if self.box is not None:
            low, high = np.min(self.box, axis=0), np.max(self.box, axis=0)
            return ((mesh.nodes >= low) & (mesh.nodes <= high)).all(axis=1)
        return np.linalg.norm(mesh.nodes - np.array(self.at), axis=1) <= self.radius


def take_pins(pins: tuple[Pin, ...], body: "Body") -> tuple[Pin, ...]:
    """Return pins with their default stiffness (InputError: one holds nothing, or the body can still turn)."""
    held = []
    for index, pin in enumerate(pins):
        try:
            held.append(pin.anchors(body.mesh).positions(body.mesh.nodes))
        except InputError as error:
            raise InputError(f"pin[{index}]: {error}") from None
    places = np.concatenate(held)
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    if (spread > 1e-6 * body.mesh.size).sum() < body.mesh.dim - 1:
        raise InputError(
            "pin[0]: the pins hold too few nodes, the body can still turn about them; widen a radius or add a pin"
        )
    sized = tuple(pin.sized_for(body) for pin in pins)
    return pins if all(one is pin for one, pin in zip(sized, pins, strict=True)) else sized
