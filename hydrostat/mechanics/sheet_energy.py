"""`SheetEnergy`: an elastic sheet on facets of a body, such as felt, a knitted glove or a layer of fibres."""

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

import numpy as np

from hydrostat.arrays import Float, Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, Stencils
from hydrostat.mechanics.plane_stress import solve_thickening

Tensors = Float[np.ndarray, "terms size size"]


class SheetEnergy(Energy):
    """Neo-Hookean membrane on triangles, or strip on edges of a flat body, without stress across; it does not bend.

    With C = F^T F in the facet, J^2 = det C, and q the square of the stretch in the `free` directions across it,
    Psi = mu/2 (tr C - m) - mu ln J + free mu/2 (q - 1 - ln q) + lambda/2 (ln J + free/2 ln q)^2, least over q. So
    S = mu (I - q C^-1). The Hessian is exact; it is indefinite only where the sheet is compressed.

    A sheet that wrinkles follows tension field theory (Pipkin 1986): where S has a negative eigenvalue, the energy is
    that of a strip along the larger stretch, and 0 where that is compressed too. It is convex then.
    """

    convex: ClassVar[bool] = False

    def __init__(
        self,
        nodes: Nodes,
        facets: Stencils,
        *,
        lame: tuple[float, float],
        thickness: float,
        width: float | None = None,
        is_held_across: bool = True,
        wrinkles: bool = False,
    ) -> None:
        """Facets of the rest shape `nodes` that the sheet covers.

        Args:
            nodes: rest positions [m].
            facets: corners of each triangle, or ends of each edge.
            lame: Lame's parameters mu and lambda [Pa].
            thickness: thickness of the sheet [m].
            width: width of a strip on edges [m], which grows with the thickness of the body; None for triangles.
            is_held_across: True if a strip keeps its width, as on a body in plane strain.
            wrinkles: True if the sheet resists no compression.
        """
        self.stencils = np.ascontiguousarray(facets)
        self.mu, self.lame = lame
        self.wrinkles, self._rest, self._is_strip = wrinkles, nodes, width is not None
        self.free = 1 if width is None or is_held_across else 2
        corners = nodes[facets]
        self._frames, spans = np.linalg.qr(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
        inverse = np.linalg.inv(spans)
        self._gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
        areas = np.abs(np.linalg.det(spans)) / (1.0 if spans.shape[1] == 1 else 2.0)
        self.volumes = areas * thickness * (1.0 if width is None else width)
        steepest = (self._gradients**2).sum(axis=2).max(axis=1)
        self.stiffest = 5 * (2 * self.mu + self.lame) * float((self.volumes * steepest).max())

    def value(self, nodes: Nodes, controls: Vector) -> float:
        state = self._state(nodes)
        if not (state.log > -np.inf).all():
            return np.inf
        shear = 0.5 * self.mu * (np.trace(state.strain, axis1=1, axis2=2) - 2 * state.log)
        stored = shear + self._across(state.log, state.widened, self.free)
        if self.wrinkles:
            wrinkled, slack, ridge = self._ridges(state)
            strip = 0.5 * self.mu * (ridge.strain - np.log1p(ridge.strain))
            strip += self._across(0.5 * np.log1p(ridge.strain), ridge.widened, 2)
            stored = np.where(slack, 0.0, np.where(wrinkled, strip, stored))
        return float(self.volumes @ stored)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        state = self._state(nodes)
        stress = self._stress(state)
        if self.wrinkles:
            wrinkled, slack, ridge = self._ridges(state)
            along = ridge.stress[:, None, None] * ridge.way[:, :, None] * ridge.way[:, None, :]
            stress = np.where(slack[:, None, None], 0.0, np.where(wrinkled[:, None, None], along, stress))
        return self.volumes[:, None, None] * (self._gradients @ stress @ np.swapaxes(state.deformation, 1, 2))

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        state = self._state(nodes)
        blocks = self._taut_blocks(state)
        if self.wrinkles:
            wrinkled, slack, ridge = self._ridges(state)
            if wrinkled.any():
                blocks[wrinkled] = self._wrinkled_blocks(state, ridge)[wrinkled]
            blocks[slack] = 0.0
        size = self.stencils.shape[1] * nodes.shape[1]
        return (self.volumes[:, None, None, None, None] * blocks).reshape(-1, size, size)

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        """By the thickness of the body, with which strips grow."""
        return {"thickness": np.array([self.stiffness_work(nodes, field)])} if self._is_strip else {}

    def stiffness_work(self, nodes: Nodes, field: Nodes) -> float:
        """d(dE/dx . field) by a factor of the thickness of the sheet, or of its Young's modulus."""
        return float((self.gradient(nodes, np.zeros(0)) * field[self.stencils]).sum())

    def _across(self, log: Vector, widened: Vector, free: int) -> Vector:
        """Density of the energy of what is across the facet, and of the change of volume [Pa]."""
        shear = 0.5 * free * self.mu * (widened - np.log1p(widened))
        return shear + 0.5 * self.lame * (log + 0.5 * free * np.log1p(widened)) ** 2

    def _find_widening(self, log: Vector, free: int) -> Vector:
        """Change q - 1, by which nothing across the facet has a stress."""
        ones = np.ones_like(log)
        return solve_thickening(np.expm1(log / free), self.mu * ones, free * self.lame * ones)

    def _derivative(self, widened: Vector, free: int) -> Vector:
        """-dq / d ln J, at least 0."""
        q = 1.0 + widened
        return 2 * q * self.lame / (2 * q * self.mu + free * self.lame)

    def _state(self, nodes: Nodes) -> "_SheetState":
        """Strain from the displacements, so that little is lost to rounding."""
        moved = (nodes - self._rest)[self.stencils]
        turned = np.swapaxes(moved - moved[:, :1], 1, 2) @ self._gradients
        half = np.swapaxes(self._frames, 1, 2) @ turned
        strain = half + np.swapaxes(half, 1, 2) + np.swapaxes(turned, 1, 2) @ turned
        change = np.trace(strain, axis1=1, axis2=2)
        if strain.shape[1] == 2:
            change = change + np.linalg.det(strain)
        with np.errstate(divide="ignore"):
            log = 0.5 * np.log1p(np.maximum(change, -1.0))
        return _SheetState(self._frames + turned, strain, log, self._find_widening(log, self.free))

    def _stress(self, state: "_SheetState") -> Tensors:
        """S = mu (I - q C^-1) = mu C^-1 (C - I - (q - 1) I) [Pa]."""
        eye = np.eye(state.strain.shape[1])
        return self.mu * np.linalg.inv(eye + state.strain) @ (state.strain - state.widened[:, None, None] * eye)

    def _taut_blocks(self, state: "_SheetState") -> np.ndarray:
        shapes, eye = self._gradients, np.eye(state.deformation.shape[1])
        q = self.mu * (1.0 + state.widened)
        inverse = np.linalg.inv(np.eye(state.strain.shape[1]) + state.strain)
        across = state.deformation @ inverse
        duals = shapes @ np.swapaxes(across, 1, 2)
        flat = across @ np.swapaxes(state.deformation, 1, 2)  # projector onto the plane of the facet
        geometric = shapes @ self._stress(state) @ np.swapaxes(shapes, 1, 2)
        inner = q[:, None, None] * (shapes @ inverse @ np.swapaxes(shapes, 1, 2))
        blocks = np.einsum("tab,ij->taibj", geometric, eye) + np.einsum("tab,tij->taibj", inner, flat)
        blocks += np.einsum("t,taj,tbi->taibj", q, duals, duals)
        return blocks + np.einsum(
            "t,tai,tbj->taibj", self.mu * self._derivative(state.widened, self.free), duals, duals
        )

    def _ridges(self, state: "_SheetState") -> tuple[np.ndarray, np.ndarray, "_Ridge"]:
        """Masks of wrinkled and slack facets, and the larger stretch of each; at rest a facet is taut."""
        values, ways = np.linalg.eigh(state.strain)
        largest = values[:, -1]
        if values.shape[1] == 1:
            free, wrinkled = self.free, np.zeros(len(values), dtype=bool)
        else:
            free, wrinkled = 2, values[:, 0] < state.widened
        safe = np.maximum(largest, 0.0)
        widened = self._find_widening(0.5 * np.log1p(safe), free)
        stress = self.mu * (safe - widened) / (1.0 + safe)
        return wrinkled, largest < 0.0, _Ridge(safe, widened, stress, ways[:, :, -1])

    def _wrinkled_blocks(self, state: "_SheetState", ridge: "_Ridge") -> np.ndarray:
        """Stress along the ridges, and along ridges that turn with the strain; positive semidefinite."""
        shapes, eye = self._gradients, np.eye(state.deformation.shape[1])
        other = np.stack([-ridge.way[:, 1], ridge.way[:, 0]], axis=1)
        along, aside = (np.einsum("tak,tk->ta", shapes, way) for way in (ridge.way, other))
        pull, lean = (np.einsum("tik,tk->ti", state.deformation, way) for way in (ridge.way, other))
        square, q = 1.0 + ridge.strain, 1.0 + ridge.widened
        gap = np.maximum((pull**2).sum(axis=1) - (lean**2).sum(axis=1), 1e-12)
        steep = self.mu * (q / square**2 + 0.5 * self._derivative(ridge.widened, 2) / square**2)
        steered = lean[:, None, :] * along[:, :, None] + pull[:, None, :] * aside[:, :, None]
        blocks = np.einsum("t,ta,tb,ij->taibj", ridge.stress, along, along, eye)
        blocks += np.einsum("t,ta,tb,ti,tj->taibj", 2 * steep, along, along, pull, pull)
        return blocks + np.einsum("t,tai,tbj->taibj", ridge.stress / gap, steered, steered)


class _SheetState(NamedTuple):
    """State of the facets.

    Attributes:
        deformation: F of each facet, from its plane into space.
        strain: C - I.
        log: ln J.
        widened: q - 1.
    """

    deformation: np.ndarray
    strain: Tensors
    log: Vector
    widened: Vector


class _Ridge(NamedTuple):
    """Larger stretch of each facet, at least 1.

    Attributes:
        strain: its square less 1.
        widened: q - 1 of a strip along it.
        stress: S along it [Pa].
        way: its direction in the plane of the facet.
    """

    strain: Vector
    widened: Vector
    stress: Vector
    way: np.ndarray
