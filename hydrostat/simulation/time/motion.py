"""`Motion`: a robot at one instant of its motion."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.mechanics import NewtonResult, ViscousMetrics
from hydrostat.named_vector import NamedVector
from hydrostat.painters import html_repr
from hydrostat.result_table import Columns, Tabular
from hydrostat.robot import Robot
from hydrostat.simulation.equilibrium import Equilibrium, name_values, pose_columns


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion(Tabular):
    """State of a motion at one time: all inputs of the next step, and the observable quantities.

    Attributes:
        robot: moving robot.
        time: time since the start [s].
        contractions: contraction of each winch [m], in winch order.
        pin_shifts: displacement of each pin [m], in pin order.
        nodes: node positions [m].
        velocities: node velocities [m/s].
        accelerations: node accelerations [m/s^2].
        metrics: metrics of the viscous branches in each element; none for an elastic body.
        markers: position of each marker [m].
        tensions: tension of each cable [N], in cable order.
        kinetic: kinetic energy [J].
        potential: potential energy of body, cables, pins, weight and branches [J].
        history: history variables of the physics: cable slip at each point with friction so far [m]; empty without
            friction.
        drives: value of each drive [rad or m].
        carried: unknowns of moving obstacles [m], their velocities [m/s] and accelerations [m/s^2]; None if no obstacle
            moves.
        result: result of the last minimization of the step, with the energy of the step and the total number of
            iterations.
    """

    robot: Robot
    time: float
    contractions: Vector
    pin_shifts: Points
    nodes: Nodes
    velocities: Nodes
    accelerations: Nodes
    metrics: ViscousMetrics
    markers: Mapping[str, Vector]
    tensions: Vector
    kinetic: float
    potential: float
    history: Vector = field(default_factory=lambda: np.zeros(0))
    result: NewtonResult | None = None
    carried: tuple[Points, Points, Points] | None = None
    drives: Vector = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        """Give contractions, tensions and drives their names."""
        for field_name, parts in name_values(self.robot).items():
            values = getattr(self, field_name)
            if len(values) == len(parts):
                object.__setattr__(self, field_name, NamedVector(values, parts))

    def columns(self) -> Columns:
        """Return a table of time, contractions, drive values, markers, tensions and energies, with one row."""
        energies = {"kinetic_J": np.array([self.kinetic]), "potential_J": np.array([self.potential])}
        return {"time_s": np.array([self.time]), **pose_columns(self), **energies}

    def _repr_html_(self) -> str:
        """Summary and a picture, for a notebook."""
        return repr(self) if self.result is None else html_repr(repr(self), self.pose.plot())

    def __repr__(self) -> str:
        """Return a one-line summary."""
        fastest = 1e3 * float(np.linalg.norm(self.velocities, axis=1).max(initial=0.0))
        return f"<Motion of {self.robot.name!r} at {self.time:.4g} s: no node is faster than {fastest:.2g} mm/s>"

    @property
    def controls(self) -> Vector:
        """Contractions [m], then drive values [rad or m]."""
        return np.concatenate([self.contractions, self.drives])

    @property
    def energy(self) -> float:
        """Kinetic and potential energy [J]."""
        return self.kinetic + self.potential

    @property
    def pose(self) -> Equilibrium:
        """Observable quantities as a pose; it is not an equilibrium, and its result is that of the last step.

        Raises:
            ValueError: the motion has made no step yet.
        """
        if self.result is None:
            raise ValueError("a motion that has not begun has no result; use the pose that it began in")
        return Equilibrium(
            robot=self.robot,
            contractions=self.contractions,
            drives=self.drives,
            nodes=self.nodes,
            markers=self.markers,
            tensions=self.tensions,
            energy=self.potential,
            result=self.result,
            history=self.history,
            carried=None if self.carried is None else self.carried[0],
        )
