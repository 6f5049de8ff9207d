"""`CapstanChains`: tensions of cables that slip by the capstan law, on a linearly compliant body."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Vector
from hydrostat.kernel import native
from hydrostat.mechanics.energy import RankMatrix
from hydrostat.mechanics.tension_law import ChainLaw, TensionLaw


@dataclass(frozen=True, kw_only=True, eq=False)
class ViaPointTurns:
    """Corners of cables in the body, by the directions of the two segments that meet there.

    Attributes:
        stencils: nodes of the segments before, then of those after, (2, corners of cables, nodes of a segment).
        weights: signed weights of those nodes.
        offsets: contribution of points fixed in the world to the segments [m].
        points: index of the friction point that a corner belongs to; a sheath is one point with two corners, its ends.
    """

    stencils: Int[np.ndarray, "2 turns corners"]
    weights: Float[np.ndarray, "2 turns corners"]
    offsets: Float[np.ndarray, "2 turns dim"]
    points: Int[np.ndarray, " turns"]

    def angles(self, nodes: Nodes) -> Float[np.ndarray, " turns"]:
        """Turning angle of the cable at each corner [rad], 0 to pi."""
        before, after = self._directions(nodes)[0]
        return 2 * np.arctan2(np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1))

    def gradients(self, nodes: Nodes, count: int) -> Float[np.ndarray, "dofs points"]:
        """Derivative of the sum of the angles at each of `count` points of friction [rad/m].

        A straight run has none: its angle has a kink there.
        """
        columns = np.zeros((*nodes.shape, count))
        spread = self.blocks(nodes)
        axes = np.arange(nodes.shape[1])
        np.add.at(columns, (self.stencils[..., None], axes, self.points[:, None, None]), spread)
        return columns.reshape(nodes.size, count)

    def blocks(self, nodes: Nodes) -> Float[np.ndarray, "2 turns corners dim"]:
        """Derivative of each angle by the nodes of its stencils [rad/m]."""
        return self.weights[..., None] * self.derivatives(nodes)[:, :, None, :]

    def derivatives(self, nodes: Nodes) -> Float[np.ndarray, "2 turns dim"]:
        """Derivative of each angle by the vectors along the segments before and after it [rad/m]; as above."""
        (before, after), lengths = self._directions(nodes)
        cosine = np.einsum("td,td->t", before, after)[:, None]
        straight = 1e-9  # A turn of less [rad] counts as none
        sine = np.maximum(np.sin(self.angles(nodes)), straight)[:, None]
        return np.stack([(cosine * before - after) / sine, (cosine * after - before) / sine]) / lengths[..., None]

    def _directions(self, nodes: Nodes) -> tuple[Float[np.ndarray, "2 turns dim"], Float[np.ndarray, "2 turns"]]:
        spans = np.einsum("stc,stcd->std", self.weights, nodes[self.stencils]) + self.offsets
        lengths = np.maximum(np.linalg.norm(spans, axis=2), np.finfo(float).tiny ** 0.5)
        return spans / lengths[..., None], lengths


@dataclass(frozen=True, kw_only=True, eq=False)
class CapstanChains:
    """Spans of cables at an equilibrium of the body, with their linear dependence on the tensions T.

    Elongations are s = elongations - compliance (T - tensions) + slips, angles theta = angles - turning (T - tensions).
    With rho = exp(-mu theta) a point between spans of tensions before and after slips towards the winch only where
    after = rho before, away from it only where before = rho after, and a slack span has T = 0. For linear springs this
    is a linear complementarity problem of a copositive matrix, so Lemke's algorithm ends in a solution (Cottle, Pang,
    Stone 1992). The springs' curve and the angles follow by Newton's method on such problems (Josephy).

    Attributes:
        law: tension law of the spans; its friction limits are not used.
        friction: friction coefficient mu at the point before each span; 0 for the first span of a cable.
        tensions: tensions at the equilibrium [N].
        elongations: elongations at the equilibrium if nothing slips [m].
        angles: turning angle of the cable at the point before each span [rad].
        compliance: - d elongations / d T, positive semidefinite if `stable` [m/N].
        turning: - d angles / d T [rad/N].
        stable: True if the body is stable without its cables. If False, only a solution near these tensions counts.
    """

    law: ChainLaw
    friction: Vector
    tensions: Vector
    elongations: Vector
    angles: Vector
    compliance: RankMatrix
    turning: RankMatrix
    stable: bool

    def solve_slip_complementarity(self) -> Vector | None:
        """Tensions where the capstan's law holds [N]; None if these are not found."""
        tensions = self._solve(turns=True)
        return self._solve(turns=False) if tensions is None else tensions

    def limits(self, tensions: Vector) -> Vector:
        """Largest forces of friction by the capstan's law at these tensions [N]."""
        larger = np.maximum(tensions, np.append(0.0, tensions[:-1]))
        return -np.expm1(-self.friction * self._turn_limits(tensions)) * larger

    def _solve(self, *, turns: bool) -> Vector | None:
        """Tensions; without `turns` angles stay as they are within a round."""
        law, points = self.law, np.setdiff1d(np.arange(len(self.tensions)), self.law.starts)
        scale = float(np.abs(self.elongations + self.compliance @ self.tensions).max(initial=0.0))
        tensions, own = self.tensions, law.elongation(self.tensions)
        slips = law.slips(self.elongations)[points]
        guess = np.concatenate([self.tensions > 0, slips > 0, slips < 0]).astype(float)
        rounds = 20  # Most linear problems of one answer; it takes two to ten
        near = 1e-10  # Tensions that change by less than this share of the largest are found
        for _ in range(rounds if scale > 0 else 0):
            matrix, right, unit = self._problem(points, tensions, own, scale, turns)
            if not native.complement(matrix, right, self.stable, guess):
                return None
            found = guess[: len(tensions)] * unit
            change = float(np.abs(found - tensions).max())
            slips = (guess[len(tensions) :][: len(points)] - guess[len(tensions) + len(points) :]) * scale
            stretched = self.elongations - self.compliance @ (found - self.tensions)
            stretched[points] += slips
            stretched[points - 1] -= slips
            tensions = np.where(found > 0, found, TensionLaw.tension(law, stretched))
            own = np.where(tensions > 0, law.elongation(tensions), 0.0)
            if change <= near * tensions.max(initial=0.0):
                return tensions
        return None

    def _problem(
        self, points: np.ndarray, tensions: Vector, own: Vector, scale: float, turns: bool
    ) -> tuple[Float[np.ndarray, "rows rows"], Vector, float]:
        """Matrix and right-hand side, in units of T [N] and `scale` [m]; unknowns are T, slips forth, slips back."""
        law, count, many = self.law, len(tensions), len(points)
        derivatives = np.maximum(TensionLaw.tangent(law, own), 1e-9 * law.stiffness)
        soft = np.where(tensions > 0, 1.0 / derivatives, 1.0 / law.stiffness)
        unit = scale / float(np.median(soft + self.compliance.diagonal()))
        rows = np.arange(many)
        forth, back = slice(count, count + many), slice(count + many, None)
        kept = np.exp(-self.friction * self._turn_limits(tensions))[points]
        matrix, right = np.zeros((count + 2 * many,) * 2), np.zeros(count + 2 * many)
        matrix[:count, :count] = (np.diag(soft) + self.compliance) * (unit / scale)
        right[:count] = (own - soft * tensions - self.elongations - self.compliance @ self.tensions) / scale
        for part, sign, larger, smaller in ((forth, 1.0, points - 1, points), (back, -1.0, points, points - 1)):
            columns = matrix[:count, part]
            columns[points, rows], columns[points - 1, rows] = -sign, sign
            limited = matrix[part, :count]
            limited[rows, smaller], limited[rows, larger] = 1.0, -kept
            if turns:
                rises = (tensions[larger] * self.friction[points] * kept)[:, None] * self.turning[points]
                limited -= rises
                right[part] = rises @ tensions / unit
        return matrix, right, unit

    def _turn_limits(self, tensions: Vector) -> Vector:
        return np.maximum(self.angles - self.turning @ (tensions - self.tensions), 0.0)


def is_semidefinite(matrix: RankMatrix) -> bool:
    """Return True if a symmetric matrix is positive semidefinite."""
    slight = 1e-9  # A matrix is semidefinite if it is definite with this share of its diagonal more
    try:
        np.linalg.cholesky(matrix + np.diag(slight * matrix.diagonal()))
    except np.linalg.LinAlgError:
        return False
    return True
