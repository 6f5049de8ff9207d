"""`DesignRequest`: inputs of a design, and options of its method."""

# Of the thesis (docs/thesis.md): F1, E28, M8 to M10, R39, R40, R43, E23, E24, E21

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from typing import Any, Self

import numpy as np

from hydrostat.closed_set import make_member
from hydrostat.design.constraints import ROUTES_ONLY, Constraints, Range
from hydrostat.design.drawn_shapes import drawn_zones
from hydrostat.design.muscles.activation import FibreKind
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.errors import InputError
from hydrostat.given import list_choices
from hydrostat.ik import place
from hydrostat.robot import PoseTarget, Robot
from hydrostat.units import plural, quote

AUTO = "auto"  # as many winches as are needed

COUNTS = {"winches": Range(whole=True, least=1, most=20), "cables": Range(whole=True, least=1, most=60)}
"""Allowed numbers of winches and of cables."""


class DesignMethod(StrEnum):
    """Search method: priced routes (adjoint-based), winch trees, or the search of Chang (2018) just as it is.

    Winch trees are that search with many settings, whose networks are compared by their pose error.
    """

    ROUTES = "routes"
    TREES = "trees"
    CHANG2018 = "chang2018"

    @property
    def grows_trees(self) -> bool:
        """True for winch trees, with many settings or one."""
        return self is not DesignMethod.ROUTES


@dataclass(frozen=True, kw_only=True)
class RouteOptions:
    """Options for the search for routes.

    Raises InputError for a value out of range.

    Attributes:
        stop_error: rms error, as a fraction of the body's size, at which the search stops.
        tolerance: rms error of each pose [m] that the fewest winches must reach where their number is left open; a
            hundredth of the body's size if left out.
        spacing: distance between via points, in mean mesh edges.
        max_edges: maximum number of edges in a candidate path.
        lead_penalty: share of the predicted gain that a lead as long as the body costs.
        trials: number of paths with solved networks before one is added.
        starts: effort of the growth: more sketches are refined, and more cables may fail in a row before it ends.
        exchanges: maximum number of cables that are removed, one at a time, and replaced by the best alternative.
        steps: steps of refinement after each cable.
        refine_steps: steps of refinement of a whole network.
        simplicity: weight of a simple network: at 1 a cable must lower the error as built by 2 %, a winch by
            4 %, a hole by 0.3 %; 0 keeps all that help at all.
        workspace_weight: weight of the workspace: displacements of the markers in every direction within
            travel and tension: a network that reaches twice as far may miss the poses by 2^reach times as much.
    """

    stop_error: float = 1e-4
    tolerance: float | None = None
    spacing: float = 2.0
    max_edges: int = 14
    lead_penalty: float = 0.3
    trials: int = 4
    starts: int = 1
    exchanges: int = 12
    steps: int = 5
    refine_steps: int = 60
    simplicity: float = 1.0
    workspace_weight: float = 0.0

    def __post_init__(self) -> None:
        for name, allowed in ROUTE_RANGES.items():
            if not allowed.holds(getattr(self, name)):
                raise InputError(f"RouteOptions.{name} must be {allowed}, not {getattr(self, name)!r}")

    @classmethod
    def ranges(cls) -> Mapping[str, Range]:
        """Return the allowed values of each number of the record, by the name of its field."""
        return ROUTE_RANGES


SECONDS = Range(above=True, unit="s")
"""Allowed time of a search."""

ROUTE_RANGES = {
    "stop_error": Range(),
    "tolerance": Range(above=True, most=1.0, optional=True, unit="m"),
    "spacing": Range(least=0.5),
    "max_edges": Range(whole=True, least=1),
    "lead_penalty": Range(),
    "trials": Range(whole=True, least=1),
    "starts": Range(whole=True, least=1),
    "exchanges": Range(whole=True),
    "steps": Range(whole=True),
    "refine_steps": Range(whole=True),
    "simplicity": Range(most=20.0),
    "workspace_weight": Range(most=5.0),
}
"""Allowed range of each number of `RouteOptions`."""


