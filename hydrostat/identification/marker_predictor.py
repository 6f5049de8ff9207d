"""`MarkerPredictor`: places of markers and forces of winches for values of the parameters, with exact Jacobians."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from hydrostat.arrays import Bool, Float, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.geometry import Anchors, locate
from hydrostat.identification.measurements import Measurements
from hydrostat.identification.model import IdentificationModel, Values
from hydrostat.robot import Load, Robot
from hydrostat.simulation import Equilibrium, Sensitivity, Simulation

STEP = 1e-5
"""Change of a coordinate of the fit for differences, in spreads."""

PATH_STEP = 1e-3
"""The same for differences of whole loading paths, which friction makes less smooth."""


@dataclass(frozen=True, eq=False)
class MarkerPrediction:
    """Predicted places of the markers of all rows.

    Attributes:
        places: in the frame of the measurement [m], (rows, markers, dim); NaN where no equilibrium was found.
        jacobian: derivatives by the coordinates of the fit, (rows, markers, dim, parameters); None if not requested.
        forces: measured forces of the winches [N], (rows, winches); NaN where no equilibrium was found.
        force_jacobian: their derivatives, (rows, winches, parameters), 0 where no force was measured.
    """

    places: Float[np.ndarray, "rows markers dim"]
    jacobian: Float[np.ndarray, "rows markers dim parameters"] | None
    forces: Float[np.ndarray, "rows winches"]
    force_jacobian: Float[np.ndarray, "rows winches parameters"] | None

    @property
    def has_equilibrium(self) -> Bool[np.ndarray, " rows"]:
        """Rows with an equilibrium."""
        return np.array([bool(np.isfinite(row).all()) for row in self.places])


class MarkerPredictor:
    """Predicts markers for values of the parameters; begins each row at its last equilibrium."""

    def __init__(
        self, model: IdentificationModel, measurements: Measurements, *, deviations: Mapping[str, float] | None = None
    ) -> None:
        """Predictor of the rows of some measurements, which need not have measured places.

        Args:
            model: robot and measurement.
            measurements: rows to predict.
            deviations: standard deviations of each of some `robot_numbers` that are not fitted; derivatives by them, in
                these units, follow those by the parameters, unless a parameter changes them.
        """
        self.model, self.measurements, self._deviations = model, measurements, deviations or {}
        self._poses: list[Equilibrium | None] = [None] * len(measurements.commands)

    @property
    def poses(self) -> list[Equilibrium | None]:
        """Last equilibrium of each row; None where none was found."""
        return list(self._poses)

    def predict(self, numbers: Vector, *, with_jacobian: bool) -> MarkerPrediction:
        """Places at coordinates of the fit, with their Jacobian if requested.

        Raises:
            InputError: values that no robot can have, or that change how many cables, points or parts it has; the
                Jacobian of a robot with cable friction and hysteresis.
        """
        values = self.model.values(numbers)
        robot = self.model.robot(values)
        if with_jacobian and robot.body.has_hysteresis and any(cable.friction for cable in robot.cables):
            raise InputError("identification fits cable friction or hysteresis, not both. Remove one of them.")
        contractions = self.model.contractions(values, self.measurements.commands)
        rows, markers = len(contractions), self.measurements.markers
        anchors = _anchors(robot, markers)
        places = np.full((rows, len(markers), robot.body.mesh.dim), np.nan)
        changes = _Changes(self._changes(numbers, values, robot) if with_jacobian else [])
        jacobian = np.zeros((*places.shape, len(changes.all))) if with_jacobian else None
        forces, scale = np.full(contractions.shape, np.nan), self.model.force_scale(values)
        force_jacobian = np.zeros((*forces.shape, len(changes.all))) if with_jacobian else None
        network = winch_ratios(robot)
        loaded, loads = np.unique(self.measurements.hung_masses, axis=0, return_inverse=True)
        simulations = [Simulation(_with_masses(robot, markers, masses)) for masses in loaded]
        before, follows = None, self.measurements.in_order
        for row, (contraction, load) in enumerate(zip(contractions, loads.ravel(), strict=True)):
            simulation = simulations[load]
            pose = self._solve(simulation, contraction, before if follows else self._poses[row])
            self._poses[row], before = pose, pose or before
            if pose is None:
                continue
            at = anchors.positions(pose.nodes)
            places[row], forces[row] = self.model.places(values, at), scale * network @ pose.tensions
            if jacobian is not None and force_jacobian is not None:
                try:
                    jacobian[row], force_jacobian[row] = self._jacobians(
                        simulation, pose, (values, at, anchors), (network, scale), changes, row
                    )
                except NotConvergedError:
                    places[row], forces[row], self._poses[row] = np.nan, np.nan, None
        found = MarkerPrediction(places, jacobian, forces, force_jacobian)
        has_history = any(simulation.assembly.has_history for simulation in simulations)
        by_paths = has_history and (follows or robot.body.has_hysteresis)
        return self._difference_paths(found, numbers) if with_jacobian and by_paths else found

    def _difference_paths(self, found: MarkerPrediction, numbers: Vector) -> MarkerPrediction:
        """Prediction with its Jacobian from differences of all rows, each with its own history.

        The adjoint holds the history of a pose, which the parameters change as well. It stays where a path of a
        difference fails, and for numbers that are not fitted.
        """
        assert found.jacobian is not None
        assert found.force_jacobian is not None
        jacobian, force_jacobian = found.jacobian.copy(), found.force_jacobian.copy()
        for index, unit in enumerate(np.eye(len(numbers))):
            less, more = (
                MarkerPredictor(self.model, self.measurements).predict(numbers + step * unit, with_jacobian=False)
                for step in (-PATH_STEP, PATH_STEP)
            )
            by_place = (more.places - less.places) / (2 * PATH_STEP)
            by_force = (more.forces - less.forces) / (2 * PATH_STEP)
            jacobian[..., index] = np.where(np.isfinite(by_place), by_place, jacobian[..., index])
            known = np.isfinite(by_force) & np.isfinite(self.measurements.known_forces)
            force_jacobian[..., index] = np.where(known, by_force, force_jacobian[..., index])
        return replace(found, jacobian=jacobian, force_jacobian=force_jacobian)

    def _changes(self, numbers: Vector, values: Values, robot: Robot) -> list["_Change"]:
        """Small changes of each parameter, then of each number that is not fitted."""
        changes = [_Change.of(self, numbers, index, robot) for index in range(len(numbers))]
        sizes, anchors = robot_numbers(robot, robot.gravity), _anchors(robot, self.measurements.markers)
        rest = _Change(
            model=self.model,
            values=(values, values),
            anchors=(anchors, anchors),
            numbers={},
            contractions=np.zeros_like(self.measurements.commands),
            force_scale=0.0,
        )
        return changes + [
            replace(rest, numbers={name: deviation * row})
            for name, deviation in self._deviations.items()
            if not any(name in change.numbers for change in changes)
            for row in np.eye(len(sizes[name]))
        ]

    def _solve(self, simulation: Simulation, contractions: Vector, last: Equilibrium | None) -> Equilibrium | None:
        if last is not None and (self.measurements.in_order or not simulation.assembly.has_history):
            start = simulation.make_pose(last.contractions, last.result, last.history)
            pose = simulation.solve(contractions, start=start, strict=False)
            if pose.result.converged:
                return pose
            if simulation.assembly.has_history:  # from rest it would lose its history
                return None
        pose = simulation.solve(contractions, strict=False)
        return pose if pose.result.converged else None

    def _jacobians(
        self,
        simulation: Simulation,
        pose: Equilibrium,
        here: tuple[Values, np.ndarray, Anchors],
        network: tuple[np.ndarray, float],
        changes: "_Changes",
        row: int,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Jacobians of the places, (markers, dim, parameters), and of the forces of one row, (winches, parameters)."""
        (values, at, anchors), (ratios, scale) = here, network
        count, dim = at.shape
        markers = np.flatnonzero(self.measurements.is_measured(row))
        winches = np.flatnonzero(np.isfinite(self.measurements.known_forces[row]))
        asked = len(markers) * dim
        nodes = np.zeros((asked + len(winches), *pose.nodes.shape))
        for index, (marker, axis) in enumerate(product(markers, range(dim))):
            np.add.at(nodes[index, :, axis], anchors.stencils[marker], anchors.weights[marker])
        tensions = np.zeros((len(nodes), len(pose.tensions)))
        tensions[asked:] = ratios[winches]
        through = changes.through(simulation.adjoints(pose, (nodes, tensions)) if len(nodes) else [], row)
        step = 1e-6 * simulation.robot.body.mesh.size
        turns = np.stack(  # (dim, markers, dim): derivatives of the places by each coordinate of the robot's frame
            [
                (self.model.places(values, at + step * axis) - self.model.places(values, at - step * axis)) / (2 * step)
                for axis in np.eye(dim)
            ]
        )
        found, forces = np.zeros((count, dim, len(changes.all))), np.zeros((len(ratios), len(changes.all)))
        by_axis = through[:asked].reshape(len(markers), dim, -1)
        found[markers] = np.einsum("ami,mak->mik", turns[:, markers], by_axis)
        for index, change in enumerate(changes.all):
            found[:, :, index] += change.direct(pose)
        by_scale = np.array([change.force_scale for change in changes.all])
        forces[winches] = scale * through[asked:] + np.outer(ratios[winches] @ pose.tensions, by_scale)
        return found, forces


