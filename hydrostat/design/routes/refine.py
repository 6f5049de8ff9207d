"""`refine`: winches, via points, stoppers and spools, moved to where the pose error is least."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.design.region import Region
from hydrostat.design.routes.evaluator import Evaluator, Trial
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.margins import margins
from hydrostat.design.routes.search_rules import RULES
from hydrostat.ik import least_squares, spool_arms


@dataclass(frozen=True, kw_only=True)
class RefineOptions:
    """Limits of a refinement."""

    iterations: int = 40  # most steps
    effort: float = 0.02  # error, as a share of the present one, that the tension limit of a cable is worth
    # error, as a share of the present one, that a cable which turns by 1 rad at every point is worth: turns rub (E14),
    # and what does not matter to the poses should look as if it had been meant
    straightness: float = 0.1
    progress: float = 3e-3  # it ends after steps that lower the cost by less than this share
    stop_error: float = 0.0  # error [m] at which it ends
    directions: int = (
        2  # singular vectors of the tolerances that are followed; 0: the spread is left out of sensitivities
    )


def refine(evaluator: Evaluator, region: Region, trial: Trial, options: RefineOptions) -> Trial:
    """Levenberg and Marquardt over all numbers of a layout and the contractions of every pose at once.

    Residuals are linearized by the adjoint; limits of the layout, on contractions and tensions are rows of each step;
    a step is pushed back into what can be built before it is tried, and taken where the cost falls.
    """
    return _Refinement(evaluator, region, options).run(trial)


@dataclass(frozen=True, eq=False)
class Model:
    """A trial to first order: |right + matrix d|^2, rows d <= left, for d = free numbers, then contractions."""

    matrix: np.ndarray
    right: Vector
    rows: np.ndarray
    left: Vector
    scale: Vector
    free: int


class _Refinement:
    def __init__(self, evaluator: Evaluator, region: Region, options: RefineOptions) -> None:
        self.evaluator, self.region, self.options = evaluator, region, options
        self.limit = evaluator.constraints.tension_limit
        self.reach = RULES.point_step * evaluator.source.body.mesh.size
        self.damping = RULES.first_damping

    def run(self, trial: Trial) -> Trial:
        idle = 0
        for _ in range(self.options.iterations):
            if trial.built_error <= self.options.stop_error:
                break
            effort = (
                self.options.effort
                * trial.built_error
                / (self.limit * np.sqrt(len(trial.poses) * len(trial.layout.routes)))
            )
            bend = self.options.straightness * trial.built_error / np.sqrt(max(len(turns(trial.layout)), 1))
            found = self._step(trial, effort, bend)
            if found is None:
                break
            gain = 1.0 - self._merit(found, effort, bend) / self._merit(trial, effort, bend)
            idle = idle + 1 if gain < 2 * self.options.progress else 0
            trial = found
            if idle >= 2:
                break
        return trial

    def _merit(self, trial: Trial, effort: float, bend: float) -> float:
        """Squares of the error as built, effort and turns, and of what tensions exceed."""
        total = trial.built_error**2 + float(((bend * turns(trial.layout)) ** 2).sum())
        for pose in trial.poses:
            over = self._excess(trial, pose.tensions)
            total += float(
                (effort**2) * (pose.tensions**2).sum() + (RULES.excess_weight * effort) ** 2 * (over**2).sum()
            )
        return total

    def _excess(self, trial: Trial, tensions: Vector) -> Vector:
        """Tensions above their limit, and torques above theirs by the radius of spools [N]."""
        over, torque = np.maximum(tensions - self.limit, 0.0), self.evaluator.constraints.torque
        if torque is None:
            return over
        turned = np.abs(spool_arms(trial.simulation.robot) @ tensions)
        return np.append(over, np.maximum(turned - torque, 0.0) / self.evaluator.constraints.spool_radius)

    def _step(self, trial: Trial, effort: float, bend: float) -> Trial | None:
        """The first damped step that lowers the merit; None if none does. The damping follows what steps keep."""
        model = linear_model(
            self.evaluator, self.region, trial, effort=effort, bend=bend, reach=self.reach,
            directions=self.options.directions,
        )  # fmt: skip
        before = self._merit(trial, effort, bend)
        for _ in range(RULES.step_tries):
            step = self._solve_damped(model)
            found = None if step is None else self._try_step(trial, step, model.free, (before, bend))
            if step is not None and found is not None and (after := self._merit(found, effort, bend)) < before:
                promised = before - float(((model.right + model.matrix @ step) ** 2).sum())
                kept = (before - after) / max(promised, 1e-300)
                self.damping *= 0.3 if kept > RULES.good_step else 1.0 if kept > RULES.poor_step else 3.0
                self.damping = max(self.damping, RULES.min_damping)
                return found
            self.damping = max(4 * self.damping, RULES.min_damping)
            if self.damping > RULES.max_damping:
                break
        self.damping = RULES.first_damping
        return None

    def _solve_damped(self, model: Model) -> Vector | None:
        matrix = model.matrix * model.scale
        damping = self.damping * float(np.linalg.norm(matrix[:, : model.free], axis=0).max(initial=1e-12))
        ridge = np.full(len(model.scale), damping)
        ridge[model.free :] *= RULES.contraction_damping
        stacked = np.vstack([matrix, np.diag(np.maximum(ridge, 1e-9))])
        aim = np.concatenate([-model.right, np.zeros(len(ridge))])
        rows = model.rows * model.scale
        step = least_squares(stacked, aim, rows, model.left)
        if step is None:
            step = least_squares(stacked, aim, rows, np.maximum(model.left, 0.0))
        return None if step is None else model.scale * step

    def _try_step(self, trial: Trial, step: Vector, free: int, beaten: tuple[float, float]) -> Trial | None:
        """Try a step; None without equilibrium, or if the merit is not below `beaten` at that weight of turns."""
        layout = trial.layout
        longest = np.abs(layout.ties @ step[:free])[: layout.starts[-2]].max(initial=0.0)
        if longest > 2 * self.reach:
            step = step * (2 * self.reach / longest)
        moved = pushed_back(
            layout.at(layout.numbers + layout.ties @ step[:free]), self.region, RULES.felt_limits * self.reach
        )
        if moved is None:
            return None
        changes = step[free:].reshape(len(trial.poses), -1)
        contractions = []
        low = [-release for release in moved.releases]
        for pose, change in zip(trial.poses, changes, strict=True):
            contractions.append(np.clip(pose.contractions + change, low, moved.travels))
        merit, bend = beaten
        room = merit - float(((bend * turns(moved)) ** 2).sum())
        return self.evaluator.hold_contractions(moved, contractions, trial, worst=float(np.sqrt(max(room, 0.0))))


def _pull_limits(
    evaluator: Evaluator, trial: Trial, tensions: Vector, rises: Float[np.ndarray, "cables numbers"]
) -> Iterator[tuple[Float[np.ndarray, "limits numbers"], Vector]]:
    """Rows and room of the limits on tensions and torques that a pose is near."""
    limit, torque = evaluator.constraints.tension_limit, evaluator.constraints.torque
    near = tensions > 0.5 * limit
    yield rises[near], limit - tensions[near]
    if torque is not None:
        arms = spool_arms(trial.simulation.robot)
        arms = np.where(arms @ tensions < 0, -1.0, 1.0)[:, None] * arms
        turned = arms @ tensions > 0.5 * torque
        yield arms[turned] @ rises, torque - arms[turned] @ tensions


def linear_model(
    evaluator: Evaluator,
    region: Region,
    trial: Trial,
    *,
    effort: float,
    reach: float,
    bend: float = 0.0,
    directions: int = 2,
) -> Model:
    """A trial to first order, with limits within `reach` [m]; effort weighs tensions [m/N], bend turns of 1 rad [m]."""
    layout = trial.layout
    winches, free = len(layout.sites), layout.ties.shape[1]
    count = free + winches * len(trial.poses)
    matrix, right, rows, lefts = [], [], [], []
    for index, pose in enumerate(trial.poses):
        sensitivities = trial.sensitivities[index]
        own = np.zeros((len(sensitivities.contractions), count))
        own[:, :free] = _by_numbers(layout, sensitivities) @ layout.ties
        begin = free + winches * index
        own[:, begin : begin + winches] = sensitivities.contractions
        markers = len(own) - len(layout.routes)
        matrix += [-evaluator.weights[index][:, None] * own[:markers], effort * own[markers:]]
        right += [evaluator.residual(trial.simulation, index, pose.nodes), effort * pose.tensions]
        for moved, changed in _solve_variations(evaluator, trial, index, directions):
            scattered = np.zeros((markers, count))
            scattered[:, :free] = changed[:, winches:] @ layout.ties
            scattered[:, begin : begin + winches] = changed[:, :winches]
            matrix.append(scattered)
            right.append(moved)
        for row, left in _pull_limits(evaluator, trial, pose.tensions, own[markers:]):
            rows.append(row)
            lefts.append(left)
        for winch in range(winches):
            for sign, left in (
                (1.0, layout.travels[winch] - pose.contractions[winch]),
                (-1.0, pose.contractions[winch] + layout.releases[winch]),
            ):
                row = np.zeros((1, count))
                row[0, begin + winch] = sign
                rows.append(row)
                lefts.append(np.array([left]))
    bends, sensitivities = turns(layout), turn_derivatives(layout)
    # What friction adds to the variance falls with the turns, as if in proportion: so many times do they weigh more.
    rubbed = sum(float(((w * one[:, -1]) ** 2).sum()) for w, one in zip(evaluator.weights, trial.columns, strict=True))
    bend = float(np.hypot(bend, np.sqrt(rubbed) / max(float(np.linalg.norm(bends)), 1e-9)))
    straight = np.zeros((len(bends), count))
    straight[:, :free] = bend * sensitivities @ layout.ties
    matrix.append(straight)
    right.append(bend * bends)
    geometry = margins(layout, region, reach=reach)
    tied = np.zeros((len(geometry.rows), count))
    tied[:, :free] = geometry.rows @ layout.ties
    scale = np.full(count, RULES.contraction_step * evaluator.constraints.travel)
    scale[:free] = _scales(layout, reach)
    return Model(
        np.vstack(matrix), np.concatenate(right), np.vstack([*rows, tied]),
        np.concatenate([*lefts, geometry.left]), scale, free,
    )  # fmt: skip


def _solve_variations(
    evaluator: Evaluator, trial: Trial, index: int, most_directions: int
) -> Iterator[tuple[Vector, np.ndarray]]:
    """Yield marker moves of a pose as built otherwise, and their Jacobians by contractions, then layout numbers.

    The variance is the sum of squares of the singular values of the tolerances' columns. Its gradient is exact if each
    right singular vector is held: then it is that of the move from here to a robot built with these tolerances. Only
    the strongest few are looked at, and of the tolerances only those of holes and spools.
    """
    layout, pose, weight = trial.layout, trial.poses[index], evaluator.weights[index]
    places, cables, winches = layout.starts[-2], len(layout.routes), len(layout.sites)
    which = np.r_[0:places, places + cables : places + cables + winches]
    if not most_directions:
        return
    columns = weight[:, None] * trial.columns[index][:, which]
    _, values, right = np.linalg.svd(columns, full_matrices=False)
    most = RULES.min_spread * trial.built_error
    for direction in range(min(most_directions, int((values > most).sum()))):
        numbers = layout.numbers.copy()
        numbers[:places] += evaluator.uncertainty.sewing * right[direction, :places]
        scale = 1.0 + evaluator.uncertainty.spool * right[direction, places:]
        found = evaluator.solve_variation(layout.at(numbers), pose, scale * pose.contractions, index)
        if found is None:
            continue
        simulation, nodes, sensitivities = found
        here = evaluator.residual(trial.simulation, index, pose.nodes)
        moved = here - evaluator.residual(simulation, index, nodes)
        markers = len(moved)
        before = trial.sensitivities[index]
        own, other = (
            np.hstack([by[:markers], _by_numbers(layout, numbers)[:markers]])
            for by, numbers in ((before.contractions, before), (sensitivities.contractions * scale, sensitivities))
        )
        yield moved, weight[:, None] * (other - own)


def turns(layout: Layout) -> Vector:
    """Turn of each cable at its points, coordinate by coordinate [rad, roughly].

    A turn is the difference of the two segments at a point, over their mean length in this layout's cable.
    """
    parts = [np.diff(layout.routes[index].points, n=2, axis=0).ravel() / mean for index, mean in _bending(layout)]
    return np.concatenate([np.zeros(0), *parts])


def turn_derivatives(layout: Layout) -> np.ndarray:
    """Sensitivities of `turns` by the numbers of the layout, (turns, numbers), the mean lengths left as they are."""
    rows = [np.zeros((0, layout.size))]
    for index, mean in _bending(layout):
        inner = np.arange(len(layout.routes[index].points) - 2)[:, None]
        axes = np.arange(layout.dim)
        begins = np.array([layout.place_of(index, point).start for point in range(len(inner) + 2)])
        own = np.zeros((len(inner), layout.dim, layout.size))
        for step, weight in enumerate((1.0, -2.0, 1.0)):
            own[inner, axes, begins[inner + step] + axes] += weight / mean
        rows.append(own.reshape(-1, layout.size))
    return np.vstack(rows)


def _bending(layout: Layout) -> list[tuple[int, float]]:
    """Numbers of the cables that may turn, and the mean length of their segments [m]."""
    return [
        (index, float(np.linalg.norm(np.diff(route.points, axis=0), axis=1).mean()))
        for index, route in enumerate(layout.routes)
        if route.kept is None and len(route.points) > 2
    ]


def _scales(layout: Layout, reach: float) -> Vector:
    """Large step of each free number."""
    slacks, ratios = layout.starts[-2:]
    full = np.full(layout.size, reach)
    full[slacks:ratios] = max(0.25 * layout.constraints.slack, 1e-4)
    full[ratios:] = 0.2
    return np.abs(layout.ties.T) @ full / np.maximum(np.abs(layout.ties).sum(axis=0), 1e-300)


def pushed_back(layout: Layout, region: Region, reach: float) -> Layout | None:
    """The nearest layout that can be built, by steps of least length; None if that is not found."""
    ties = layout.ties
    for _ in range(RULES.max_pushes):
        limits = margins(layout, region, reach=reach)
        if not len(limits.left) or limits.left.min() >= -RULES.limit_precision:
            return layout
        rows = limits.rows @ ties
        step = least_squares(np.eye(ties.shape[1]), np.zeros(ties.shape[1]), rows, limits.left)
        if step is None:
            return None
        moved = ties @ step
        if np.abs(moved).max(initial=0.0) > layout.source.body.mesh.size:
            return None
        layout = layout.at(layout.numbers + moved)
    limits = margins(layout, region, reach=0.0)
    return layout if not len(limits.left) or limits.left.min() >= -RULES.limit_precision else None


def moves_of(trial: Trial, pose: int) -> tuple[np.ndarray, np.ndarray]:
    """Jacobians of the marker coordinates of a pose: by the numbers of the layout, and by the contractions."""
    sensitivities = trial.sensitivities[pose]
    markers = len(sensitivities.contractions) - len(trial.layout.routes)
    return _by_numbers(trial.layout, sensitivities)[:markers], sensitivities.contractions[:markers]


def _by_numbers(layout: Layout, sensitivities) -> np.ndarray:
    """Sensitivities by the numbers of a layout, (rows, numbers)."""
    full = np.zeros((len(sensitivities.contractions), layout.size))
    begin = 0
    for index, route in enumerate(layout.routes):
        for point in range(len(route.points)):
            full[:, layout.place_of(index, point)] += sensitivities.points[:, begin + point]
        begin += len(route.points)
    slacks, ratios = layout.starts[-2:]
    full[:, slacks:ratios] = sensitivities.slack
    full[:, ratios:] = sensitivities.ratios
    return full
