"""`design_cables`: from poses to winches and cables."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from hydrostat.design.constraints import Constraints
from hydrostat.design.network import Network
from hydrostat.design.progress import Progress, Watch, silent, unseen
from hydrostat.design.request import RouteOptions, TreeOptions
from hydrostat.design.routes.design_fewest import design_fewest
from hydrostat.design.routes.design_routes import design_routes
from hydrostat.design.trees.design_trees import design_trees
from hydrostat.errors import InputError
from hydrostat.robot import Pose, Robot

METHODS = ("routes", "trees")
"""Ours, and the thesis's."""

AUTO = "auto"
"""As many winches as are needed."""


def design_cables(
    robot: Robot,
    poses: Iterable[Pose],
    *,
    winches: int | str,
    cables: int,
    method: str = "routes",
    constraints: Constraints | None = None,
    options: RouteOptions | TreeOptions | None = None,
    improve: bool = False,
    progress: Progress | None = None,
    watch: Watch | None = None,
) -> Network:
    """A network of winches and cables that brings a robot into some poses (R2, R35, F1, E28).

    Args:
        robot: body, pins and markers; its own winches and cables are left aside but for those that are locked.
        poses: what the network should reach, all of them with the same cables.
        winches: how many; "auto" for the fewest that bring every pose under the tolerance of the options (F1, F2): then
            `alternatives` hold the best network found of every size that was tried.
        cables: how many in all, at least one a winch.
        method: "routes" prices routes by the pose error and moves them to where it is least; "trees" is the thesis's.
        constraints: what can be built.
        options: of the method: `RouteOptions` or `TreeOptions`.
        improve: begin with the robot's own winches and cables, and move and exchange those that are not locked; what
            travel, release, slack and spools these have is allowed.
        progress: called as the work goes on.
        watch: called with each better network that is found on the way, not yet judged as those are that are returned.

    Raises:
        InputError: no pose, a pose of a marker that does not exist, counts, constraints or options that do not fit.
        HydrostatError: no network can be built.
    """
    poses = list(poses)
    given = constraints or Constraints()
    if improve:
        given = _with_own(given, robot)
    _check(robot, poses, winches, cables, given)
    given.check(robot)
    if method not in METHODS:
        raise InputError(f'method = "{method}": must be one of {", ".join(METHODS)}')
    told, seen = progress or silent, watch or unseen
    if method == "trees":
        options = options or TreeOptions()
        if not isinstance(options, TreeOptions):
            raise InputError(f'options of method "trees" must be TreeOptions, not {type(options).__name__}')
        if improve or not isinstance(winches, int):
            raise InputError('method "trees" starts from nothing with a number of winches; use method "routes"')
        _check_trees(robot, given)
        return design_trees(
            robot, poses, winches=winches, cables=cables, constraints=given, options=options, progress=told, watch=seen
        )
    options = options or RouteOptions()
    if not isinstance(options, RouteOptions):
        raise InputError(f'options of method "routes" must be RouteOptions, not {type(options).__name__}')
    if not isinstance(winches, int):
        if improve:
            raise InputError('winches = "auto" starts from nothing; give a number of winches to improve a network')
        return design_fewest(robot, poses, cables=cables, constraints=given, options=options, progress=told, watch=seen)
    return design_routes(
        robot,
        poses,
        winches=winches,
        cables=cables,
        constraints=given,
        options=options,
        progress=told,
        watch=seen,
        improve=improve,
    )


def _check(robot: Robot, poses: Sequence[Pose], winches: int | str, cables: int, constraints: Constraints) -> None:
    if not poses:
        raise InputError("there is no pose to design for; add a [[pose]] to the robot")
    _check_counts(winches, cables, constraints)
    markers, dim = [marker.name for marker in robot.markers], robot.body.mesh.dim
    for pose in poses:
        if not isinstance(pose, Pose):
            raise InputError(f"poses must be Pose records, such as robot.poses.values(), not {pose!r}")
        for name, place in pose.targets.items():
            if len(place) != dim:
                raise InputError(
                    f'pose "{pose.name}": the target of {name} has {len(place)} coordinates, the body {dim}'
                )
        for name in pose.targets:
            if name not in markers:
                known = f"its markers are: {', '.join(markers)}" if markers else "it has no markers"
                raise InputError(f'pose "{pose.name}": the robot has no marker "{name}"; {known}')


def _check_counts(winches: int | str, cables: int, constraints: Constraints) -> None:
    for name, value in (("winches", winches), ("cables", cables)):
        if (name, value) != ("winches", AUTO) and (isinstance(value, bool) or not isinstance(value, int)):
            also = ' or "auto"' if name == "winches" else ""
            raise InputError(f"{name} must be a whole number{also}, not {value!r}")
    if not isinstance(winches, int):
        winches = 1
        constraints = replace(constraints, cables_per_winch=max(cables, 1))
    if not 1 <= winches <= cables:
        raise InputError(
            f"{winches} winches and {cables} cables: there must be at least one winch, and a cable for each"
        )
    if cables > winches * constraints.cables_per_winch:
        raise InputError(
            f"{winches} winches pull at most {winches * constraints.cables_per_winch} cables, not {cables}; "
            "ask for more winches, or raise cables_per_winch"
        )


def _with_own(constraints: Constraints, robot: Robot) -> Constraints:
    """Constraints that allow what the robot's own winches and stoppers have: travel, release, slack, spools."""
    ratios = [max(ratio, 1 / ratio) for ratio in robot.spool_ratios.tolist()]
    return replace(
        constraints,
        travel=max([constraints.travel, *(winch.travel for winch in robot.winches)]),
        release=max([constraints.release, *(winch.release for winch in robot.winches)]),
        slack=max([constraints.slack, *(cable.slack for cable in robot.cables)]),
        spool_ratio=max([constraints.spool_ratio, *ratios]),
    )


def _check_trees(robot: Robot, constraints: Constraints) -> None:
    """Refuse what the thesis's way does not know."""
    if robot.body.mesh.dim != 2:
        raise InputError('method "trees" designs for flat bodies only, this body lies in space; use method "routes"')
    usual = Constraints()
    asked = [name for name in _ROUTES_ONLY if getattr(constraints, name) != getattr(usual, name)]
    if asked:
        raise InputError(f'method "trees" does not keep {", ".join(asked)}; use method "routes", which does')


_ROUTES_ONLY = (
    "winch_zones", "keep_out", "still", "mount", "bend_radius", "longest", "torque", "slack", "spool_ratio", "mirror",
    "locked_winches", "locked_cables",
)  # fmt: skip
"""Constraints that winch trees are not grown within."""