@dataclass(frozen=True, eq=False)
class _Change:
    """Small change of one coordinate of the fit: what it changes, without the equilibrium."""

    model: IdentificationModel
    values: tuple[Values, Values]
    anchors: tuple[Anchors, Anchors]
    numbers: dict[str, Vector]
    contractions: Float[np.ndarray, "rows winches"]
    force_scale: float

    @classmethod
    def of(cls, predictor: MarkerPredictor, numbers: Vector, index: int, robot: Robot) -> "_Change":
        model, measured = predictor.model, predictor.measurements
        unit = np.eye(len(numbers))[index] * STEP
        values = model.values(numbers - unit), model.values(numbers + unit)
        less, more = (model.robot(each) for each in values)
        before, after = (robot_numbers(each, robot.gravity) for each in (less, more))
        if any(before[name].shape != after[name].shape for name in before):
            raise InputError(f"{model.parameters[index].name}: it changes how many cables, points or parts a robot has")
        pulls = [model.contractions(each, measured.commands) for each in values]
        return cls(
            model=model,
            values=values,
            anchors=(_anchors(less, measured.markers), _anchors(more, measured.markers)),
            numbers={
                name: (after[name] - before[name]) / (2 * STEP)
                for name in before
                if not np.array_equal(after[name], before[name])
            },
            contractions=(pulls[1] - pulls[0]) / (2 * STEP),
            force_scale=(model.force_scale(values[1]) - model.force_scale(values[0])) / (2 * STEP),
        )

    def direct(self, pose: Equilibrium) -> np.ndarray:
        """Derivatives of the places with the nodes held."""
        if self.values[0] is self.values[1]:
            return np.zeros(())
        less, more = (
            self.model.places(values, anchors.positions(pose.nodes))
            for values, anchors in zip(self.values, self.anchors, strict=True)
        )
        return (more - less) / (2 * STEP)


