"""`design_cables`, `find_network`: from poses to winches and cables."""

# Of the thesis (docs/thesis.md): R2, R35, F1, E28

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TypedDict, Unpack

from hydrostat.closed_set import parse_choice
from hydrostat.design.cable_sides import assign_cable_sides
from hydrostat.design.constraints import Constraints
from hydrostat.design.fixed_drives import restore_drives, simplify_robot
from hydrostat.design.lifts import CROSSING, may_cross, search_front
from hydrostat.design.network import Alternative, Better, Network, RouteTrace, StageCallback, ignore_stage, size_of
from hydrostat.design.request import DesignMethod, DesignRequest, RouteOptions, TreeOptions
from hydrostat.design.routes.design_fewest import design_fewest
from hydrostat.design.routes.design_routes import design_routes
from hydrostat.design.routes.finalists import kit_fits
from hydrostat.design.routes.search_record import SearchRecord
from hydrostat.design.stuffed_results import StuffedResults, check_stuffed, solve_stuffed
from hydrostat.design.trees.design_trees import design_trees
from hydrostat.errors import HydrostatError, InputError
from hydrostat.given import check_type
from hydrostat.progress import Progress, no_progress
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import BodyPhysics


class DesignKeywords(TypedDict, total=False):
    """Fields of `DesignRequest` as keywords; those left out are as there."""

    winches: int | str
    cables: int
    method: str
    constraints: Constraints | None
    options: RouteOptions | TreeOptions | None
    warm_start: bool
    stuffed: bool
    front: bool
    seconds: float | None


def design_cables(
    robot: Robot,
    poses: Iterable[PoseTarget],
    *,
    progress: Progress | None = None,
    watch: StageCallback | None = None,
    **asked: Unpack[DesignKeywords],
) -> Network:
    """Design a network of winches and cables that moves a robot into given poses.

    Args:
        robot: body, pins and markers; its own winches and cables are ignored unless they are locked.
        poses: poses to reach, all with the same cables.
        progress: callback for progress.
        watch: callback for each better network during the search, before its final evaluation.
        asked: `winches`, `cables`, `method`, `constraints`, `options`, `warm_start`, `stuffed`, `front` and `seconds`
            of a `DesignRequest`. With `winches="auto"` the alternatives of the network are the best of every size
            tried.

    Raises:
        InputError: no pose, a pose with an unknown marker, or counts, constraints or options that do not fit.
        HydrostatError: no network can be built.
    """
    if isinstance(poses, PoseTarget) or not isinstance(poses, Iterable):
        raise InputError(f"poses must be several, such as [pose] or robot.poses.values(), not {type(poses).__name__}")
    for name in asked:
        if name not in DesignKeywords.__annotations__:
            known = ", ".join(DesignKeywords.__annotations__)
            raise InputError(
                f'unknown argument "{name}". Allowed: {known}. Put build limits in constraints=Constraints(...).'
            )
    check_type(asked.get("constraints"), (Constraints, type(None)), "constraints must be Constraints(...)")
    given = {name: value for name, value in asked.items() if value is not None}
    given["method"] = parse_choice(DesignMethod, given.get("method", DesignRequest.method), what="method")
    return find_network(robot, DesignRequest(poses=tuple(poses), **given), progress=progress, watch=watch)  # type: ignore[arg-type]


def find_network(
    robot: Robot,
    request: DesignRequest,
    *,
    progress: Progress | None = None,
    watch: StageCallback | None = None,
    record: SearchRecord | None = None,
) -> Network:
    """Find the network that a request asks for; `design_cables` for one that is made already.

    `watch` receives each better network that is found on the way. `record` keeps the steps of a search for routes, and
    begins with those that it knows; parts with contact have none. The cables of a flat robot that does not say where
    they run are designed to be sewn in pairs (`assign_cable_sides`), and the network's robot says so, and its motor.
    Drives stay at rest in the search, and return with the network. It models no units of winches.

    Raises:
        InputError: a request that does not fit the robot.
        HydrostatError: no network can be built.
    """
    if not isinstance(robot, Robot):
        raise InputError(f"a network is found for a Robot, such as load_robot gives, not for {robot!r:.60}")
    simple = simplify_robot(robot)
    stated, told = replace(assign_cable_sides(simple), motor=request.motor_for(robot)), progress or no_progress
    fitted = request.fit_robot(stated)
    if fitted.stuffed:
        check_stuffed(stated)  # told before the search
    try:
        found = _search(stated, fitted, told, Better(watch or ignore_stage), record)
    except HydrostatError as error:
        if fitted.method.grows_trees or fitted.is_open or not may_cross(stated, fitted):
            raise
        words = f"{str(error).removesuffix('.')}. Drawn shapes are in the way: {CROSSING} allows crossing."
        raise HydrostatError(words) from None
    if fitted.stuffed:
        found = evaluate_stuffed(found, progress=told)
    if fitted.front and (found.complete or found.timed_out):
        found = search_front(found, fitted, lambda asked: _search(stated, asked, told, ignore_stage, None))
    return restore_drives(replace(found, source=robot), robot)


