"""`fit_mjcf`: the few numbers of a MuJoCo model, fitted to poses of hydrostat; it needs MuJoCo."""

from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Points, Vector
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

WORTH = 0.95  # a fit is kept if the error of the held-out poses falls below this share
HELD_OUT = 5  # one held-out pose for so many that are fitted, but at least
MIN_HELD_OUT = 12
LOWER, UPPER = (-1.0, -0.15, -0.3), (1.0, 0.15, 0.3)  # limits: ln of Young's factor, Poisson's shift, ln of gains
STEPS = (0.1, 0.02, 0.02)  # differences for the Jacobian, likewise
MAX_STEPS = 4  # most steps of the least squares

Markers = Float[np.ndarray, "poses markers dim"]  # places of all markers in some poses [m]


@dataclass(frozen=True, kw_only=True, eq=False)
class MjcfFit:
    """Fit of a MuJoCo model, judged on poses that it did not use.

    Attributes:
        tuning: fitted numbers.
        share: share of the travel of each winch up to which contractions were drawn.
        num_poses: number of fitted poses.
        num_held_out: number of held-out poses.
        num_lost: number of drawn poses that have no equilibrium in MuJoCo, fitted or not: they count nowhere.
        before: root mean square of the distances of the markers from those of hydrostat, held out, not fitted [m].
        after: the same, fitted [m].
        jacobian_before: relative error of the Jacobian of markers by contractions, held out, not fitted [-].
        jacobian_after: the same, fitted [-].
        travel: root mean square of the distances of the markers from rest in the held-out poses [m].
    """

    tuning: MjcfTuning
    share: float
    num_poses: int
    num_held_out: int
    num_lost: int
    before: float
    after: float
    jacobian_before: float
    jacobian_after: float
    travel: float

    @property
    def is_worth_it(self) -> bool:
        """True if the error of the held-out poses falls by 5 % or more."""
        return self.after < WORTH * self.before

    def describe(self) -> str:
        """Sentence with the figures."""
        told = (
            f"markers off by {1e3 * self.before:.2g} mm rms unfitted, {1e3 * self.after:.2g} mm fitted, of "
            f"{1e3 * self.travel:.2g} mm rms, in {plural(self.num_held_out, 'held-out pose')} up to "
            f"{100 * self.share:g} % of the travel; Jacobian off by {100 * self.jacobian_before:.2g} % and "
            f"{100 * self.jacobian_after:.2g} %; fitted to {plural(self.num_poses, 'pose')}"
        )
        lost = f"; {plural(self.num_lost, 'drawn pose')} without equilibrium in MuJoCo" if self.num_lost else ""
        return told + lost + ("" if self.is_worth_it else ". The fit gains nothing: the model stays unfitted")


def fit_mjcf(robot: Robot, num_poses: int = 300, *, share: float = 0.25, progress: Progress | None = None) -> MjcfFit:
    """Fit Young's modulus, Poisson's ratio and a gain of each winch of a MuJoCo model to poses of hydrostat.

    Contractions are scrambled Sobol points up to a share of the travel. Bounded least squares on the markers.

    Args:
        robot: robot with markers and winches.
        num_poses: number of fitted poses; a fifth as many, at least 12, are held out.
        share: share of the travel of each winch, such as `MjcfError.range_share`.
        progress: called with the evaluations of the model.

    Raises:
        InputError: MuJoCo is not installed, too few poses, a share beyond 0 to 1, a robot without markers or winches,
            one that `mjcf_text` rejects, or too few poses with an equilibrium in MuJoCo.
    """
    if find_spec("mujoco") is None:
        raise InputError(f"MuJoCo is not installed: {install_command('export')}")
    if not robot.markers or not robot.winches:
        raise InputError("fitting a model needs a [[marker]] and a [[winch]]. Add them.")
    if num_poses < 3 or not 0 < share <= 1:
        raise InputError(f"a fit needs 3 poses or more and a share within 0 and 1, not {num_poses} and {share:g}")
    return _MjcfSearch(robot, num_poses, share, progress).run()