@dataclass(frozen=True, kw_only=True)
class TreeSettings:
    """Settings of one winch tree, one value of each (R46)."""

    threshold: int = 60  # number of candidate fibres (R39)
    distance: float = 1.5  # largest gap between two fibres that are joined, in mean mesh edges (R40)
    steps: int = 12  # most fibres joined to one route (R40)
    phi: float = 0.5  # weight of the mean against the spread in the score (R43)

    @classmethod
    def ranges(cls) -> Mapping[str, Range]:
        """Return the allowed values of each number of the record, by the name of its field."""
        return KNOB_RANGES


@dataclass(frozen=True, kw_only=True)
class TreeOptions:
    """Options for growing winch trees; lengths in units of the mean mesh edge unless stated otherwise.

    Raises InputError for an unknown kind of muscles.

    Attributes:
        fibres: a muscle on every mesh edge, or one in every element.
        effort: weight of squared tensions in the activation: the larger, the weaker the muscles and the error left.
        stages: number of steps toward the target.
        thresholds: numbers of candidate fibres to try.
        distances: maximum gaps between two fibres to try.
        growth_steps: maximum number of fibres joined to one route.
        turn: maximum turn of a route [degrees].
        shortest: minimum length of a route.
        phis: weights of the mean against the spread in the score to try.
        shares: maximum number of ways to try for sharing cables among winches, the most even first.
        trials: maximum number of networks with solved poses.
        loss: largest relative increase of the pose error by leaving out cables.
        lead_penalty: loss of score for a lead as long as the body.
    """

    fibres: FibreKind = FibreKind.EDGES
    effort: float = 1e-4
    stages: int = 5
    thresholds: tuple[int, ...] = (20, 40, 60, 80, 120, 160)
    distances: tuple[float, ...] = (0.6, 1.5, 2.5)
    growth_steps: int = 12
    turn: float = 75.0
    shortest: float = 2.5
    phis: tuple[float, ...] = (0.2, 0.5, 0.8)
    shares: int = 12
    trials: int = 64
    loss: float = 0.02
    lead_penalty: float = 0.1

    def __post_init__(self) -> None:
        make_member(self, "fibres", FibreKind)
        for name, allowed in TREE_RANGES.items():
            given = getattr(self, name)
            for value in given if isinstance(given, tuple) else (given,):
                if not allowed.holds(value):
                    raise InputError(f"TreeOptions.{name} must be {allowed}, not {value!r}")

    @classmethod
    def single(
        cls,
        *,
        threshold: int = TreeSettings.threshold,
        distance: float = TreeSettings.distance,
        steps: int = TreeSettings.steps,
        phi: float = TreeSettings.phi,
    ) -> Self:
        """Return the options of the thesis: one value of each of `TreeSettings`, no choice by pose error."""
        return cls(
            thresholds=(threshold,),
            distances=(distance,),
            growth_steps=steps,
            phis=(phi,),
            shares=1,
            trials=1,
            loss=0.0,
        )


TREE_RANGES = {
    "thresholds": Range(whole=True, least=1),
    "distances": Range(above=True),
    "growth_steps": Range(whole=True, least=1),
    "phis": Range(most=1.0),
    "shares": Range(whole=True, least=1),
    "trials": Range(whole=True, least=1),
}
"""Allowed range of each number of `TreeOptions`."""

KNOB_RANGES = {
    "threshold": TREE_RANGES["thresholds"],
    "distance": TREE_RANGES["distances"],
    "steps": TREE_RANGES["growth_steps"],
    "phi": TREE_RANGES["phis"],
}
"""Allowed values of each of `TreeSettings`."""


