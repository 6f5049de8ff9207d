"""`ObstacleFriction`: Coulomb friction of samples on a rigid obstacle, by anchored springs along its surface."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Points, Vector
from hydrostat.mechanics.krylov import solve_krylov

Squares = Float[np.ndarray, "samples dim dim"]


@dataclass(frozen=True, kw_only=True, eq=False)
class ObstacleFriction:
    """Springs from samples to their anchors, along the surface, that slip at a limit (elastic Coulomb friction).

    Positions are in the frame of the obstacle, so anchors move with it. During a minimization normals and limits are
    fixed: then the springs have a potential, Huber's function of the displacement along the surface.
    `with_corrected_history` updates limits and normals for the shape found; `drag_anchors` moves the anchors.

    Attributes:
        friction: Coulomb friction coefficient mu.
        springs: tangential stiffness of each sample [N/m].
        anchors: position at which each sample sticks [m].
        normals: surface normal at each sample.
        limits: largest tangential force, mu x normal force [N].
        trail: recent limits, each with the limits that the shape found with them asks for.
        share: relaxation factor of a correction; smaller where corrections do not reduce the error.
        missed: error of the last correction [N].
    """

    friction: float
    springs: Vector
    anchors: Points
    normals: Points
    limits: Vector
    trail: tuple[tuple[Vector, Vector], ...] = ()
    share: float = 1.0
    missed: float = np.inf

    @classmethod
    def at_rest(cls, friction: float, springs: Vector, places: Points) -> "ObstacleFriction":
        """Return the friction state without normal forces: each sample is anchored at its position [m]."""
        return cls(
            friction=friction,
            springs=springs,
            anchors=places,
            normals=np.zeros_like(places),
            limits=np.zeros(len(places)),
        )

    def only(self, some: np.ndarray) -> "ObstacleFriction":
        """Springs of some samples."""
        parts = (self.springs, self.anchors, self.normals, self.limits)
        springs, anchors, normals, limits = (part[some] for part in parts)
        return ObstacleFriction(
            friction=self.friction, springs=springs, anchors=anchors, normals=normals, limits=limits
        )

    def slips(self, places: Points) -> tuple[Points, Vector]:
        """Tangential displacement of each sample from its anchor [m], and its length [m]."""
        spans = places - self.anchors
        spans = spans - (spans * self.normals).sum(axis=1)[:, None] * self.normals
        return spans, np.linalg.norm(spans, axis=1)

    def energy(self, places: Points) -> float:
        """Energy of all springs [J]."""
        lengths, limits = self.slips(places)[1], self.limits
        sticks = self.springs * lengths <= limits
        slipping = limits * lengths - 0.5 * limits**2 / self.springs
        return float(np.where(sticks, 0.5 * self.springs * lengths**2, slipping).sum())

    def forces(self, places: Points) -> Points:
        """Gradient of the energy by the place of each sample [N]."""
        spans, lengths = self.slips(places)
        return self._secants(lengths)[:, None] * spans

    def stiffness(self, places: Points) -> Squares:
        """Second derivative of the energy [N/m], never negative; samples at their limit go on slipping."""
        spans, lengths = self.slips(places)
        secants = self._secants(lengths)
        across = np.eye(places.shape[1]) - self.normals[:, :, None] * self.normals[:, None, :]
        slips = self._at_limit(lengths)
        if places.shape[1] == 2:
            return np.where(slips, 0.0, secants)[:, None, None] * across
        units = spans / np.where(lengths > 0, lengths, 1.0)[:, None]
        along = np.where(slips, secants, 0.0)[:, None, None] * (units[:, :, None] * units[:, None, :])
        return secants[:, None, None] * across - along

    def with_normal_forces(self, pushes: Vector, normals: Points) -> "ObstacleFriction":
        """Return this state with the limits and normals that belong to these normal forces [N]."""
        return replace(self, limits=self.friction * pushes, normals=normals, trail=(), share=1.0, missed=np.inf)

    def with_corrected_history(self, pushes: Vector, normals: Points) -> "ObstacleFriction":
        """Return this state with limits corrected towards those of the shape found with it (relaxed fixed point)."""
        wanted = self.friction * pushes
        return replace(self, limits=self.limits + self.share * (wanted - self.limits), normals=normals)

    def slipping(self, places: Points) -> Bool[np.ndarray, " samples"]:
        """Mask of the samples that are at their friction limit."""
        return (self.limits > 0) & self._at_limit(self.slips(places)[1])

    def directions(self, places: Points) -> Points:
        """Unit vectors from the anchors to the samples, along the surface."""
        spans, lengths = self.slips(places)
        return spans / np.where(lengths > 0, lengths, 1.0)[:, None]

    def with_newton_step(
        self,
        pushes: Vector,
        normals: Points,
        slips: Int[np.ndarray, " slipping"],
        moves: Float[np.ndarray, "slipping slipping"],
    ) -> "ObstacleFriction":
        """Return this state with corrected limits and normals; slipping samples take a step of Newton's method.

        Args:
            pushes: normal forces at these limits [N].
            normals: surface normals at the samples.
            slips: indices of the slipping samples.
            moves: derivative of the requested limits of these samples by their current limits.
        """
        wanted = self.friction * pushes
        limits = self.limits + self.share * (wanted - self.limits)
        step = np.linalg.solve(np.eye(len(slips)) - self.share * moves, self.share * (wanted - self.limits)[slips])
        most = 4.0  # Largest ratio of a limit after a step to that before it or asked for
        limits[slips] = np.clip(self.limits[slips] + step, 0.0, most * np.maximum(self.limits, wanted)[slips])
        return replace(self, limits=limits, normals=normals, trail=())

    def force_changes(self, places: Points, limits: Vector, normals: Points) -> Points:
        """Change of `forces` under small changes of the limits [N] and of the normals, to first order [N]."""
        spans, (ways, lengths) = places - self.anchors, self.slips(places)
        along, beside = (spans * self.normals).sum(axis=1), (spans * normals).sum(axis=1)
        turned = -beside[:, None] * self.normals - along[:, None] * normals
        units = ways / np.where(lengths > 0, lengths, 1.0)[:, None]
        slips = self._at_limit(lengths)
        across = turned - (turned * units).sum(axis=1)[:, None] * units
        sliding = self._secants(lengths)[:, None] * across + limits[:, None] * units
        return np.where(slips[:, None], sliding, self.springs[:, None] * turned)

    def with_joint_step(
        self, pushes: Vector, normals: Points, response: Callable[[Vector, Points], tuple[Vector, Points]]
    ) -> "ObstacleFriction":
        """Return this state after a step of Newton's method in limits and normals together.

        Args:
            pushes: normal forces at these limits [N].
            normals: surface normals at the samples.
            response: changes of the normal forces [N] and of the normals where limits [N] and normals change.
        """
        wanted, known = self.friction * pushes, self.limits > 0
        scale = np.maximum(self.limits, wanted)  # Turns normals into forces
        safe, count = np.where(scale > 0, scale, 1.0)[:, None], len(wanted)
        turns = np.where(known[:, None], normals - self.normals, 0.0)

        def product(steps: Vector) -> Vector:
            rises, bends = response(steps[:count], steps[count:].reshape(turns.shape) / safe)
            return self.share * np.append(self.friction * rises, np.where(known[:, None], bends * scale[:, None], 0.0))

        missed = np.append(wanted - self.limits, turns * scale[:, None])
        steps = solve_krylov(product, self.share * missed)
        most = 4.0  # Largest ratio of a limit after a step to that before it or asked for
        turned = self.normals + steps[count:].reshape(turns.shape) / safe
        lengths = np.linalg.norm(turned, axis=1, keepdims=True)
        return replace(
            self,
            limits=np.clip(self.limits + steps[:count], 0.0, most * scale),
            normals=np.where(known[:, None] & (lengths > 0), turned / np.where(lengths > 0, lengths, 1.0), normals),
            trail=(),
        )

    def with_adapted_relaxation(self, missed: float) -> "ObstacleFriction":
        """Return this state with its relaxation factor adapted to the error of a correction [N]."""
        falls = 0.2  # A correction that takes less than this part of its share off what was off was too long
        least = 1 / 32  # No correction goes less than this share of its way
        share = (
            max(0.5 * self.share, least)
            if missed > (1.0 - falls * self.share) * self.missed
            else min(2.0 * self.share, 1.0)
        )
        return replace(self, share=share, missed=missed)

    def drag_anchors(self, places: Points) -> "ObstacleFriction":
        """Return this state with anchors dragged to where the springs pull no harder than the limits."""
        spans, lengths = self.slips(places)
        held = np.where(self.limits > 0, self._secants(lengths) / self.springs, 0.0)
        return replace(self, anchors=places - held[:, None] * spans, trail=())

    def _at_limit(self, lengths: Vector) -> Bool[np.ndarray, " samples"]:
        hair = 1e-9  # Nearer to its limit than this share a sample slips
        return self.springs * lengths >= (1.0 - hair) * self.limits

    def _secants(self, lengths: Vector) -> Vector:
        slips = self.springs * lengths > self.limits
        return np.where(slips, self.limits / np.where(slips, lengths, 1.0), self.springs)


_REMEMBERED_LIMITS = 6
"""So many limits tried before are remembered."""
