"""`FreePosing`: a body that follows points held by hand as if full of muscles, fit for dragging (R36 to R38)."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.design.muscles.activation import Fibres, anchor_jacobian, edge_fibres, least_effort
from hydrostat.geometry import Anchors
from hydrostat.mechanics import NewtonOptions, NewtonResult, minimize
from hydrostat.robot import Robot
from hydrostat.simulation import BodyPhysics


class FreePosing:
    """Any-time activation of muscle fibres: each update is one step nearer to where points are held.

    It minimizes what `activate` does, 1/2 |points - goals|^2 + rho/2 |t|^2, over tensions 0 <= t <= strength, but goes
    on from where it is. An update linearizes equilibrium and goal together (sequential quadratic programming): one
    solve for each coordinate held, the dual of least effort, and a step or two of Newton whose last Hessian begins the
    next update. The bound on tensions keeps a goal out of reach from crushing the body.

    Points named as calm should rather stay where they rest: the square of what they move weighs |miss| / (2 size), as
    in `solve_ik` (`IKOptions.hold_free_markers`), and never so little that it takes too much effort to keep them.

    Attributes:
        robot: robot with the body.
        fibres: the muscles.
        strength: maximum tension of a fibre [N].
        nodes: positions of the nodes [m].
        tensions: tension of each fibre [N].
    """

    def __init__(
        self,
        robot: Robot,
        fibres: Fibres | None = None,
        *,
        effort: float = 1e-4,
        strength: float = 1.8,
        body: BodyPhysics | None = None,
    ) -> None:
        """Begin at rest, with muscles on all edges of the mesh if none are given.

        Effort weighs squared tensions, as for `activate`; strength is the most that muscles pull, as the pressure of
        all of them together in Young's moduli.
        """
        mesh = robot.body.mesh
        self.robot = robot
        self.fibres = fibres or edge_fibres(mesh)
        body = body or BodyPhysics(robot)
        body.check(robot)
        self._energy = self.fibres.energy()
        self._lengths = self._energy.lengths(mesh.nodes)
        self._assembly = body.assembly.with_added_energies([self._energy], control_count=len(self.fibres))
        self._warp, self._noise = body.warp, body.round_off()
        self._effort, self._size = effort, mesh.size
        volume = float(mesh.volumes.sum()) * (robot.body.thickness or 1.0)
        self.strength = strength * robot.body.material.young * mesh.dim * volume / float(self._lengths.sum())
        self._resting = self._begin()
        self.nodes = mesh.nodes
        self.rest()
        self._resting_stiffness, self._resting_pulls = self._stiffness, self._pulls(self.nodes, self.tensions)
        self._able = self._largest_move()

    def rest(self) -> None:
        """Let go of everything immediately: no muscle pulls."""
        self._radius = _RULES.max_step
        self._settle(self._resting, np.zeros(len(self.fibres)))

    def update(self, held: Anchors, goals: Points, calm: Anchors | None = None) -> bool:
        """One step towards where held points should be [m], back to rest without any; whether there is more to gain.

        Points of `calm` are those that nobody holds and that should rather stay.
        """
        aims = self._aims(held, goals, calm)
        wanted, rho = self._solve_tensions(aims)
        change = wanted - self.tensions
        farthest = self._farthest(change)
        before = self._objective(self.nodes, self.tensions, aims, rho)
        for _ in range(_RULES.num_tries):
            length = min(1.0, self._radius / farthest) if farthest > 0 else 1.0
            tensions = self.tensions + length * change
            found = self._relax(tensions, _RULES.iterations)
            if self._objective(found.nodes, tensions, aims, rho) <= before:
                self._radius = min(2.0 * self._radius, _RULES.max_step)
                return self._settle(found, tensions)
            self._radius = max(0.25 * length * farthest, _RULES.min_step)
        # The body may be so far from rest that nothing can be predicted: first let it settle as it is pulled now.
        return self._settle(self._relax(self.tensions, _RULES.far_iterations), self.tensions)

    def _begin(self) -> NewtonResult:
        """Return the equilibrium at rest, from a start with all of the weight."""
        none = np.zeros(len(self.fibres))
        return minimize(
            self._assembly,
            self.robot.body.mesh.nodes,
            none,
            round_off=self._noise,
            options=NewtonOptions(),
            warp=self._warp,
        )

    def _settle(self, found: NewtonResult, tensions: Vector) -> bool:
        """Be where Newton came to, with a Hessian that is projected until it is definite; whether that is elsewhere."""
        moved = float(np.abs(found.nodes - self.nodes).max())
        self.nodes, self.tensions = found.nodes, tensions
        stiffness = found.stiffness
        if stiffness is None or not stiffness.definite:
            stiffness = self._assembly.stiffness(found.nodes, tensions, projection=1.0)
        if not stiffness.definite:
            stiffness = self._assembly.stiffness(found.nodes, tensions, projection=1.0, shift=_RULES.shift)
        self._stiffness = stiffness
        return moved > _RULES.still * self._size

    def _aims(self, held: Anchors, goals: Points, calm: Anchors | None) -> list["_Aim"]:
        """Pinned nodes, then nodes that should stay; none have to stay while none are pinned."""
        aims = [_Aim(held, goals, 1.0)]
        if calm is not None and len(goals):
            missed = float(np.linalg.norm(held.positions(self.nodes) - goals))
            weight = max(_RULES.calm_weight, np.sqrt(0.5 * missed / self._size))
            aims.append(_Aim(calm, calm.positions(self._resting.nodes), weight))
        return aims

    def _solve_tensions(self, aims: list["_Aim"]) -> tuple[Vector, float]:
        """Solve the linearized problem for tensions; return them and the weight of their squares [m^2/N^2].

        Effort weighs more for a goal out of reach, so that the strongest fibre pulls as hard as it can and the others
        by their leverage; were all of them at their bounds, the body would be crushed.
        """
        rows = np.hstack([aim.weight * anchor_jacobian(aim.points, self.nodes) for aim in aims])
        adjoint = self._stiffness.solve(rows)
        jacobian = -(self._pulls(self.nodes, self.tensions).T @ adjoint).T
        gradient = self._assembly.gradient(self.nodes, self.tensions)
        missed = np.concatenate([aim.weight * (aim.goals - aim.points.positions(self.nodes)).ravel() for aim in aims])
        rho = self._weight(rows[:, : aims[0].goals.size])
        goal = missed + adjoint.T @ gradient + jacobian @ self.tensions
        most = self._most()
        wanted = least_effort(jacobian, goal, rho, most=most)
        for _ in range(_RULES.num_softenings):
            asked = float((jacobian.T @ (goal - jacobian @ wanted)).max(initial=0.0)) / rho
            if asked <= (1.0 + _RULES.overload) * self.strength:
                break
            rho *= asked / self.strength
            wanted = least_effort(jacobian, goal, rho, most=most)
        return wanted, rho

    def _most(self) -> Vector:
        """Return the largest tension of each fibre at its present length [N]: full at rest, 0 when fully shortened."""
        shares = self._energy.lengths(self.nodes) / self._lengths
        return self.strength * np.clip((shares - _RULES.min_length) / (1.0 - _RULES.min_length), 0.0, 1.0)

    def _weight(self, rows: Float[np.ndarray, "dofs rows"]) -> float:
        """Rho, by what the strongest fibre can do to these points at rest; not less for points that are pinned."""
        moves = self._resting_pulls.T @ self._resting_stiffness.solve(rows)
        able = float((moves**2).sum(axis=1).max(initial=0.0))
        return self._effort * max(able, _RULES.min_mobility * self._able)

    def _farthest(self, change: Vector) -> float:
        """Return the largest displacement of a node by a change of tensions, to first order, in sizes of the body."""
        forces = self._pulls(self.nodes, self.tensions) @ change
        return float(np.abs(self._stiffness.solve(forces)).max()) / self._size

    def _pulls(self, nodes: Nodes, tensions: Vector) -> csc_array:
        return self._assembly.control_derivative(nodes, tensions)

    def _relax(self, tensions: Vector, iterations: int) -> NewtonResult:
        """Take a few Newton steps at these tensions; the first costs no factorization."""
        return minimize(
            self._assembly,
            self.nodes,
            tensions,
            round_off=self._noise,
            options=NewtonOptions(tolerance=_RULES.force_tolerance, iterations=iterations),
            warp=self._warp,
            stiffness=self._stiffness,
        )

    def _objective(self, nodes: Nodes, tensions: Vector, aims: list["_Aim"], rho: float) -> float:
        missed = sum(aim.weight**2 * float(((aim.points.positions(nodes) - aim.goals) ** 2).sum()) for aim in aims)
        return 0.5 * missed + 0.5 * rho * float(tensions @ tensions)

    def _largest_move(self) -> float:
        """The square of how far the strongest fibre moves a node along an axis at rest [m^2/N^2], of some nodes."""
        nodes = np.linspace(0, len(self.nodes) - 1, _RULES.num_samples).astype(int)
        rows = np.zeros((self.nodes.size, len(nodes)))
        rows[nodes * self.nodes.shape[1], np.arange(len(nodes))] = 1.0
        return float(((self._resting_pulls.T @ self._resting_stiffness.solve(rows)) ** 2).max())


@dataclass(frozen=True, eq=False)
class _Aim:
    """Points, where they should be [m], and how much a meter counts."""

    points: Anchors
    goals: Points
    weight: float


@dataclass(frozen=True, kw_only=True)
class _FreePosingRules:
    """Weights and limits of an update.

    Attributes:
        calm_weight: weight of a meter of a calm point, next to one of a held point.
        min_length: length, as a share of that at rest, at which a muscle cannot pull: the force falls with the length.
        max_step: maximum motion of a node in an update, in sizes of the body.
        min_step: minimum step; a goal that moves on asks for longer ones again.
        still: motion of all nodes below which a step counts as none, in sizes of the body.
        num_tries: steps tried in one update before the body stays where it is.
        num_softenings: times that the weight of the effort is raised in one update.
        overload: share by which a fibre may be asked for more than it can pull.
        iterations: Newton steps in an update; the next update removes the remaining force.
        far_iterations: Newton steps where a body is far from rest.
        force_tolerance: residual force that counts as none, as a share of the largest tension.
        min_mobility: floor of mobility: points that hardly move are pulled as if they moved a tenth as far as the
            freest.
        num_samples: number of nodes by which that is measured.
        shift: share of the largest entry that is added to the diagonal of a singular Hessian.
    """

    calm_weight: float = 0.03
    min_length: float = 0.4
    max_step: float = 0.15
    min_step: float = 1e-4
    still: float = 2e-5
    num_tries: int = 3
    num_softenings: int = 8
    overload: float = 0.05
    iterations: int = 1
    far_iterations: int = 4
    force_tolerance: float = 1e-5
    min_mobility: float = 1e-2
    num_samples: int = 24
    shift: float = 1e-6


_RULES = _FreePosingRules()
