"""`FrictionCableEnergy`: cables (tendons) with capstan friction at their via points."""

from copy import copy
from dataclasses import replace
from typing import ClassVar, NamedTuple

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Nodes, Vector
from hydrostat.kernel import native
from hydrostat.mechanics.cable import CableEnergy, CableSegments
from hydrostat.mechanics.capstan import CapstanChains, ViaPointTurns, is_semidefinite
from hydrostat.mechanics.energy import (
    Blocks,
    Compliance,
    Energy,
    HessianBlocks,
    LowRankBasis,
    LowRankStiffness,
    RankMatrix,
    Response,
)
from hydrostat.mechanics.krylov import solve_krylov
from hydrostat.mechanics.tension_law import ChainLaw, TensionLaw


class LockedTensions(NamedTuple):
    """Tensions of the spans and their derivatives while points at the capstan limit slip on and the others stick.

    Attributes:
        tensions: tension T of each span [N].
        springs: dT/ds of each span alone [N/m].
        stretches: elongation of each span itself after all slips [m].
        by_elongation: dT / d elongations [N/m].
        by_limit: dT / d friction limits.
        limits_by_tension: d limits / dT at fixed angles.
        limits_by_angle: d limits / d angles [N/rad].
        limits_by_friction: d limits / d friction coefficients mu [N].
    """

    tensions: Vector
    springs: Vector
    stretches: Vector
    by_elongation: RankMatrix
    by_limit: RankMatrix
    limits_by_tension: RankMatrix
    limits_by_angle: Vector
    limits_by_friction: Vector