@dataclass(frozen=True, kw_only=True)
class DesignRequest:
    """Request for a design: poses to reach, numbers of winches and cables, constraints, and method.

    Raises InputError: no pose, a count out of its range, a method that there is not, options of another one, or what
    the method does not do.
    """

    poses: tuple[PoseTarget, ...]  # what the network should reach, all of them with the same cables
    # how many; "auto" for the fewest that bring every pose under the tolerance of the options (F1, F2)
    winches: int | str = 2
    cables: int = 6  # how many in all, at least one a winch
    # "routes" prices routes by the pose error and moves them to where it is least; "trees" is the thesis's
    method: DesignMethod = DesignMethod.ROUTES
    # what can be built, and what of the robot's own network stays
    constraints: Constraints = field(default_factory=Constraints)
    options: RouteOptions | TreeOptions | None = None  # of the method; its usual ones if left out
    # what a builder cannot make just so: routes are chosen by the error of robots as they are built; None: what is
    # usual for the body, `BuildTolerances.none()` for what is best in the model
    uncertainty: BuildTolerances | None = None
    # begin with the robot's own winches and cables, and move and exchange those that are not locked; what travel,
    # release, slack and spools these have is allowed
    warm_start: bool = False
    # wall time [s] after which the search ends with the best network so far, once there is one; None: it ends by itself
    seconds: float | None = None
    # finalists of a flat robot are compared on the filled body, their cables on its skin, by commands found there
    stuffed: bool = False
    # whole searches for a winch fewer and more, and for winches that pull both ways, are alternatives too
    front: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "poses", tuple(self.poses))
        if not self.poses:
            raise InputError("no pose to design for. Add a [[pose]] to robot.toml.")
        for pose in self.poses:
            if not isinstance(pose, PoseTarget):
                raise InputError(f"poses must be Pose records, such as robot.poses.values(), not {pose!r}")
        if self.seconds is not None and not SECONDS.holds(self.seconds):
            raise InputError(f"seconds must be {SECONDS}, or None for no limit, not {self.seconds!r:.60}")
        self._check_counts()
        make_member(self, "method", DesignMethod)
        kind = _OPTIONS[self.method]
        usual = TreeOptions.single() if self.method is DesignMethod.CHANG2018 else kind()
        object.__setattr__(self, "options", self.options or usual)
        if not isinstance(self.options, kind):
            told = type(self.options).__name__
            raise InputError(f'options of method "{self.method}" must be {kind.__name__}, not {told}')
        if self.method.grows_trees:
            self._check_trees()
        if self.warm_start and self.winches == AUTO:
            raise InputError('winches: cannot improve a network ("auto"). Give a number of winches.')

    @property
    def route_options(self) -> RouteOptions:
        """Options of the search for routes."""
        return self.options if isinstance(self.options, RouteOptions) else RouteOptions()

    @property
    def tree_options(self) -> TreeOptions:
        """Options of the growth of winch trees."""
        return self.options if isinstance(self.options, TreeOptions) else TreeOptions()

    def fit_robot(self, robot: Robot) -> "DesignRequest":
        """The request as one robot can be designed for: where its network is improved, that is within the constraints.

        Raises InputError: a pose of a marker that it does not have, or constraints that do not fit it.
        """
        markers, dim = [marker.name for marker in robot.markers], robot.body.mesh.dim
        for pose in self.poses:
            for name, point in pose.targets.items():
                if len(point) != dim:
                    raise InputError(
                        f'pose "{pose.name}": target of {name}: wrong dimension ({len(point)}). Body: {dim}.'
                    )
                place(f'pose "{pose.name}": the target of {name}', point, robot.body.mesh)  # in meters
                if name not in markers:
                    known = list_choices("markers", markers, name)
                    raise InputError(f'pose "{pose.name}": unknown marker {quote(name)}. {known}')
        self.constraints.check(robot)
        if robot.body.has_hysteresis:
            raise InputError("material.hysteresis: not known to designs. Remove it for the design, then add it again.")
        if self.stuffed and robot.body.outline is None:
            raise InputError("filled: only for flat robots with a drawing. Remove it.")
        constraints = self.constraints if self.method.grows_trees else self._fit_constraints(robot)
        return replace(
            self,
            uncertainty=self.uncertainty or BuildTolerances.of(robot.body),
            constraints=_with_own(constraints, robot) if self.warm_start else constraints,
        )

    def _fit_constraints(self, robot: Robot) -> Constraints:
        """The constraints with the motor of a robot, and zones without cables around its drawn shapes."""
        zones = (*self.constraints.keep_out, *drawn_zones(robot.body, self.constraints.drawing_gap))
        return replace(self.constraints, motor=self.motor_for(robot), keep_out=tuple(dict.fromkeys(zones)))

    def motor_for(self, robot: Robot) -> str:
        """Key of the motor of the winches: that of the constraints, else that of the robot."""
        return robot.motor if self.constraints.motor == "auto" else self.constraints.motor

    def as_values(self) -> dict[str, Any]:
        """Counts, constraints and options as plain values, poses by their names."""
        values = asdict(self)
        return values | {"poses": [pose.name for pose in self.poses], "method": str(self.method)}

    def _check_counts(self) -> None:
        for name, allowed in COUNTS.items():
            value = getattr(self, name)
            if (name, value) != ("winches", AUTO) and not allowed.holds(value):
                also = ' or "auto"' if name == "winches" else ""
                raise InputError(f"{name} must be {allowed}{also}, not {value!r:.60}")
        if not isinstance(self.winches, int):
            return
        if self.winches > self.cables:
            raise InputError(
                f"{plural(self.winches, 'winch')} need at least {plural(self.winches, 'cable')}, got {self.cables}. "
                "Ask for more cables or fewer winches."
            )
        most = self.winches * self.constraints.cables_per_winch
        if self.cables > most:
            raise InputError(
                f"{plural(self.winches, 'winch')} can pull at most {plural(most, 'cable')}, got {self.cables}. "
                "Ask for more winches or raise cables_per_winch."
            )

    def _check_trees(self) -> None:
        """Refuse what the thesis's way does not know."""
        if self.front:
            raise InputError(f'method "{self.method}" has no front. Use method "routes".')
        if self.seconds is not None:
            raise InputError(f'method "{self.method}" has no time limit. Use method "routes".')
        if self.warm_start or self.winches == AUTO:
            raise InputError(
                f'method "{self.method}" needs a number of winches and cannot improve a network. Use method "routes".'
            )
        usual = Constraints()
        asked = [name for name in ROUTES_ONLY if getattr(self.constraints, name) != getattr(usual, name)]
        if asked:
            raise InputError(
                f'method "{self.method}" does not keep {", ".join(asked)}. Use method "routes", which does.'
            )

    @property
    def is_open(self) -> bool:
        """True if the search chooses the number of winches."""
        return self.winches == AUTO

    @classmethod
    def ranges(cls) -> Mapping[str, Range]:
        """Return the allowed numbers of winches and of cables, by the name of the field."""
        return COUNTS


_OPTIONS: dict[str, type[RouteOptions] | type[TreeOptions]] = {
    DesignMethod.ROUTES: RouteOptions,
    DesignMethod.TREES: TreeOptions,
    DesignMethod.CHANG2018: TreeOptions,
}


def _with_own(constraints: Constraints, robot: Robot) -> Constraints:
    """Constraints that allow what the robot's own winches and stoppers have: travel, release, slack, spools."""
    ratios = [max(ratio, 1 / ratio) for ratio in np.abs(robot.spool_ratios).tolist()]
    return replace(
        constraints,
        travel=max([constraints.travel, *(winch.travel for winch in robot.winches)]),
        release=max([constraints.release, *(winch.release for winch in robot.winches)]),
        slack=max([constraints.slack, *(cable.slack for cable in robot.cables)]),
        spool_ratio=max([constraints.spool_ratio, *ratios]),
        two_way=constraints.two_way or any(cable.reverse for cable in robot.cables),
    )