class _Changes:
    """Changes of all coordinates of the fit, with those of each of `robot_numbers` as a matrix."""

    def __init__(self, changes: list[_Change]) -> None:
        self.all, self._by_name = changes, dict[str, tuple[list[int], np.ndarray]]()
        for name in dict.fromkeys(name for change in changes for name in change.numbers):
            own = [index for index, change in enumerate(changes) if name in change.numbers]
            self._by_name[name] = own, np.array([changes[index].numbers[name] for index in own])

    def through(self, sensitivities: list[Sensitivity], row: int) -> Float[np.ndarray, "numbers parameters"]:
        """Derivatives of some numbers of the pose of a row through the equilibrium."""
        found = np.zeros((len(sensitivities), len(self.all)))
        if not sensitivities:
            return found
        pulls = np.array([change.contractions[row] for change in self.all]).reshape(len(self.all), -1)
        found += np.array([each.contractions for each in sensitivities]) @ pulls.T
        flat = [flatten_sensitivity(each) for each in sensitivities]
        for name, (own, matrix) in self._by_name.items():
            found[:, own] += np.array([each[name][: matrix.shape[1]] for each in flat]) @ matrix.T
        return found


def _with_masses(robot: Robot, markers: tuple[str, ...], masses: Vector) -> Robot:
    """Robot with masses hung at markers, after its own loads."""
    hung = [
        Load(name=f"measured {name}", marker=name, mass=float(mass))
        for name, mass in zip(markers, masses, strict=True)
        if mass > 0
    ]
    return replace(robot, loads=(*robot.loads, *hung)) if hung else robot