class FrictionCableEnergy(Energy):
    """Cables with capstan friction (Euler-Eytelwein) at the points where they turn: E14, F4.

    A cable with friction is a chain of springs of its own material, a span for every segment that is not sheathed; one
    without friction is a single span, as in `CableEnergy`. Cable slips over the point between two spans against a force
    of at most `law.limits`. By the capstan law this belongs to the tensions and angles of the state that is found, so
    there is no potential: the solver brings it about, by `history_residual` and `with_corrected_history`. The slips of
    the past are its history; `with_advanced_history` returns the energy of the next step.

    Attributes:
        slips: cable length that has passed the point before each span [m], positive towards the winch.
        friction: friction coefficient mu at the point before each span.
        law: tension law of the spans, with the limits of friction.
    """

    has_history = True
    max_stalled_corrections: ClassVar[int] = 8

    def __init__(
        self,
        nodes: Nodes,
        segments: CableSegments,
        *,
        law: TensionLaw,
        winches: Int[np.ndarray, " cables"],
        slack: Vector,
        friction: Vector,
        turns: ViaPointTurns,
        ratios: Vector | None = None,
    ) -> None:
        """Cables at rest on the rest shape `nodes`, which have not yet slipped.

        Args:
            nodes: rest positions [m].
            segments: those that are not sheathed.
            law: tension against elongation, of each cable.
            winches: index of the winch whose contraction each cable follows.
            slack: contraction at which each cable starts to become taut [m], at the winch.
            friction: coefficient mu of each cable.
            turns: via points at which the cables turn; their points are the segments after them.
            ratios: contraction of each cable per meter of its winch's contraction; 1 by default.
        """
        cables = segments.cables
        first = np.append(True, np.diff(cables) != 0)[: len(cables)]
        heads = first | (friction[cables] > 0)
        spans = np.cumsum(heads) - 1
        owners, firsts = cables[heads], first[heads]
        self._spans = CableEnergy(
            nodes,
            replace(segments, cables=spans),
            law=law,
            winches=winches[owners],
            slack=np.where(firsts, slack[owners], 0.0),
            ratios=None if ratios is None else ratios[owners],
        )
        self.stencils, self.controls = self._spans.stencils, self._spans.controls
        lengths = self._spans.rest_lengths
        shares = lengths / np.bincount(owners, lengths, len(winches))[owners]
        self.friction = np.where(firsts, 0.0, friction[owners])
        self.slips = np.zeros(len(owners))
        self._firsts, self._owners = firsts, owners
        self._share, self._missed, self._solves = 1.0, np.inf, False  # of the last correction
        self._turns = ViaPointTurns(
            stencils=turns.stencils, weights=turns.weights, offsets=turns.offsets, points=spans[turns.points]
        )
        self.law = ChainLaw(
            stiffness=law.stiffness[owners] / shares,
            smoothing=law.smoothing[owners] * shares,
            starts=np.append(np.flatnonzero(firsts), len(owners)),
            limits=np.zeros(len(owners)),
        )

    def elongations(self, nodes: Nodes, controls: Vector) -> Vector:
        """Elongation of each span if nothing slips [m]."""
        spans = self._spans
        moved = np.where(self._firsts, spans.compute_contractions(controls) - spans.slack, self.slips)
        passed = np.append(np.where(self._firsts, 0.0, self.slips)[1:], 0.0)
        return spans.lengths(nodes) - spans.rest_lengths + moved - passed

    def span_tensions(self, nodes: Nodes, controls: Vector) -> Vector:
        """T of each span [N]."""
        return self.law.tension(self.elongations(nodes, controls))

    def tensions(self, nodes: Nodes, controls: Vector) -> Vector:
        """T of each cable [N] in the span at its winch."""
        return self.span_tensions(nodes, controls)[self._firsts]

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return float(self.law.energy(self.elongations(nodes, controls)).sum())

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._pull(nodes, self.span_tensions(nodes, controls))

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self._spans.bends(nodes, self.span_tensions(nodes, controls))

    def low_rank_hessian(self, nodes: Nodes, controls: Vector) -> LowRankStiffness:
        springs, elongations, law = self.law.springs(self.elongations(nodes, controls))
        columns = self._spans.spring_columns(nodes, springs, len(elongations))
        weights = np.diag(law.tangent(elongations))
        return LowRankStiffness(columns=columns, weights=weights, elongations=elongations, law=law, series=springs)

    def span_columns(self, nodes: Nodes) -> LowRankBasis:
        return self._spans.columns(nodes)

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        return float(self.span_tensions(nodes, controls).max(initial=0.0))

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._pull(nodes, self._by_control(self.law.tangents(self.elongations(nodes, controls))))

    def angles(self, nodes: Nodes) -> Vector:
        """Turning angle of the cable at the point before each span, both ends of a sheath added up [rad]."""
        return np.bincount(self._turns.points, self._turns.angles(nodes), len(self.slips))

    def capstan_limits(self, nodes: Nodes, controls: Vector) -> Vector:
        """Limits of friction at these tensions and angles: the larger tension x (1 - exp(-mu angle)) [N]."""
        return -np.expm1(-self.friction * self.angles(nodes)) * _larger(self.span_tensions(nodes, controls))

    @property
    def owners(self) -> Int[np.ndarray, " spans"]:
        """Cable that each span belongs to."""
        return self._owners

    def at_winches(self, spans: Float[np.ndarray, "spans *columns"]) -> Float[np.ndarray, "cables *columns"]:
        """Rows of the span at the winch of each cable."""
        return spans[self._firsts]

    @property
    def history(self) -> Vector:
        """Slips at the point before each span [m]."""
        return self.slips

    def with_limits(self, limits: Vector) -> "FrictionCableEnergy":
        """Energy against other limits of friction [N]."""
        return self._with(limits, self.slips)

    def history_residual(self, nodes: Nodes, controls: Vector) -> float:
        """Largest difference between the friction limits in use and those of the capstan law [N]."""
        return float(np.abs(self.capstan_limits(nodes, controls) - self.law.limits).max(initial=0.0))

    def with_history(self, history: Vector, nodes: Nodes, controls: Vector) -> "FrictionCableEnergy":
        """Energy after other slips [m], at equilibrium with these in a given state."""
        held = 1e30  # Friction that nothing overcomes [N]
        still = self._with(np.full_like(history, held), history)
        return still.with_limits(still.capstan_limits(nodes, controls))

    def with_advanced_history(self, nodes: Nodes, controls: Vector) -> "FrictionCableEnergy":
        """Return the energy for the next increment: the cable has slipped, and the limits are those of this state."""
        slips = self.slips + self.law.slips(self.elongations(nodes, controls))
        other = self._with(self.capstan_limits(nodes, controls), slips)
        other._share, other._missed, other._solves = 1.0, np.inf, False
        return other

    def with_corrected_history(
        self, nodes: Nodes, controls: Vector, compliance: Compliance | None, response: Response | None = None
    ) -> "FrictionCableEnergy":
        """Energy with better limits: those of the capstan law here, or where a step of Newton towards it leads.

        Where the last step left too much, those of balance on a body that gives way linearly are taken instead, and a
        share of that way where these left too much as well.

        Args:
            nodes: equilibrium with the limits as they are [m].
            controls: contractions [m].
            compliance: compliance of the body at these nodes.
            response: its displacement under forces.
        """
        miss = self.capstan_limits(nodes, controls) - self.law.limits
        off, limits = float(np.abs(miss).max(initial=0.0)), None
        if compliance is None or response is None or off == 0.0:
            return self.with_limits(self.law.limits + miss)
        missed = off / max(self.largest_force(nodes, controls), np.finfo(float).tiny)  # 0 where all cables are slack
        falls = missed <= (1.0 - _FALLS * self._share) * self._missed
        step = self._newton_step(nodes, controls, response, miss) if falls and not self._solves else None
        if step is None or np.abs(step).max() > _WILD * off:
            limits = self._solved_limits(nodes, controls, compliance)
        solves = limits is not None
        if limits is None:
            step = self._newton_step(nodes, controls, response, miss) if step is None else step
            limits = self.law.limits + step * min(_WILD * off / float(np.abs(step).max()), 1.0)
        least_share = 1 / 16  # No correction goes less than this share of its way
        share = min(2 * self._share, 1.0) if falls or solves > self._solves else max(0.5 * self._share, least_share)
        other = self.with_limits(np.maximum(self.law.limits + share * (limits - self.law.limits), 0.0))
        other._share, other._missed, other._solves = share, missed, solves
        return other

    def _solved_limits(self, nodes: Nodes, controls: Vector, compliance: Compliance) -> Vector | None:
        """Friction limits that satisfy the capstan law on a linearly compliant body; None if none are found."""
        elongations = self.elongations(nodes, controls)
        chains = CapstanChains(
            law=self.law,
            friction=self.friction,
            tensions=self.law.tension(elongations),
            elongations=elongations,
            angles=self.angles(nodes),
            compliance=compliance.compliance,
            turning=self.turn_gradients(nodes).T @ compliance.moves,
            stable=is_semidefinite(compliance.compliance),
        )
        tensions = chains.solve_slip_complementarity()
        return None if tensions is None else chains.limits(tensions)

    def _newton_step(self, nodes: Nodes, controls: Vector, response: Response, miss: Vector) -> Vector:
        """Newton's step of the limits while cable slips where it does."""
        elongations = self.elongations(nodes, controls)
        tensions = self.law.tension(elongations)
        by_elongation, by_limit = self.law.compute_slip_jacobians(tensions, np.sign(self.law.slips(elongations)))
        by_tension, by_angle = self._by_tension(nodes, tensions), self._by_angle(nodes, tensions)
        pulled, turned = self._spans.length_gradients(nodes), self._turns.blocks(nodes)
        spans, corners, count = self._spans.cables, self._turns.stencils, len(tensions)

        def change_limits(limits: Vector) -> Vector:
            """Change of the capstan's limits where the limits change."""
            drops, forces = by_limit @ limits, np.zeros_like(nodes)
            native.add_vectors(self.stencils, pulled * drops[spans][:, None, None], forces)
            moved = -response(forces.ravel()).reshape(nodes.shape)
            stretched = np.bincount(spans, np.einsum("tcd,tcd->t", pulled, moved[self.stencils]), count)
            bent = np.bincount(self._turns.points, np.einsum("stcd,stcd->t", turned, moved[corners]), count)
            return by_tension @ (drops + by_elongation @ stretched) + by_angle * bent

        return solve_krylov(change_limits, miss)

    def moves(self, nodes: Nodes, controls: Vector, compliance: Compliance) -> Float[np.ndarray, "dofs controls"]:
        """Derivative of the nodes by the controls, while all points at the capstan limit go on slipping.

        Args:
            nodes: an equilibrium [m].
            controls: contractions [m].
            compliance: compliance of the body at the pose.
        """
        return -compliance.moves @ self.tension_derivatives(nodes, controls, compliance)

    def tension_derivatives(
        self, nodes: Nodes, controls: Vector, compliance: Compliance, taut: Int[np.ndarray, " some"] | None = None
    ) -> Float[np.ndarray, "spans controls"]:
        """Derivative of each span's tension by the controls [N/m], as in `moves`.

        Args:
            nodes: an equilibrium [m].
            controls: contractions [m].
            compliance: compliance of the body at the pose.
            taut: cables that, where they are slack, are taken as if they had just become taut and slipped; none if left
                out.
        """
        tensions = self.span_tensions(nodes, controls)
        joining = np.isin(self._owners, [] if taut is None else taut) & (tensions <= 0)
        turned = np.cumsum(self.friction * self.angles(nodes))
        turned -= turned[self.law.starts[self._owners]]
        little = self.law.stiffness * self.law.smoothing * _JUST_TAUT
        tensions = np.where(joining, little * np.exp(-turned), tensions)
        by_elongation, by_limit = self._slip_compliance(nodes, controls, tensions, joining)
        pulled = np.zeros((len(tensions), len(controls)))
        pulled[np.arange(len(tensions)), self._spans.winches] = self._by_control(by_elongation)
        unit = np.eye(len(tensions))
        limits = self._limit_derivatives(nodes, tensions, compliance)
        derivatives = unit + by_elongation @ compliance.compliance - by_limit @ limits
        return np.linalg.solve(derivatives, pulled)

    def linearize_tensions(self, nodes: Nodes, controls: Vector) -> LockedTensions:
        """Tensions at an equilibrium with the derivatives that they and the capstan's limits have there."""
        tensions = self.span_tensions(nodes, controls)
        by_elongation, by_limit = self._slip_compliance(nodes, controls, tensions, np.zeros(len(tensions), dtype=bool))
        angles = self.angles(nodes)
        held = np.exp(-self.friction * angles) * _larger(tensions)
        pulls = tensions > 0
        stretches = np.where(pulls, self.law.elongation(tensions), 0.0)
        return LockedTensions(
            tensions=tensions,
            springs=TensionLaw.tangent(self.law, stretches),
            stretches=stretches,
            by_elongation=by_elongation,
            by_limit=by_limit,
            limits_by_tension=self._by_tension(nodes, tensions),
            limits_by_angle=self.friction * held,
            limits_by_friction=angles * held,
        )

    @property
    def spans(self) -> CableEnergy:
        """Spans as cables of their own, as if nothing slipped."""
        return self._spans

    @property
    def turns(self) -> ViaPointTurns:
        """Via points at which the cables turn."""
        return self._turns

    def turn_gradients(self, nodes: Nodes) -> Float[np.ndarray, "dofs spans"]:
        """D angles / d nodes [rad/m]."""
        return self._turns.gradients(nodes, len(self.slips))

    def _slip_compliance(
        self, nodes: Nodes, controls: Vector, tensions: Vector, joining: Bool[np.ndarray, " spans"]
    ) -> tuple[RankMatrix, RankMatrix]:
        """dT/d elongations and dT/d limits while cable slips where it is at the limit, or joins."""
        drops = np.where(self._firsts, 0.0, np.append(0.0, -np.diff(tensions)))
        # Tensions that come as near to the capstan's limit, as a share of the largest tension, are at it
        at_the_limit = 1e-6
        near = at_the_limit * tensions.max(initial=0.0)
        slipping = joining | (np.abs(drops) >= self.capstan_limits(nodes, controls) - near)
        return self.law.compute_slip_jacobians(tensions, np.sign(drops) * slipping)

    def _by_tension(self, nodes: Nodes, tensions: Vector) -> RankMatrix:
        """D capstan limits / d tensions at fixed angles."""
        before = np.append(0.0, tensions[:-1])
        derivatives = np.zeros((len(tensions), len(tensions)))
        span = np.arange(len(tensions))
        derivatives[span, span - (before > tensions)] = -np.expm1(-self.friction * self.angles(nodes))
        return derivatives

    def _by_angle(self, nodes: Nodes, tensions: Vector) -> Vector:
        """D capstan limits / d angles at fixed tensions [N/rad]."""
        return self.friction * np.exp(-self.friction * self.angles(nodes)) * _larger(tensions)

    def _limit_derivatives(self, nodes: Nodes, tensions: Vector, compliance: Compliance) -> RankMatrix:
        """D capstan limits / d tensions, including the compliance of the body."""
        turned = self.turn_gradients(nodes).T @ compliance.moves
        return self._by_tension(nodes, tensions) - self._by_angle(nodes, tensions)[:, None] * turned

    def _pull(self, nodes: Nodes, forces: Vector) -> Blocks:
        return self._spans.length_gradients(nodes) * forces[self._spans.cables][:, None, None]

    def _by_control(self, tangents: RankMatrix) -> Vector:
        """Derivative of the tension of each span along the contraction of its winch [N/m]."""
        return self._spans.ratios * tangents[np.arange(len(tangents)), self.law.starts[self._owners]]

    def _with(self, limits: Vector, slips: Vector) -> "FrictionCableEnergy":
        other = copy(self)
        other.law = replace(self.law, limits=limits)
        other.slips = slips
        return other


def _larger(tensions: Vector) -> Vector:
    """Larger of the tensions on both sides of the point before each span [N]."""
    return np.maximum(tensions, np.append(0.0, tensions[:-1]))


_JUST_TAUT = 1.0 / 16.0
"""Tension of a cable that has just become taut, in units of its stiffness times its smoothing: at half of this."""


_FALLS = 0.5
"""A correction of a share of its way that takes less than this part of that share off what was off was too long."""

_WILD = 30.0
"""A Newton step that changes a limit by this many times its error begins at a kink: no step is longer."""
