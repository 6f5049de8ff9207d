"""`check_energy`: whether an `Energy` keeps its contract."""

from collections.abc import Callable, Iterator

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics import Energy
from hydrostat.testing.check_solver_contract import check_history, check_law, check_loads, check_steps, check_supports
from hydrostat.testing.differences import ConformanceError, central_differences, steps


def check_energy(
    energy: Energy, nodes: Nodes, controls: Vector, *, tolerance: float = 1e-6, coordinates: int = 200, seed: int = 0
) -> None:
    """Check all guarantees of an energy at one state; run it at several states, also strongly deformed ones.

    The reference is central differences: of the value for the gradient, of the gradient for the Hessian and for the
    control derivative. Each is computed with several steps, and the best counts, because a wrong derivative agrees with
    none. Other checks: shapes, symmetry, terms that depend only on their stencil and their control, a value that is
    never NaN, a projected Hessian that is semidefinite and lowers no eigenvalue, the flag `convex`, and the optional
    methods: low-rank Hessians with their law, largest force and step, changing terms, supports, loads, parameters,
    history.

    If part of the Hessian has low rank, a term may depend on the nodes of other terms through it. Then the check
    compares the total Hessian, the blocks of all terms plus G D G^T, with the derivative of the total gradient.

    Args:
        energy: energy to check.
        nodes: a state where its value is finite [m].
        controls: all controls of the robot.
        tolerance: largest relative error of a derivative.
        coordinates: number of nodal coordinates to vary, drawn at random if the body has more.
        seed: random seed.

    Raises:
        ConformanceError: the first failed check, with its error and position.
    """
    check = _EnergyCheck(energy, nodes, controls, tolerance, np.random.default_rng(seed), coordinates)
    check.shapes()
    check.values()
    check.gradient()
    check.hessian()
    check.control_gradient()
    check.low_rank_hessian()
    check.projection()
    check.convexity()
    check_steps(energy, nodes, controls, check.states())
    check_supports(energy, nodes, controls)
    check_loads(energy, nodes, controls)
    check_history(energy, nodes, controls)