def winch_ratios(robot: Robot) -> Float[np.ndarray, "winches cables"]:
    """Share of each cable's tension in the pull of its winch: its spool over that of the winch, 0 for others."""
    names = [winch.name for winch in robot.winches]
    ratios = np.zeros((len(names), len(robot.cables)))
    owners = [names.index(cable.winch) for cable in robot.cables]
    ratios[owners, np.arange(len(owners))] = robot.spool_ratios
    return ratios


def _anchors(robot: Robot, names: tuple[str, ...]) -> Anchors:
    mesh = robot.body.mesh
    known = {marker.name: marker.at for marker in robot.markers}
    return locate(mesh, np.array([known[name] for name in names]).reshape(-1, mesh.dim))


def robot_numbers(robot: Robot, gravity: tuple[float, ...] | None) -> dict[str, Vector]:
    """Numbers of a robot whose derivatives `Sensitivity` knows, each as a flat vector in SI units.

    Hung masses count by their weight under `gravity` [m/s^2], as the derivative by gravity has them already.
    """
    body = robot.body
    materials = [part.material for part in body.parts]
    dim = body.mesh.dim
    return {
        "slack": np.array([cable.slack for cable in robot.cables]),
        "routes": np.array([number for cable in robot.cables for point in cable.points for number in point]),
        "cable_stiffness": np.array([cable.stiffness for cable in robot.cables]),
        "friction": np.array([cable.friction for cable in robot.cables]),
        "pin_stiffness": np.array([pin.stiffness for pin in robot.pins]),
        "young": np.array([body.material.young]),
        "poisson": np.array([body.material.poisson]),
        "density": np.array([body.material.density]),
        "part_young": np.array([0.0 if material is None else material.young for material in materials]),
        "part_poisson": np.array([0.0 if material is None else material.poisson for material in materials]),
        "part_density": np.array(
            [(part.density or 0.0) if part.material is None else part.material.density for part in body.parts]
        ),
        "thickness": np.array([body.thickness or 0.0]),
        "loads": np.array([load.force_under(gravity, dim) for load in robot.loads]).ravel(),
        "moments": np.array([float(np.linalg.norm(load.moment or ())) for load in robot.loads]),
        "gravity": np.zeros(dim) if robot.gravity is None else np.array(robot.gravity),
        "rod_axial": np.array([rod.stiffnesses[0] for rod in robot.rods]),
        "rod_bending": np.array([rod.stiffnesses[1] for rod in robot.rods]),
        "rod_torsion": np.array([rod.torsional_stiffness or 0.0 for rod in robot.rods]),
        "sheet_young": np.array([sheet.material.young for sheet in robot.sheets]),
    }


def flatten_sensitivity(sensitivity: Sensitivity) -> dict[str, Vector]:
    """Derivatives by `robot_numbers`, by the same names and as flat."""
    found = {}
    for name in SENSITIVITIES:
        value = getattr(sensitivity, name)
        if name == "routes":
            found[name] = np.concatenate([np.ravel(part) for part in value]) if value else np.zeros(0)
        else:
            found[name] = np.atleast_1d(np.ravel(0.0 if value is None else value)).astype(float)
    return found


SENSITIVITIES = (
    "slack",
    "routes",
    "cable_stiffness",
    "friction",
    "pin_stiffness",
    "young",
    "poisson",
    "density",
    "part_young",
    "part_poisson",
    "part_density",
    "thickness",
    "loads",
    "moments",
    "gravity",
    "rod_axial",
    "rod_bending",
    "rod_torsion",
    "sheet_young",
)
