"""`identify`: fitted model of a built robot from measured places of its markers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.identification.check_columns import check_columns
from hydrostat.identification.contraction_map import ContractionMap
from hydrostat.identification.fit import FittedModel, check_fit, fit_model
from hydrostat.identification.fit_contraction_map import fit_contraction_map
from hydrostat.identification.kinds import KINDS, kind_names, named_model
from hydrostat.identification.measurements import Measurements
from hydrostat.identification.model import IdentificationModel
from hydrostat.identification.profile_intervals import profile_intervals
from hydrostat.progress import Progress, no_progress
from hydrostat.result_table import Columns, Tabular
from hydrostat.robot import Material, Pin, Robot, with_fixed_drives
from hydrostat.units import MM

UNKNOWN = 0.3
"""Share of the uncertainty of a guess that measurements must take away to be said to show a parameter."""


@dataclass(frozen=True, kw_only=True, eq=False)
class IdentifiedRobot(Tabular):
    """A robot with parameters that were found from measurements.

    Attributes:
        fitted: values, intervals, and what the measurements show.
        robot: robot with these values; zeros of winches are in the slack of their cables, gains in the spool radii.
        assumed: the robot as it was assumed, as a model without parameters.
        pretension: contraction [m] to add to that of a winch whose cables are tight at rest, which a robot cannot hold.
        before: distance of each predicted from each measured marker before the fit [m], (rows, markers).
        after: the same after the fit.
        held_out: rows that a second fit did not see; empty with fewer than ten rows.
        held_out_before: distances in these rows before the fit [m].
        held_out_after: the same, by the fit that did not see them.
        correction: map of contractions that predicts held-out poses better; None if none does.
    """

    fitted: FittedModel
    robot: Robot
    assumed: FittedModel
    pretension: dict[str, float]
    before: np.ndarray
    after: np.ndarray
    held_out: np.ndarray
    held_out_before: np.ndarray
    held_out_after: np.ndarray
    correction: ContractionMap | None

    def columns(self) -> Columns:
        """Return value and 95 % interval of each parameter, in one row."""
        columns = dict[str, Vector]()
        for name, value in self.fitted.values.items():
            low, high = self.fitted.intervals[name]
            columns |= {name: np.array([value]), f"{name}_low": np.array([low]), f"{name}_high": np.array([high])}
        return columns

    def __repr__(self) -> str:
        """Return a one-line summary."""
        return f"<IdentifiedRobot {self.robot.name}: {len(self.fitted.values)} parameters from {len(self.after)} poses>"

    def length_errors(self, measurements: Measurements) -> tuple[np.ndarray, np.ndarray]:
        """Return errors of predicted distances of markers before and after the fit [m], each (rows, pairs)."""
        one, other = (np.array([pair[end] for pair in measurements.pairs], dtype=int) for end in (0, 1))
        before, after = (
            np.linalg.norm(places[:, one] - places[:, other], axis=2) - measurements.known_lengths
            for places in (self.assumed.predict(measurements), self.fitted.predict(measurements))
        )
        return before, after

    @property
    def unknown(self) -> tuple[str, ...]:
        """Parameters that the measurements do not show; they stay near where they began."""
        return tuple(name for name, share in self.fitted.information_gains.items() if share < UNKNOWN)


def identify(
    robot: Robot,
    measurements: Measurements,
    *,
    fit: Sequence[str] | None = None,
    profile: bool = False,
    progress: Progress = no_progress,
) -> IdentifiedRobot:
    """Fit parameters of a built robot to measurements (Gauss-Newton, exact sensitivities, normal priors).

    Drives are at rest in all measurements.

    Args:
        robot: model of the robot, as designed.
        measurements: rows of contractions and marker positions.
        fit: kinds of parameters, such as ("young", "gain") or "young,gain", named as in `hydrostat identify`; the
            default kinds if left out, with `force` if forces were measured.
        profile: True to compute intervals by profile likelihood where linearized ones are doubtful.
        progress: callback for progress, after each evaluation.

    Raises:
        InputError: an unknown kind, or measurements that do not fit the robot, also by unit, axes or order.
    """
    fit = kind_names(fit)
    if robot.drives:
        found = identify(with_fixed_drives(robot), measurements, fit=fit, profile=profile, progress=progress)
        pins = (replace(pin, drive=own.drive) for pin, own in zip(found.robot.pins, robot.pins, strict=True))
        driven = replace(found.robot, pins=tuple(pins), loads=robot.loads, drives=robot.drives)
        return replace(found, robot=driven)
    if fit is None and measurements.forces is not None:
        fit = (*(name for name, kind in KINDS.items() if kind.default and kind.parameters(robot)), "force")
    if "scale" in (fit or ()) and np.isfinite(measurements.known_lengths).any():
        raise InputError(_ruler_error(measurements))
    model, assumed = named_model(robot, fit), start_of(named_model(robot, ()))
    check_fit(robot, measurements)
    predicted = assumed.predict(measurements)
    check_columns(assumed, measurements, predicted)
    before = np.linalg.norm(predicted - measurements.places, axis=2)
    count = len(measurements.commands)
    held_out = np.arange(2, count, 5) if count >= 10 else np.zeros(0, dtype=int)
    nothing = np.zeros((0, len(measurements.markers)))
    held_before, held_after = nothing, nothing
    if len(held_out):
        kept = np.setdiff1d(np.arange(count), held_out)
        asked = measurements.rows(held_out)
        part = fit_model(
            model,
            measurements.rows(kept),
            refine=False,
            progress=lambda stage, done, total: progress(f"without held-out rows, {stage}", done, total),
        )
        held_before, held_after = before[held_out], _distances(part, asked)
        if measurements.in_order:
            held_after = held_after[held_out]
    fitted = fit_model(model, measurements, progress=progress)
    fitted = profile_intervals(fitted, measurements, progress=progress) if profile else fitted
    changed, pretension = _robot(model, fitted, robot)
    changed = _with_intervals(changed, fitted)
    return IdentifiedRobot(
        fitted=fitted,
        robot=changed,
        assumed=assumed,
        pretension=pretension,
        before=before,
        after=_distances(fitted, measurements),
        held_out=held_out,
        held_out_before=held_before,
        held_out_after=held_after,
        correction=fit_contraction_map(fitted, changed, measurements),
    )


def start_of(model: IdentificationModel) -> FittedModel:
    """Model before any fit."""
    count = len(model.parameters)
    return FittedModel(
        model=model,
        values=model.start,
        numbers=np.zeros(count),
        covariance=np.eye(count),
        spread=1.0,
        mesh_shift=np.zeros((1, count)),
        build_variance=np.zeros(count),
        noise=np.nan,
        error=np.nan,
        num_failed=0,
        iterations=0,
        message="not fitted",
    )


def _ruler_error(measurements: Measurements) -> str:
    """Error of a scale that is fitted to ruler distances."""
    if np.isfinite(measurements.places).any():
        return "scale: ruler distances do not change with the scale of the board. Remove scale, or these distances."
    return "scale: ruler distances are true, without a board. Fit other parameters, such as young or thickness."


def _distances(fitted: FittedModel, measurements: Measurements) -> np.ndarray:
    found = fitted.predict(measurements)
    return np.linalg.norm(found - measurements.places, axis=2)


def _name_defaults(robot: Robot, assumed: Robot) -> tuple[Pin, ...]:
    """Pins of a fitted robot, with a default stiffness where that is the one that was fitted with."""
    pairs = zip(robot.pins, assumed.pins, strict=True)
    usual = replace(robot, pins=tuple(own if pin.stiffness == own.stiffness else pin for pin, own in pairs)).pins
    return tuple(one if one.stiffness == pin.stiffness else pin for one, pin in zip(usual, robot.pins, strict=True))


def _robot(model: IdentificationModel, fitted: FittedModel, assumed: Robot) -> tuple[Robot, dict[str, float]]:
    """Robot with the fitted values, and the contraction [m] to add for winches whose pretension it cannot hold."""
    values = {name: _round_number(value) for name, value in fitted.values.items()}
    robot = model.robot(values)
    gains = {winch.name: values.get(f"{winch.name}.gain", 1.0) for winch in robot.winches}
    zeros = {name: MM * values.get(f"{name}.zero", 0.0) * gain for name, gain in gains.items()}
    slack = [
        cable.slack - float(ratio) * zeros[cable.winch]
        for cable, ratio in zip(robot.cables, assumed.spool_ratios, strict=True)
    ]
    tight = {cable.winch for cable, rest in zip(robot.cables, slack, strict=True) if rest < 0}
    winches = tuple(
        replace(winch, spool_radius=_round_number(winch.spool_radius * gains[winch.name])) for winch in robot.winches
    )
    cables = tuple(
        replace(
            cable,
            slack=cable.slack if cable.winch in tight else _round_number(rest),
            spool_radius=None if cable.spool_radius is None else _round_number(cable.spool_radius * gains[cable.winch]),
        )
        for cable, rest in zip(robot.cables, slack, strict=True)
    )
    robot = replace(robot, pins=_name_defaults(robot, assumed))
    if "thickness" in values and robot.body.thickness is not None:
        robot = replace(robot, body=replace(robot.body, thickness=_round_number(robot.body.thickness)))
    try:
        return robot.with_network(winches, cables), {name: zeros[name] for name in gains if name in tight}
    except InputError as error:
        raise InputError(f"the fitted robot cannot be built: {error}") from None


def _with_intervals(robot: Robot, fitted: FittedModel) -> Robot:
    """Robot whose materials have the interval of Young's modulus, where the measurements show it."""
    gains, intervals = fitted.information_gains, fitted.intervals

    def add_interval(owner: str, material: Material) -> Material:
        name = f"{owner}.young"
        if gains.get(name, 0.0) < UNKNOWN:
            return material
        low, high = (_round_number(end) for end in intervals[name])
        return replace(material, young_interval=(min(low, material.young), max(high, material.young)))

    parts = tuple(
        part if part.material is None else replace(part, material=add_interval(part.name, part.material))
        for part in robot.body.parts
    )
    return replace(robot, body=replace(robot.body, material=add_interval("body", robot.body.material), parts=parts))