class _EnergyCheck:
    """One energy at one state, and a method for each promise."""

    def __init__(
        self,
        energy: Energy,
        nodes: Nodes,
        controls: Vector,
        tolerance: float,
        random: np.random.Generator,
        coordinates: int,
    ) -> None:
        self.energy, self.nodes, self.controls = energy, nodes, controls
        self.tolerance, self.random = tolerance, random
        self.size = float(np.ptp(nodes, axis=0).max())
        self.point = nodes.ravel()
        count = min(coordinates, nodes.size)
        self.variables = np.sort(random.choice(nodes.size, count, replace=False))

    def shapes(self) -> None:
        """The value is finite here, and every array has the shape that the contract names."""
        if not np.isfinite(self.energy.value(self.nodes, self.controls)):
            raise ConformanceError("value", "it must be finite at the state that is checked")
        energy, (terms, corners), dim = self.energy, self.energy.stencils.shape, self.nodes.shape[1]
        self._shape("gradient", energy.gradient(self.nodes, self.controls), (terms, corners, dim))
        self._shape("hessian", energy.hessian(self.nodes, self.controls), (terms, corners * dim, corners * dim))
        for share in (0.0, 1.0):
            projected = energy.projected_hessian(self.nodes, self.controls, share)
            self._shape("projection", projected, (terms, corners * dim, corners * dim))
        if (part := energy.low_rank_hessian(self.nodes, self.controls)) is not None:
            rank = part.columns.shape[-1]
            self._shape("low_rank_hessian", part.columns, (self.nodes.size, rank))
            self._shape("low_rank_hessian", part.weights, (rank, rank))
            if part.elongations is not None:
                self._shape("low_rank_hessian", part.elongations, (rank,))
        if energy.supports is not None:
            self._shape("supports", energy.supports, (terms,))
        if energy.controls is not None:
            self._shape("controls", energy.controls, (terms,))
            derivative = energy.control_gradient(self.nodes, self.controls)
            self._shape("control gradient", derivative, (terms, corners, dim))

    def values(self) -> None:
        """The value is never NaN; wherever it is finite, so are the gradient and the Hessian."""
        for nodes in self.states():
            value = self.energy.value(nodes, self.controls)
            if np.isnan(value) or value == -np.inf:
                raise ConformanceError("value", f"{value} at some positions; where it is not defined it must be +inf")
            if np.isfinite(value):
                for name, blocks in (("gradient", self.energy.gradient), ("hessian", self.energy.hessian)):
                    if not np.isfinite(blocks(nodes, self.controls)).all():
                        raise ConformanceError(name, "it is not finite at some positions where the value is")

    def gradient(self) -> None:
        """The gradient blocks, summed over the terms, are the derivative of the value."""
        blocks = self.energy.gradient(self.nodes, self.controls)
        total = np.zeros(self.nodes.shape)
        np.add.at(total, self.energy.stencils, blocks)
        stiffness = float(np.abs(self.energy.hessian(self.nodes, self.controls)).max(initial=0.0))
        if (part := self.energy.low_rank_hessian(self.nodes, self.controls)) is not None:
            diagonal = np.einsum("dr,rs,ds->d", part.columns, part.weights, part.columns)
            stiffness += float(np.abs(diagonal).max(initial=0.0))
        rounding = 64 * np.finfo(float).eps * abs(self.energy.value(self.nodes, self.controls))

        def error(step: float) -> np.ndarray:
            found = central_differences(self._value, self.point, self.variables, step)[0]
            exact = total.ravel()[self.variables]
            # Neither a force below the rounding of the value, nor one that the step itself brings about, can be told.
            scale = max(_largest(found), _largest(exact), stiffness * step, rounding / step / self.tolerance)
            return np.abs(found - exact) / scale if scale else np.abs(found - exact)

        worst, place = self._best(error, self.size)
        index = tuple(int(i) for i in np.unravel_index(self.variables[place[0]], self.nodes.shape))
        if worst > self.tolerance and index[0] not in self.energy.stencils:
            raise ConformanceError(
                "stencil", "the value depends on a node of no stencil", index=index, relative_error=worst
            )
        self._judge("gradient", "[node, axis] is not the derivative of the value", worst, index)

    def hessian(self) -> None:
        """Each block is symmetric; the Hessian is the derivative of the gradient."""
        hessian = self.energy.hessian(self.nodes, self.controls)
        blocks = self.energy.gradient(self.nodes, self.controls)
        forces = np.abs(blocks).max(axis=(1, 2), initial=0.0) / self.size
        scales = np.maximum(np.abs(hessian).max(axis=(1, 2), initial=0.0), forces)
        scales = np.maximum(scales, 1e-9 * scales.max(initial=0.0))
        scales[scales == 0.0] = 1.0
        skew = np.abs(hessian - np.swapaxes(hessian, 1, 2)) / scales[:, None, None]
        self._judge("hessian", "[term, row, column] is not symmetric", skew.max(initial=0.0), _place(skew))
        part = self.energy.low_rank_hessian(self.nodes, self.controls)
        if part is None:
            self._hessian_of_terms(hessian, scales)
        else:
            self._hessian_of_all(hessian, part.columns, part.weights)

    def _hessian_of_terms(self, hessian: np.ndarray, scales: np.ndarray) -> None:
        """Each block is the derivative of its gradient block, which depends on no node outside its stencil."""
        terms, size = hessian.shape[:2]
        dim, dofs = self.nodes.shape[1], self._dofs()
        expected = np.zeros((terms, size, len(self.variables)))
        for column in range(size):
            place = np.searchsorted(self.variables, dofs[:, column])
            place[place == len(self.variables)] = 0
            chosen = np.flatnonzero(self.variables[place] == dofs[:, column])
            expected[chosen, :, place[chosen]] += hessian[chosen, :, column]

        def error(step: float) -> np.ndarray:
            found = central_differences(self._gradient, self.point, self.variables, step).reshape(terms, size, -1)
            return np.abs(found - expected) / scales[:, None, None]

        worst, (term, row, place) = self._best(error, self.size)
        variable = int(self.variables[place])
        if worst > self.tolerance and variable not in dofs[term]:
            index = (term, variable // dim)
            raise ConformanceError(
                "stencil", "[term, node]: it depends on a node outside its stencil", index=index, relative_error=worst
            )
        column = int(np.flatnonzero(dofs[term] == variable)[0]) if variable in dofs[term] else 0
        self._judge("hessian", "[term, row, column] is not the derivative of the gradient", worst, (term, row, column))

    def _hessian_of_all(self, hessian: np.ndarray, columns: np.ndarray, weights: np.ndarray) -> None:
        """The sum of all blocks and the part of low rank are the derivative of the summed gradient."""
        dofs = self._dofs()
        expected = columns @ weights @ columns.T
        np.add.at(expected, (dofs[:, :, None], dofs[:, None, :]), hessian)
        forces = self._total(self._gradient(self.point))
        scale = max(_largest(expected), _largest(forces) / self.size) or 1.0

        def total(point: np.ndarray) -> np.ndarray:
            return self._total(self._gradient(point))

        def error(step: float) -> np.ndarray:
            found = central_differences(total, self.point, self.variables, step)
            return np.abs(found - expected[:, self.variables]) / scale

        worst, (row, place) = self._best(error, self.size)
        index = (row, int(self.variables[place]))
        message = "[row, column] of the whole, with the part of low rank, is not the derivative of the gradient"
        self._judge("hessian", message, worst, index)

    def control_gradient(self) -> None:
        """The control derivative is that of the gradient, and terms depend on no control but their own."""
        blocks = self.energy.gradient(self.nodes, self.controls)
        count = len(self.controls)
        expected = np.zeros((*blocks.shape, count))
        if self.energy.controls is not None:
            derivative = self.energy.control_gradient(self.nodes, self.controls)
            expected[np.arange(len(blocks)), :, :, self.energy.controls] = derivative
        if not count:
            return
        natural = max(self.size, float(np.abs(self.controls).max()))

        def force(controls: Vector) -> np.ndarray:
            return self.energy.gradient(self.nodes, controls).ravel()

        def error(step: float) -> np.ndarray:
            found = central_differences(force, self.controls, np.arange(count), step).reshape(expected.shape)
            scale = max(_largest(found), _largest(expected), _largest(blocks) / natural)
            return np.abs(found - expected) / (scale or 1.0)

        worst, index = self._best(error, natural)
        self._judge("control gradient", "[term, corner, axis, control] is not the derivative", worst, index)

    def low_rank_hessian(self) -> None:
        """G and D are finite, D is symmetric and positive semidefinite; they derive from elongations and law."""
        for nodes in self.states():
            if not np.isfinite(self.energy.value(nodes, self.controls)):
                continue
            part = self.energy.low_rank_hessian(nodes, self.controls)
            if part is None:
                continue
            columns, weights = part.columns, part.weights
            if not (np.isfinite(columns).all() and np.isfinite(weights).all()):
                raise ConformanceError("low_rank_hessian", "it is not finite at some positions where the value is")
            scale = _largest(weights) or 1.0
            skew = np.abs(weights - weights.T)
            if _largest(skew) > 1e-9 * scale:
                error = _largest(skew) / scale
                raise ConformanceError(
                    "low_rank_hessian", "D is not symmetric", index=_place(skew), relative_error=error
                )
            negative = -float(np.linalg.eigvalsh(weights).min(initial=0.0)) / scale
            if negative > 1e-9:
                raise ConformanceError("low_rank_hessian", "D has a negative eigenvalue", relative_error=negative)
            if part.law is not None and part.elongations is not None:
                check_law(part)
        part = self.energy.low_rank_hessian(self.nodes, self.controls)
        if part is not None and part.elongations is not None:
            self._elongations(part.columns)

    def _elongations(self, columns: np.ndarray) -> None:
        """G is the derivative of the elongations."""

        def elongations(point: np.ndarray) -> np.ndarray:
            found = self.energy.low_rank_hessian(point.reshape(self.nodes.shape), self.controls)
            assert found is not None
            assert found.elongations is not None
            return found.elongations

        def error(step: float) -> np.ndarray:
            found = central_differences(elongations, self.point, self.variables, step)
            return np.abs(found - columns.T[:, self.variables]) / (_largest(columns) or 1.0)

        worst, place = self._best(error, self.size)
        self._judge("low_rank_hessian", "[spring, variable] of G is not the derivative of its elongation", worst, place)

    def projection(self) -> None:
        """The projected Hessian is the Hessian at share 0, semidefinite at 1, linear between; no eigenvalue falls."""
        for nodes in self.states():
            if not np.isfinite(self.energy.value(nodes, self.controls)):
                continue
            none, half, whole = (
                self.energy.projected_hessian(nodes, self.controls, share) for share in (0.0, 0.5, 1.0)
            )
            plain = self.energy.hessian(nodes, self.controls)
            scales = np.maximum(np.abs(plain).max(axis=(1, 2), initial=0.0), np.finfo(float).tiny)
            change = whole - plain
            for message, size in (
                ("at share 0 it is not the Hessian of this term", np.abs(none - plain).max(axis=(1, 2), initial=0.0)),
                ("at share 1 this term has a negative eigenvalue", -_least_eigenvalues(whole)),
                ("it lowers an eigenvalue of this term", -_least_eigenvalues(change)),
                (
                    "at share 1/2 this term is not half projected",
                    np.abs(half - plain - 0.5 * change).max(axis=(1, 2), initial=0.0),
                ),
            ):
                errors = np.nan_to_num(size / scales, nan=np.inf)
                if (worst := float(errors.max(initial=0.0))) > 1e-9:
                    raise ConformanceError("projection", message, index=_place(errors), relative_error=worst)

    def convexity(self) -> None:
        """An energy that says it is convex has no block with a negative eigenvalue."""
        if not self.energy.convex:
            return
        for nodes in self.states():
            if not np.isfinite(self.energy.value(nodes, self.controls)):
                continue
            eigenvalues = np.linalg.eigvalsh(self.energy.hessian(nodes, self.controls))
            least = -eigenvalues[:, 0] / np.maximum(np.abs(eigenvalues).max(axis=1), np.finfo(float).tiny)
            worst = float(least.max(initial=0.0))
            if worst > 1e-9:
                term = int(np.argmax(least))
                raise ConformanceError(
                    "convexity", "this term's Hessian has a negative eigenvalue", index=(term,), relative_error=worst
                )

    def states(self) -> Iterator[Nodes]:
        """The state itself, and others scattered more and more about it."""
        yield self.nodes
        for amplitude in (1e-3, 1e-2, 0.03, 0.1, 0.3, 1.0, 100.0):
            yield self.nodes + amplitude * self.size * self.random.standard_normal(self.nodes.shape)

    def _value(self, point: np.ndarray) -> np.ndarray:
        return np.array([self.energy.value(point.reshape(self.nodes.shape), self.controls)])

    def _gradient(self, point: np.ndarray) -> np.ndarray:
        return self.energy.gradient(point.reshape(self.nodes.shape), self.controls).ravel()

    def _dofs(self) -> np.ndarray:
        """Degrees of freedom of each term, in the order of its blocks."""
        stencils, dim = self.energy.stencils, self.nodes.shape[1]
        return (stencils[:, :, None] * dim + np.arange(dim)).reshape(len(stencils), stencils.shape[1] * dim)

    def _total(self, blocks: np.ndarray) -> np.ndarray:
        """The sum of the gradient blocks of all terms, (dofs,)."""
        return np.bincount(self._dofs().ravel(), blocks, self.nodes.size)

    def _best(self, error: Callable[[float], np.ndarray], scale: float) -> tuple[float, tuple[int, ...]]:
        """Largest entry, and its place, of the error at the step where that is smallest."""
        best: tuple[float, tuple[int, ...]] | None = None
        for step in steps(scale):
            errors = np.nan_to_num(error(step), nan=np.inf)
            worst = float(errors.max())
            if best is None or worst < best[0]:
                best = worst, _place(errors)
            if worst <= self.tolerance:
                break
        assert best is not None
        return best

    def _shape(self, check: str, array: np.ndarray, shape: tuple[int, ...]) -> None:
        if array.shape != shape:
            raise ConformanceError(check, f"it has the shape {array.shape}, the contract names {shape}")

    def _judge(self, check: str, message: str, error: float, index: tuple[int, ...]) -> None:
        if error > self.tolerance:
            raise ConformanceError(check, message, index=index, relative_error=error)


def _largest(array: np.ndarray) -> float:
    return float(np.nanmax(np.abs(array), initial=0.0))


def _least_eigenvalues(blocks: np.ndarray) -> np.ndarray:
    return np.linalg.eigvalsh(blocks)[:, 0]


def _place(array: np.ndarray) -> tuple[int, ...]:
    return tuple(int(i) for i in np.unravel_index(int(np.argmax(array)), array.shape))