class _MjcfSearch:
    """Poses of both programs, and least squares over the numbers of one."""

    def __init__(self, robot: Robot, num_poses: int, share: float, progress: Progress | None) -> None:
        self._robot, self._simulation, self._share, self._progress = robot, Simulation(robot), share, progress
        travels = share * np.array([winch.travel for winch in robot.winches])
        num_drawn = num_poses + max(MIN_HELD_OUT, num_poses // HELD_OUT)
        self._steps = 0.01 * travels  # differences of contractions
        self._done, own = 0, MjcfTuning.none(robot)
        self._poses: list[tuple[Vector, Equilibrium]] = []
        self._places: list[Nodes] = []  # nodes of the MuJoCo model, from which searches begin
        statics = MjcfStatics(robot, self._simulation, own)
        for number, contractions in enumerate(draw_sobol(len(travels), num_drawn, np.random.default_rng(0)) * travels):
            pose = self._simulation.solve(contractions, strict=False)
            found = statics.find_markers(pose, contractions, pose.nodes) if pose.result.converged else None
            if found is not None:
                self._poses.append((contractions, pose))
                self._places.append(found[1])
            if progress is not None:
                progress("drawing poses", number + 1, num_drawn)
        self._num_lost = num_drawn - len(self._poses)
        count = round(len(self._poses) * num_poses / num_drawn)
        if count < 3 or self._num_lost > num_drawn // 2:
            raise InputError(
                f"{robot.name}: {self._num_lost} of {num_drawn} poses have no equilibrium in MuJoCo. "
                "Fit a smaller share of the travel."
            )
        unknowns = len(travels) + 2
        self._most = count * (1 + MAX_STEPS * (unknowns + 2)) + 2 * (len(travels) + 1) * (len(self._poses) - count)
        self._fitted, self._held_out = np.arange(count), np.arange(count, len(self._poses))

    def run(self) -> MjcfFit:
        from scipy.optimize import least_squares  # Imported here: seldom needed.

        count, wide = len(self._robot.winches), [0, 1, *[2] * len(self._robot.winches)]
        lower, upper, steps = np.array(LOWER)[wide], np.array(UPPER)[wide], np.array(STEPS)[wide]

        def differ(values: Vector) -> Float[np.ndarray, "residuals values"]:
            base, columns = self._differences(values), []
            for step, unit in zip(np.where(values + steps < upper, steps, -steps), np.eye(count + 2), strict=True):
                columns.append((self._differences(values + step * unit) - base) / step)
            return np.nan_to_num(np.stack(columns, axis=1))  # poses without equilibrium say nothing

        model = MjcfModel(self._robot, None, self._simulation)
        ratios = [model.moduli(material)[2] for material in self._robot.body.materials]
        lower[1], upper[1] = max(lower[1], -min(ratios) - 1e-3), min(upper[1], MAX_POISSON - max(ratios))
        upper[1] = max(upper[1], 1e-3)
        own_differences = self._differences(np.zeros(count + 2))

        def differences(values: Vector) -> Vector:
            trial = self._differences(values)
            return np.where(np.isnan(trial), own_differences, trial)  # a lost pose gains nothing

        found = least_squares(
            differences,
            np.zeros(count + 2),
            differ,  # pyright: ignore[reportArgumentType] (a function)
            bounds=(lower, upper),
            x_scale=steps,
            ftol=1e-2,
            xtol=1e-2,
            max_nfev=MAX_STEPS,
        )
        own, fitted = MjcfTuning.none(self._robot), _tuning(found.x)
        wanted, rest = (
            self._markers(self._held_out),
            self._simulation.marker_anchors.positions(self._robot.body.mesh.nodes),
        )
        (before, jacobian_before), (after, jacobian_after) = self._judge(own), self._judge(fitted)
        return MjcfFit(
            tuning=fitted,
            share=self._share,
            num_poses=len(self._fitted),
            num_held_out=len(self._held_out),
            num_lost=self._num_lost,
            before=before,
            after=after,
            jacobian_before=jacobian_before,
            jacobian_after=jacobian_after,
            travel=_rms(wanted - rest),
        )

    def _differences(self, values: Vector) -> Vector:
        """Differences of all markers in the fitted poses [m]; nan in poses without equilibrium."""
        return (self._settle(_tuning(values), self._fitted) - self._markers(self._fitted)).ravel()

    def _judge(self, tuning: MjcfTuning) -> tuple[float, float]:
        """Error of the markers [m] and relative error of their Jacobian, in held-out poses."""
        found = self._settle(tuning, self._held_out)
        wanted, missed, size = self._markers(self._held_out), [], []
        for winch, step in enumerate(self._steps):
            moved = self._settle(tuning, self._held_out, step * np.eye(len(self._steps))[winch])
            ours = np.array([self._respond(number, winch) for number in map(int, self._held_out)])
            missed.append((moved - found) / step - ours)
            size.append(ours)
        known = np.isfinite(missed)
        ratio = np.sqrt(np.mean(np.array(missed)[known] ** 2) / np.mean(np.array(size)[known] ** 2))
        return (_rms(found - wanted), float(ratio)) if np.isfinite(found).all() else (np.inf, float(ratio))

    def _respond(self, number: int, winch: int) -> Points:
        """Exact derivative of hydrostat's markers by a contraction, (markers, dim)."""
        _, pose = self._poses[number]
        return self._simulation.marker_jacobian(pose)[:, :, winch]

    def _settle(self, tuning: MjcfTuning, numbers: Int[np.ndarray, " poses"], more: Vector | float = 0.0) -> Markers:
        """Markers of the model in some poses, contracted by so much more; nan where no equilibrium is found."""
        statics, found = MjcfStatics(self._robot, self._simulation, tuning), []
        for number in numbers:
            contractions, pose = self._poses[number]
            settled = statics.find_markers(pose, contractions + more, self._places[number])
            found.append(np.full((len(pose.markers), pose.nodes.shape[1]), np.nan) if settled is None else settled[0])
            self._done += 1
            if self._progress is not None:
                self._progress("fitting MuJoCo poses", self._done, self._most)
        return np.array(found)

    def _markers(self, numbers: Int[np.ndarray, " poses"]) -> Markers:
        """Markers of hydrostat in some poses, (poses, markers, dim)."""
        return np.array([list(self._poses[number][1].markers.values()) for number in numbers])


def _tuning(values: Vector) -> MjcfTuning:
    return MjcfTuning(young=float(np.exp(values[0])), poisson=float(values[1]), gains=np.exp(values[2:]))


def _rms(differences: Markers) -> float:
    return float(np.sqrt((differences**2).sum(axis=-1).mean()))
