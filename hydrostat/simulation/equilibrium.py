"""`Equilibrium`: a robot in quasi-static equilibrium under given contractions."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.errors import HydrostatWarning, InputError
from hydrostat.geometry import Mesh, find_crossings
from hydrostat.given import NamedParts
from hydrostat.mechanics import NewtonResult, pushed_elements
from hydrostat.named_vector import NamedVector
from hydrostat.painters import draw_record, html_repr
from hydrostat.result_table import Columns, Tabular, control_columns, marker_columns, named_columns
from hydrostat.robot import PinDrive, Robot
from hydrostat.simulation.mesh_error import WORTH_A_NOTE, estimate_stiffening
from hydrostat.simulation.strain import find_overstrain, node_strains, node_stresses
from hydrostat.units import plural

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, eq=False)
class Equilibrium(Tabular):
    """Static equilibrium of a robot at given contractions.

    Attributes:
        contractions: contraction of each winch [m], in winch order and by name: `pose.contractions["left"]`.
        nodes: positions of the nodes [m].
        markers: position of each marker [m].
        tensions: tension of each cable [N], in cable order and by name.
        energy: total energy [J].
        result: solver result: stop reason, residual [N], iterations, stability and the factorized Hessian.
        history: history variables of the physics: cable slip at each point with friction so far and the anchors of the
            skin on obstacles with friction [m]; empty without friction.
        robot: robot in this pose.
        drives: value of each drive: angle [rad], travel [m] or load share.
        carried: unknowns of moving obstacles [m]: position and axes of each; empty if no obstacle moves.
    """

    contractions: Vector
    nodes: Nodes
    markers: Mapping[str, Vector]
    tensions: Vector
    energy: float
    result: NewtonResult
    history: Vector = field(default_factory=lambda: np.zeros(0))
    carried: Points | None = None
    drives: Vector = field(default_factory=lambda: np.zeros(0))
    robot: Robot

    def __post_init__(self) -> None:
        """Give contractions, tensions and drives their names."""
        object.__setattr__(self, "markers", NamedParts("marker", self.markers))
        for field_name, parts in name_values(self.robot).items():
            values = getattr(self, field_name)
            if len(values) == len(parts):
                object.__setattr__(self, field_name, NamedVector(values, parts))

    def columns(self) -> Columns:
        """Return a table of contractions, drive values, markers, tensions and energy, with one row."""
        return {**pose_columns(self), "energy_J": np.array([self.energy])}

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings as texts: winches beyond travel or release, self-intersection, strain beyond the material.

        Also a missing equilibrium, a saddle, or buckling along the path. Empty if there is no warning.
        """
        return self.find_warnings()

    def find_warnings(self, *, crossings: bool = True) -> tuple[str, ...]:
        """Return `warnings`; with `crossings=False` without self-intersection, which takes long in space."""
        told = []
        if not self.result.converged:
            told.append(f"no equilibrium: {self.result.status}")
        told += beyond_travel(self.robot, self.contractions) + PinDrive.check_values(self.robot.drives, self.drives)
        if self.result.buckled:
            told.append("buckled: a mirror-image pose is equally likely")
        if self.result.converged and not self.result.stable:
            told.append("unstable equilibrium (saddle point)")
        told.append(str(find_crossings(self.robot.body.mesh, self.nodes)) if crossings else "")
        told.append(self.squeezed_corners)
        return (*filter(None, told), *([self.overstrain] if self.overstrain else []))

    @property
    def squeezed_corners(self) -> str:
        """Warning about quadratic elements that only the inversion barrier holds open; empty if there are none."""
        mesh = self.robot.body.mesh
        pushed = [] if mesh.quadratic is None else pushed_elements(mesh.nodes, mesh.quadratic, self.nodes)
        if not len(pushed):
            return ""
        return (
            f"{plural(len(pushed), 'element')} squeezed to less than 30 % at a corner and kept from inverting by extra "
            "forces: tensions are too high. Contract less, or take smaller elements"
        )

    @property
    def overstrain(self) -> str:
        """Warning about elements outside the valid range of their material; empty if there are hardly any."""
        return find_overstrain(self.robot, self.nodes) if self.result.converged else ""

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on accuracy: linear elements that are far too stiff in this pose; empty for most bodies."""
        stiffening = estimate_stiffening(self.robot.body, self.nodes)
        if stiffening < WORTH_A_NOTE:
            return ()
        percent = f"{100 * stiffening:.0f} %"
        return (f'linear elements make the body at least {percent} too stiff here; take elements = "quadratic"',)

    @property
    def strains(self) -> Vector:
        """Largest principal stretch at each node minus 1, (nodes,); see `node_strains`."""
        return node_strains(self.robot, self.nodes)

    @property
    def stresses(self) -> Vector:
        """Von Mises stress at each node [Pa], (nodes,); see `node_stresses`."""
        return node_stresses(self.robot, self.nodes)

    @property
    def pin_forces(self) -> Points:
        """Reaction force of each pin on the body [N], (pins, dim), with driven pins at their moved positions."""
        mesh, forces = self.robot.body.mesh, []
        values = {
            drive.name: (drive, float(value)) for drive, value in zip(self.robot.drives, self.drives, strict=True)
        }
        for pin in self.robot.pins:
            held = pin.anchors(mesh)
            places = held.positions(mesh.nodes)
            if pin.drive is not None:
                drive, value = values[pin.drive]
                places = drive.move(places, value) if isinstance(drive, PinDrive) else places
            forces.append(pin.stiffness * (places - held.positions(self.nodes)).mean(axis=0))
        return np.array(forces).reshape(-1, mesh.dim)

    def plot(self, **options: Any) -> "Figure":
        """Draw the pose over a ghost of the rest shape, as a Matplotlib figure.

        Args:
            options: `title`, `note` and `width` of `hydrostat.plot.draw_pose`.
        """
        return draw_record("pose", self.robot, self, **options)

    def __repr__(self) -> str:
        """Return a one-line summary."""
        taken = [
            f"{winch.name} {1e3 * value:.4g} mm"
            for winch, value in zip(self.robot.winches, self.contractions, strict=True)
            if value
        ]
        taken += [
            f"{drive.name} {drive.format_value(value)}"
            for drive, value in zip(self.robot.drives, self.drives, strict=True)
            if value
        ]
        pulls = f", tensions up to {self.tensions.max():.3g} N" if len(self.tensions) else ""
        contractions = ", ".join(taken) or "no contractions"
        return f"<Equilibrium of {self.robot.name!r}: {contractions}{pulls}; {self.result.status}>"

    def _repr_html_(self) -> str:
        """Summary, warnings and a picture, for a notebook."""
        return html_repr("\n".join([repr(self), *self.warnings, *self.notes]), self.plot())

    @property
    def controls(self) -> Vector:
        """Contractions [m], then drive values [rad or m]: all inputs of the energies."""
        return np.concatenate([self.contractions, self.drives]) if len(self.drives) else self.contractions

    @property
    def unknowns(self) -> Nodes:
        """All unknowns of the energies [m]: the nodes, then the rows of moving obstacles."""
        return self.nodes if self.carried is None else np.concatenate([self.nodes, self.carried])

    @property
    def is_unmodified(self) -> bool:
        """True if its nodes are the array that the solver returned, not a copy."""
        return self.result.nodes is (self.nodes if self.carried is None else self.nodes.base)

    def without_factors(self) -> "Equilibrium":
        """Return the pose without its factorized Hessian, which takes megabytes, to keep many poses."""
        return replace(self, result=replace(self.result, stiffness=None))

    @property
    def out_of_plane(self) -> float:
        """Largest distance of a marker of a filled body from the plane z = 0 [m]."""
        return max((abs(float(place[2])) for place in self.markers.values()), default=0.0)


def name_values(robot: Robot) -> dict[str, list[str]]:
    """Names of contractions, tensions and drives of a pose of a robot."""
    return {
        "contractions": [winch.name for winch in robot.winches],
        "tensions": [cable.name for cable in robot.cables],
        "drives": [drive.name for drive in robot.drives],
    }


def pose_columns(state: Any) -> Columns:
    """Columns of one pose or instant: contractions, drives, markers, tensions."""
    robot: Robot = state.robot
    names = name_values(robot)
    drives, values = {drive.name: drive.unit for drive in robot.drives}, np.append(state.contractions, state.drives)
    columns = control_columns(names["contractions"], drives, np.atleast_2d(values))
    columns |= marker_columns({name: np.atleast_2d(place) for name, place in state.markers.items()})
    return columns | named_columns("tension", names["tensions"], np.atleast_2d(state.tensions), "N")


def beyond_travel(robot: Robot, contractions: Vector) -> list[str]:
    """Winches that would take in more than they can, or let out more, in words; empty where none does."""
    hair = 1e-9  # Tolerance for rounding errors of a contraction [m]
    return [
        f"winch {winch.name}: contraction {1e3 * value:.4g} mm is outside its range "
        f"({0.0 - 1e3 * winch.release:g} to {1e3 * winch.travel:g} mm)"
        for winch, value in zip(robot.winches, contractions, strict=True)
        if not -winch.release - hair <= value <= winch.travel + hair
    ]


def warn_beyond_travel(pose: Equilibrium) -> Equilibrium:
    """Return a pose; warn the caller of its solve of contractions that the winches cannot reach."""
    if words := "; ".join(beyond_travel(pose.robot, pose.contractions)):
        warnings.warn(words, HydrostatWarning, stacklevel=3)
    return pose


def largest_distance(one: Nodes, other: Nodes) -> float:
    """Largest distance of a node between two poses [m]."""
    return float(np.linalg.norm(one - other, axis=1).max())


def check_apart(mesh: Mesh, nodes: Nodes) -> None:
    """Check that a body with self-contact does not intersect itself at the start of a solve.

    Raises:
        InputError: it does; with a place.
    """
    if words := str(find_crossings(mesh, nodes)):
        raise InputError(f"no solve can begin there: {words.partition(':')[0]}")


def check_pose(
    pose: object, shape: tuple[int, ...], winches: int, history: Vector | None = None, *, what: str = "start"
) -> None:
    """Check that a pose is one of a robot, such as one that a solve can begin from.

    Args:
        pose: value to check.
        shape: shape of the robot's node array.
        winches: number of winches and drives.
        history: history variables of physics that depend on the loading path; None for other physics.
        what: purpose of the pose, for messages.

    Raises:
        InputError: it is no pose, one of another robot, not finite, or without slips where cables rub.
    """
    if not isinstance(pose, Equilibrium):
        kind = type(pose).__name__
        raise InputError(f"{what} must be a solved pose, from `simulation.solve` or a result's `.pose`, not {kind}")
    if not (pose.nodes.shape == shape and np.isfinite(pose.nodes).all()):
        raise InputError(f"{what} must be a pose of this robot with finite nodes, {shape}, not {pose.nodes.shape}")
    given = len(pose.controls)
    if given != winches:
        raise InputError(f"{what} has {given} contractions, the robot {winches} winches")
    if history is not None and len(pose.history) != len(history):
        raise InputError(
            f"{what} must be a pose of these physics, which remember the way, such as slips of cables with friction: "
            f"{len(history)} numbers, not {len(pose.history)}"
        )
