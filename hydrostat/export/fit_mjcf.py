"""`fit_mjcf`: the few numbers of a MuJoCo model, fitted to poses of hydrostat; it needs MuJoCo."""

from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.export.mjcf import MjcfModel
from hydrostat.export.mjcf_statics import MjcfStatics
from hydrostat.export.mjcf_tuning import MAX_POISSON, MjcfTuning
from hydrostat.progress import Progress
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.sobol import draw_sobol
from hydrostat.units import plural
from hydrostat.version import install_command


@dataclass(frozen=True)
class MjcfFitRules:
    """Rules of a fit, the same for all robots."""

    min_gain: float = 0.05  # a fit is kept if it lowers the error of the held-out poses by this share or more
    min_poses: int = 3  # fewest fitted poses
    num_held_out: int = 12  # held-out draws, the same for every number of fitted poses
    min_values: tuple[float, float, float] = (-1.0, -0.15, -0.3)  # ln of Young's factor, Poisson's shift, ln of gains
    max_values: tuple[float, float, float] = (1.0, 0.15, 0.3)
    value_steps: tuple[float, float, float] = (0.1, 0.02, 0.02)  # differences of these values in the least squares
    contraction_step: float = 0.01  # difference of contractions for the Jacobian of markers, share of their range
    max_steps: int = 4  # most steps of the least squares


RULES = MjcfFitRules()


Markers = Float[np.ndarray, "poses markers dim"]  # positions of all markers in some poses [m]