def _round_number(value: float) -> float:
    """Value with the digits that a measurement can have."""
    return float(f"{value:.6g}")


FIELDS = {"stiffness": "stiffness", "gain": "spool"}
"""Field of `design.BuildTolerances` for each kind of parameter whose logarithm is fitted."""


def identified_tolerances(found: IdentifiedRobot) -> bytes:
    """Text of a file of constraints whose table [tolerances] holds the intervals of the fit.

    A field is the largest standard deviation of its parameters that the measurements show. Fields of others are left
    out, so that the usual tolerances hold. Pins are left out as well: a design does not depend on them. Young's modulus
    has its interval in the material of the fitted robot.
    """
    fitted, deviations, friction = found.fitted, dict[str, float](), ""
    widths = np.sqrt(np.diag(fitted.interval_covariance)).tolist()
    for parameter, width in zip(fitted.model.parameters, widths, strict=True):
        if parameter.name in found.unknown:
            continue
        kind = parameter.name.rpartition(".")[2]
        if parameter.name == "friction":
            low, high = (min(max(each, 0.0), 1.0) for each in fitted.intervals["friction"])
            friction = f"friction = [{low:.3g}, {high:.3g}]"
        elif kind in FIELDS and parameter.log:
            deviation = parameter.spread * width
            deviations[FIELDS[kind]] = max(deviations.get(FIELDS[kind], 0.0), deviation)
    lines = [f"{field} = {deviation:.3g}" for field, deviation in deviations.items()]
    lines += [friction] if friction else []
    head = "# Build tolerances of the fitted robot, by hydrostat identify. hydrostat design reads them."
    return "\n".join([head, "[tolerances]", *lines, ""]).encode()
