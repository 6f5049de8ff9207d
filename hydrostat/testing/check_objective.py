"""`check_objective`: whether an `Objective` keeps its contract."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.ik import EquilibriumState, Objective, Residual, StateJacobian
from hydrostat.simulation import Contractions, Equilibrium, Simulation
from hydrostat.testing.differences import ConformanceError, central_differences, steps


def check_objective(
    objective: Objective,
    simulation: Simulation,
    contractions: Contractions,
    *,
    tolerance: float = 1e-5,
    solver: float = 1e-13,
    postures: int = 5,
    seed: int = 0,
) -> None:
    """Check all guarantees of an objective on one robot, at one pose; run it at several poses, also strongly bent ones.

    The reference is central differences of equilibria, solved to rounding precision at slightly different contractions.
    They are computed with several steps, and the best counts, because a wrong derivative agrees with none.
    Other checks: shapes, the same number of rows in every posture, finite values, repeatable results, errors that are
    not negative, and no error above 0 where the residual is zero. Avoid poses at a kink of the objective, such as a
    cable that just becomes taut. If cables have friction, every equilibrium is reached straight from rest, so that the
    derivatives are those of continued motion.

    Args:
        objective: objective to check.
        simulation: simulation of a robot; its cables may have friction.
        contractions: the pose [m].
        tolerance: largest relative error of the derivatives.
        solver: residual of the precise solves, as a fraction of the largest applied force.
        postures: number of other equilibria, at random contractions between 0 and twice those given.
        seed: random seed.

    Raises:
        ConformanceError: the first failed check, with its error and position.
        NotConvergedError: no equilibrium at one of these contractions.
    """
    options = replace(simulation.options, tolerance=solver)
    sharp = Simulation(simulation.robot, options=options, body=simulation.body)
    check = _ObjectiveCheck(objective, sharp, sharp.solve(contractions), tolerance)
    check.shapes()
    random = np.random.default_rng(seed)
    for _ in range(postures):
        check.posture(random.uniform(0.0, 2.0, len(check.pose.contractions)) * check.pose.contractions)
    check.repeats()
    check.check_jacobian()


class _ObjectiveCheck:
    """One objective at one pose, and a method for each promise."""

    def __init__(self, objective: Objective, simulation: Simulation, pose: Equilibrium, tolerance: float) -> None:
        self.objective, self.simulation, self.pose, self.tolerance = objective, simulation, pose, tolerance
        self.term: Residual = objective.bind(simulation)
        self.at = EquilibriumState.at(simulation, pose)
        self.rows = np.asarray(self.term.residual(self.at)).shape
        self.size = simulation.robot.body.mesh.size

    def shapes(self) -> None:
        """The residual is a row of numbers, the derivatives have a column for each winch."""
        if len(self.rows) != 1:
            raise ConformanceError("residual", f"it has the shape {self.rows}, the contract names (rows,)")
        derivatives = self._difference_jacobian(self.term)
        shape = (*self.rows, len(self.pose.contractions))
        if derivatives.shape != shape:
            raise ConformanceError("jacobian", f"they have the shape {derivatives.shape}, the contract names {shape}")
        if not np.isfinite(derivatives).all():
            raise ConformanceError("jacobian", "they are not finite", index=_place(~np.isfinite(derivatives)))
        self._values(self.at)

    def posture(self, contractions: Vector) -> None:
        """Another pose has as many rows, all finite, and errors that fit them."""
        self._values(EquilibriumState.at(self.simulation, self._solve(contractions)))

    def repeats(self) -> None:
        """An answer is the same when asked again, of this term or a new one, whatever was asked in between."""
        rest = EquilibriumState.at(self.simulation, self.simulation.solve({}))
        again = self.objective.bind(self.simulation)
        first, derivatives, errors = (
            self.term.residual(self.at),
            self._difference_jacobian(self.term),
            dict(self.term.errors(self.at)),
        )
        for term in (self.term, again):
            term.residual(rest)
            if not np.array_equal(term.residual(self.at), first):
                raise ConformanceError("residual", "it is another when asked again at the same posture")
            if not np.array_equal(self._difference_jacobian(term), derivatives):
                raise ConformanceError("jacobian", "they are others when asked again at the same posture")
            if dict(term.errors(self.at)) != errors:
                raise ConformanceError("errors", "they are others when asked again at the same posture")

    def check_jacobian(self) -> None:
        """The derivatives are the derivative of the residual along equilibria."""
        exact = self._difference_jacobian(self.term)
        best: tuple[float, tuple[int, ...]] = (np.inf, ())
        reach = 0.1  # steps of contractions begin with a thousandth of this fraction of the body's size
        for step in steps(reach * self.size):
            found = central_differences(self._residual, self.pose.contractions, np.arange(exact.shape[1]), step)
            scales = np.maximum(np.abs(found), np.abs(exact)).max(axis=0, initial=0.0)
            scale = np.where(scales > 1e-9 * scales.max(initial=0.0), scales, 1.0)
            errors = np.nan_to_num(np.abs(found - exact) / scale, nan=np.inf)
            worst = float(errors.max(initial=0.0))
            if worst < best[0]:
                best = worst, _place(errors)
            if worst <= self.tolerance:
                return
        raise ConformanceError(
            "jacobian", "[row, winch] is not the derivative of the residual", index=best[1], relative_error=best[0]
        )

    def _values(self, posture: EquilibriumState) -> None:
        residual = np.asarray(self.term.residual(posture))
        if residual.shape != self.rows:
            raise ConformanceError(
                "residual", f"it has {residual.shape} rows at one posture and {self.rows} at another"
            )
        if not np.isfinite(residual).all():
            raise ConformanceError("residual", "it is not finite", index=_place(~np.isfinite(residual)))
        self._errors(self.term.errors(posture), residual)

    def _errors(self, errors: Mapping[str, float], residual: Float[np.ndarray, " rows"]) -> None:
        for name, error in errors.items():
            if not (np.isfinite(error) and error >= 0):
                raise ConformanceError("errors", f"{name} is {error}, which is no distance")
            if error > 0 and not residual.any():
                raise ConformanceError("errors", f"{name} is {error:.3g} m where the residual is zero")

    def _residual(self, contractions: Vector) -> Float[np.ndarray, " rows"]:
        return np.asarray(self.term.residual(EquilibriumState.at(self.simulation, self._solve(contractions))))

    def _solve(self, contractions: Vector) -> Equilibrium:
        start = None if self.simulation.assembly.has_history else self.pose
        return self.simulation.solve(contractions, start=start)

    def _difference_jacobian(self, term: Residual) -> np.ndarray:
        return np.asarray(term.jacobian(self.at, StateJacobian.at(self.simulation, self.pose)))


def _place(array: np.ndarray) -> tuple[int, ...]:
    return tuple(int(i) for i in np.unravel_index(int(np.argmax(array)), array.shape)) if array.size else ()