@dataclass(frozen=True, kw_only=True)
class MjcfPoseErrors:
    """Errors of a MuJoCo model in held-out poses.

    Attributes:
        rms: root mean square of the distances of the markers from those of hydrostat [m].
        median: median of these distances [m].
        largest: largest of these distances [m].
        jacobian: relative error of the Jacobian of markers by contractions, over all poses [-].
        jacobian_median: median of the relative errors of single poses [-].
        jacobian_largest: largest relative error of a single pose [-].
    """

    rms: float
    median: float
    largest: float
    jacobian: float
    jacobian_median: float
    jacobian_largest: float

    def describe(self) -> str:
        """Phrase with the figures."""
        return (
            f"markers off by {1e3 * self.rms:.2g} mm rms, {1e3 * self.median:.2g} mm median, "
            f"{1e3 * self.largest:.2g} mm at most, Jacobian by {100 * self.jacobian:.2g} % rms, "
            f"{100 * self.jacobian_median:.2g} % median, {100 * self.jacobian_largest:.2g} % at most"
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class MjcfFit:
    """Fit of a MuJoCo model, judged on poses that are not fitted. They also decide whether it is used.

    Attributes:
        tuning: fitted numbers.
        share: share of the travel of each winch up to which contractions were drawn.
        num_poses: number of fitted poses.
        num_held_out: number of held-out poses that both models have: the errors are those of these poses.
        num_left_out: number of drawn poses that have no equilibrium in the unfitted model, fitted or held out.
        num_lost: number of held-out poses that one model loses, there or one step of a contraction away.
        before: errors of the unfitted model.
        after: errors of the fitted model.
        travel: root mean square of the distances of the markers from rest in the held-out poses [m].
    """

    tuning: MjcfTuning
    share: float
    num_poses: int
    num_held_out: int
    num_left_out: int
    num_lost: int
    before: MjcfPoseErrors
    after: MjcfPoseErrors
    travel: float

    @property
    def is_worth_it(self) -> bool:
        """True if the rms error of the held-out poses falls by 5 % or more."""
        return self.after.rms < (1 - RULES.min_gain) * self.before.rms

    def describe(self) -> list[str]:
        """Lines with the figures."""
        lines = [
            f"fit: {plural(self.num_poses, 'pose')} up to {100 * self.share:g} % of the travel, and "
            f"{plural(self.num_held_out, 'held-out pose')} that move markers by {1e3 * self.travel:.2g} mm rms",
            f"held out, unfitted: {self.before.describe()}",
            f"held out, fitted: {self.after.describe()}",
        ]
        if self.num_left_out:
            lines.append(f"{plural(self.num_left_out, 'drawn pose')} left out: no equilibrium in MuJoCo")
        if self.num_lost:
            lines.append(f"{plural(self.num_lost, 'held-out pose')} lost: no equilibrium in one of the models")
        if not self.is_worth_it:
            lines.append(f"unfitted numbers kept: the error falls by less than {100 * RULES.min_gain:g} %")
        return lines


def fit_mjcf(robot: Robot, num_poses: int = 20, *, share: float = 0.25, progress: Progress | None = None) -> MjcfFit:
    """Fit Young's modulus, Poisson's ratio and a gain of each winch of a MuJoCo model to hydrostat poses.

    Contractions are scrambled Sobol points up to a share of the travel. The fit is a bounded least-squares fit to the
    markers, and also compensates for omissions of the model (`find_omissions`).

    Args:
        robot: robot with markers and winches.
        num_poses: number of fitted poses, 3 or more; 12 others are held out, the same for every `num_poses`.
        share: share of the travel of each winch, such as `MjcfError.range_share`.
        progress: callback with the number of model evaluations.

    Raises:
        InputError: MuJoCo is not installed, too few poses, a share outside 0 to 1, a robot without markers or winches,
            one that `mjcf_text` rejects, or too few poses with an equilibrium in MuJoCo.
    """
    if find_spec("mujoco") is None:
        raise InputError(f"MuJoCo is not installed: {install_command('export')}")
    if not robot.markers or not robot.winches:
        raise InputError("fitting a model needs a [[marker]] and a [[winch]]. Add them.")
    if num_poses < RULES.min_poses or not 0 < share <= 1:
        raise InputError(
            f"a fit needs {RULES.min_poses} poses or more and a share within 0 and 1, not {num_poses} and {share:g}"
        )
    return _MjcfSearch(robot, num_poses, share, progress).run()


class _MjcfSearch:
    """Poses of both programs, and least squares over the numbers of one."""

    def __init__(self, robot: Robot, num_poses: int, share: float, progress: Progress | None) -> None:
        self._robot, self._simulation, self._share, self._progress = robot, Simulation(robot), share, progress
        self._travels = share * np.array([winch.travel for winch in robot.winches])
        count = len(self._travels)
        inside = 2 * RULES.contraction_step  # held-out poses stay as far within the range, which ends contractions
        draws = [
            draw_sobol(count, num_poses, np.random.default_rng(0)),
            inside + (1 - 2 * inside) * draw_sobol(count, RULES.num_held_out, np.random.default_rng(1)),
        ]
        self._done, self._num_evaluations = 0, 0
        self._poses: list[tuple[Vector, Equilibrium]] = []
        self._nodes: list[Nodes] = []  # nodes of the MuJoCo model, from which searches begin
        self._fitted, self._held_out = self._draw(np.concatenate(draws) * self._travels, num_poses)
        self._num_left_out = num_poses + RULES.num_held_out - len(self._fitted) - len(self._held_out)
        if len(self._fitted) < max(RULES.min_poses, num_poses / 2) or len(self._held_out) < RULES.num_held_out / 2:
            raise InputError(
                f"{robot.name}: {self._num_left_out} of {num_poses + RULES.num_held_out} poses have no equilibrium in "
                "MuJoCo. Fit a smaller share of the travel."
            )
        fitting = len(self._fitted) * (1 + RULES.max_steps * (count + 4))
        self._num_evaluations = fitting + 2 * (2 * count + 1) * len(self._held_out)

    def _draw(self, draws: Vector, num_poses: int) -> tuple[Int[np.ndarray, " poses"], Int[np.ndarray, " poses"]]:
        """Solve poses in both programs; return the numbers of those to fit and to hold out."""
        statics = MjcfStatics(self._robot, self._simulation, MjcfTuning.none(self._robot))
        fitted: list[int] = []
        for number, contractions in enumerate(draws):
            pose = self._simulation.solve(contractions, strict=False)
            found = statics.find_markers(pose, contractions, pose.nodes) if pose.result.converged else None
            # Searches begin from nodes that were found: the same search must end there as well.
            again = statics.find_markers(pose, contractions, found[1]) if found is not None else None
            if again is not None:
                if number < num_poses:
                    fitted.append(len(self._poses))
                self._poses.append((contractions, pose))
                self._nodes.append(again[1])
            if self._progress is not None:
                self._progress("drawing poses", number + 1, len(draws))
        return np.arange(len(fitted)), np.arange(len(fitted), len(self._poses))

    def run(self) -> MjcfFit:
        from scipy.optimize import least_squares  # Imported here: seldom needed.

        lower, upper, steps = self._bounds()
        own_values = np.zeros(len(steps))
        own = np.nan_to_num(self._differences(own_values))  # finite in poses that were drawn twice

        def residuals(values: Vector) -> Vector:
            trial = self._differences(values)
            return np.where(np.isnan(trial), own, trial)  # a lost pose counts as unfitted

        def differ(values: Vector) -> Float[np.ndarray, "residuals values"]:
            base, columns = self._differences(values), []
            for step, unit in zip(np.where(values + steps < upper, steps, -steps), np.eye(len(steps)), strict=True):
                columns.append((self._differences(values + step * unit) - base) / step)
            return np.nan_to_num(np.stack(columns, axis=1))  # poses without equilibrium have no slope

        found = least_squares(
            residuals,
            own_values,
            differ,  # pyright: ignore[reportArgumentType] (a function)
            bounds=(lower, upper),
            x_scale=steps,
            ftol=1e-2,
            xtol=1e-2,
            max_nfev=RULES.max_steps,
        )
        return self._judge(_tuning(found.x))

    def _bounds(self) -> tuple[Vector, Vector, Vector]:
        """Lower and upper bounds of all values, and their differences."""
        kinds = [0, 1, *[2] * len(self._robot.winches)]
        bounds = RULES.min_values, RULES.max_values, RULES.value_steps
        lower, upper, steps = (np.array(each)[kinds] for each in bounds)
        model = MjcfModel(self._robot, None, self._simulation)
        ratios = [model.moduli(material)[2] for material in self._robot.body.materials]
        lower[1], upper[1] = max(lower[1], -min(ratios) - 1e-3), min(upper[1], MAX_POISSON - max(ratios))
        upper[1] = max(upper[1], 1e-3)
        return lower, upper, steps

    def _differences(self, values: Vector) -> Vector:
        """Differences of all markers in the fitted poses [m]; nan in poses without equilibrium."""
        return (self._settle(_tuning(values), self._fitted) - self._markers(self._fitted)).ravel()

    def _judge(self, tuning: MjcfTuning) -> MjcfFit:
        """Compare both models in the held-out poses that both have."""
        models = [self._respond(each) for each in (MjcfTuning.none(self._robot), tuning)]
        known = np.all(
            [np.isfinite(each).all(axis=tuple(range(1, each.ndim))) for model in models for each in model], axis=0
        )
        if not known.any():
            raise InputError(
                f"{self._robot.name}: no held-out pose has an equilibrium in both models. "
                "Fit a smaller share of the travel."
            )
        numbers = self._held_out[known]
        wanted = self._markers(numbers)
        jacobians = np.array([self._simulation.marker_jacobian(self._poses[number][1]) for number in numbers])
        before, after = (
            _errors(markers[known] - wanted, slopes[known] - jacobians, jacobians) for markers, slopes in models
        )
        rest = self._simulation.marker_anchors.positions(self._robot.body.mesh.nodes)
        return MjcfFit(
            tuning=tuning,
            share=self._share,
            num_poses=len(self._fitted),
            num_held_out=len(numbers),
            num_left_out=self._num_left_out,
            num_lost=len(self._held_out) - len(numbers),
            before=before,
            after=after,
            travel=_rms(wanted - rest),
        )

    def _respond(self, tuning: MjcfTuning) -> tuple[Markers, Float[np.ndarray, "poses markers dim winches"]]:
        """Markers in the held-out poses, and their central differences by contractions; nan where one is missing."""
        slopes = []
        for step in RULES.contraction_step * np.diag(self._travels):
            there, back = (self._settle(tuning, self._held_out, sign * step) for sign in (1.0, -1.0))
            slopes.append((there - back) / (2 * step.sum()))
        return self._settle(tuning, self._held_out), np.stack(slopes, axis=-1)

    def _settle(self, tuning: MjcfTuning, numbers: Int[np.ndarray, " poses"], more: Vector | float = 0.0) -> Markers:
        """Markers of the model in some poses, contracted by so much more; nan where no equilibrium is found."""
        statics, found = MjcfStatics(self._robot, self._simulation, tuning), []
        for number in numbers:
            contractions, pose = self._poses[number]
            settled = statics.find_markers(pose, contractions + more, self._nodes[number])
            found.append(np.full((len(pose.markers), pose.nodes.shape[1]), np.nan) if settled is None else settled[0])
            self._done += 1
            if self._progress is not None:
                self._progress("fitting MuJoCo poses", min(self._done, self._num_evaluations), self._num_evaluations)
        return np.array(found)

    def _markers(self, numbers: Int[np.ndarray, " poses"]) -> Markers:
        """Markers of hydrostat in some poses."""
        return np.array([list(self._poses[number][1].markers.values()) for number in numbers])


def _tuning(values: Vector) -> MjcfTuning:
    return MjcfTuning(young=float(np.exp(values[0])), poisson=float(values[1]), gains=np.exp(values[2:]))


def _errors(offsets: Markers, missed: np.ndarray, jacobians: np.ndarray) -> MjcfPoseErrors:
    """Errors by offsets of markers and of Jacobians, (poses, markers, dim, winches)."""
    distances = np.linalg.norm(offsets, axis=-1)
    squares, sizes = ((each**2).sum(axis=(1, 2, 3)) for each in (missed, jacobians))
    single = np.sqrt(squares / sizes)
    return MjcfPoseErrors(
        rms=_rms(offsets),
        median=float(np.median(distances)),
        largest=float(distances.max()),
        jacobian=float(np.sqrt(squares.sum() / sizes.sum())),
        jacobian_median=float(np.median(single)),
        jacobian_largest=float(single.max()),
    )


def _rms(differences: Markers) -> float:
    return float(np.sqrt((differences**2).sum(axis=-1).mean()))