def _search(
    robot: Robot, request: DesignRequest, told: Progress, seen: StageCallback, record: SearchRecord | None
) -> Network:
    """The network of the method that is asked for."""
    if request.method.grows_trees:
        return design_trees(robot, request, progress=told, watch=seen)
    if not isinstance(request.winches, int):
        return design_fewest(robot, request, progress=told, watch=seen, record=record)
    body = BodyPhysics(robot)

    def design(asked: DesignRequest) -> Network:
        def hints(_: BodyPhysics) -> list[Robot]:
            return _trees(robot, asked, body)

        return design_routes(robot, asked, progress=told, watch=seen, hints=hints, body=body, record=record)

    found = design(request)
    return _search_with_fewer(request, found, design) if _may_gain_by_fewer(request, found) else found


def _may_gain_by_fewer(request: DesignRequest, found: Network) -> bool:
    """True if each winch got one cable where more were allowed: units for more cables may have had too little room."""
    fewest = len(found.robot.cables) == len(found.robot.winches) < request.cables
    return found.complete and fewest and request.seconds is None and not request.warm_start


def _search_with_fewer(request: DesignRequest, found: Network, design: Callable[[DesignRequest], Network]) -> Network:
    """The better of a network and of one from a search with no more cables than it has."""
    winches, cables = len(found.robot.winches), len(found.robot.cables)
    try:
        other = design(replace(request, winches=winches, cables=cables))
    except HydrostatError:  # none can be built
        return found
    except KeyboardInterrupt:
        return replace(found, complete=False)
    better = other.expected_error < found.expected_error and (kit_fits(other) or not kit_fits(found))
    return replace(
        other if better else found,
        request=found.request,
        num_evaluated=found.num_evaluated + other.num_evaluated,
        complete=other.complete,
    )


def _trees(robot: Robot, request: DesignRequest, body: BodyPhysics) -> list[Robot]:
    """Return the network of the thesis's method for a flat body: another start for routes, in a second or two."""
    if robot.body.mesh.dim != 2 or request.warm_start:
        return []
    usual = Constraints(clearance=request.constraints.clearance, tension=request.constraints.tension)
    plain = {"seconds": None, "front": False, "constraints": usual}
    asked = replace(request, method=DesignMethod.TREES, options=TreeOptions(trials=_TREES), **plain)
    try:
        return [design_trees(robot, asked, progress=no_progress, body=body).robot]
    except HydrostatError:  # none can be built
        return []


_TREES = 16  # networks of winch trees whose poses are solved


FINALISTS = 4  # networks compared: the one that was found, and the first of its alternatives
GAIN = 0.95  # another network takes its place if its error on the filled body is less than this share of its own


def evaluate_stuffed(found: Network, *, progress: Progress) -> Network:
    """The network with what it reaches on the filled body; an alternative that does better there takes its place.

    Compared are alternatives with no more winches and no more cables, of which a kit can be made. Stopped
    (KeyboardInterrupt), the best of those that were looked at is returned.
    """
    first = Alternative(robot=found.robot, ik_results=found.ik_results, expected_error=found.expected_error)
    winches, cables = size_of(found)
    small = [one for one in found.alternatives if size_of(one)[0] <= winches and size_of(one)[1] <= cables]
    fitting = [one for one in small if kit_fits(one)]
    finalists = [first, *fitting[: FINALISTS - 1]]
    judged: list[tuple[Alternative, StuffedResults]] = []
    complete = found.complete
    try:
        for number, one in enumerate(finalists):
            progress("Filled bodies", number, len(finalists))
            reach = _reach(found, one)
            judged += [] if reach is None else [(one, reach)]
    except KeyboardInterrupt:
        complete = False
    progress("Filled bodies", 1, 1)
    if not judged:
        return replace(found, complete=complete)
    best, reach = judged[0]
    for one, other in judged[1:]:
        if other.rms_error < GAIN * reach.rms_error:
            best, reach = one, other
    reach = replace(reach, finalists=len(judged))
    if best is first:
        return replace(found, stuffed=reach, complete=complete)
    others = (first, *(one for one in found.alternatives if one is not best))
    trace = replace(found.trace, certificate=None) if isinstance(found.trace, RouteTrace) else found.trace
    return replace(
        found,
        robot=best.robot,
        ik_results=best.ik_results,
        expected_error=best.expected_error,
        alternatives=others,
        trace=trace,
        stuffed=reach,
        complete=complete,
    )


def _reach(found: Network, one: Alternative) -> StuffedResults | None:
    """Return the results of a network on the filled body; None where a pose has no equilibrium there."""
    try:
        return solve_stuffed(one.robot, one.ik_results, limits=found.constraints.limits)
    except HydrostatError:
        return None
