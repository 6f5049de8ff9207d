"""`design_fewest`: the fewest winches that bring every pose within a tolerance (F1, F2)."""

from collections.abc import Iterable
from dataclasses import replace

from hydrostat.design.network import Alternative, Better, Network, Size, StageCallback, ignore_stage, size_of
from hydrostat.design.request import COUNTS, DesignRequest
from hydrostat.design.routes.deadline import Deadline
from hydrostat.design.routes.design_routes import FirstRobots, RouteSearch
from hydrostat.design.routes.finalists import kit_fits
from hydrostat.design.routes.search_record import SearchRecord
from hydrostat.design.routes.search_rules import RULES
from hydrostat.errors import HydrostatError, InputError
from hydrostat.progress import Progress
from hydrostat.robot import Robot
from hydrostat.simulation import BodyPhysics


def design_fewest(
    robot: Robot,
    request: DesignRequest,
    *,
    progress: Progress,
    watch: StageCallback = ignore_stage,
    hints: FirstRobots = lambda _: (),
    record: SearchRecord | None = None,
) -> Network:
    """One winch, then two, and so on, until every pose is reached within the tolerance, or there are no more cables.

    Each number of winches is searched by itself. It ends, as it may, with fewer cables than are allowed. Of networks
    that miss the tolerance the best one is returned, those whose kit would be refused last. Locked winches count;
    `watch` receives each better network on the way, whatever its number of winches; `record` keeps the steps.
    """
    size = robot.body.mesh.size
    constraints, options, cables = request.constraints, request.route_options, request.cables
    tolerance = RULES.usual_tolerance * size if options.tolerance is None else options.tolerance
    sought = replace(options, stop_error=max(options.stop_error, RULES.safe_tolerance * tolerance / size))
    found: list[Network] = []
    body, better = BodyPhysics(robot), Better(watch)
    front: dict[Size, Alternative] = {}
    interrupted, deadline = False, Deadline.after(request.seconds)
    least = _fewest(robot, request)
    largest = min(cables, int(COUNTS["winches"].most))
    for winches in range(least, largest + 1):
        most = min(cables, winches * constraints.cables_per_winch)
        asked = replace(request, winches=winches, cables=most, options=sought)
        search = RouteSearch(robot, asked, body, progress, better, hints, deadline, record)
        try:
            found.append(search.run())
        except KeyboardInterrupt:
            if not found:
                raise
            interrupted = True
            break
        except InputError:
            raise
        except HydrostatError:
            if winches == largest and not found:
                raise
            continue
        sizes = search.sizes if found[-1].complete else {}
        judged = (search.finalists.judge(trial.layout) for trial in sizes.values())
        _keep_best(front, [*(network for network in judged if network is not None), *_all(found[-1])])
        if not found[-1].complete or all(reached.rms_error <= tolerance for reached in found[-1].ik_results):
            break
    best = found[-1]
    if any(reached.rms_error > tolerance for reached in best.ik_results):
        best = min(found, key=_worth)
    return replace(
        best,
        alternatives=tuple(front[counts] for counts in sorted(front)),
        request=replace(request, constraints=best.request.constraints),
        num_evaluated=sum(network.num_evaluated for network in found),
        seconds=sum(network.seconds for network in found),
        complete=not interrupted and all(network.complete for network in found),
        timed_out=found[-1].timed_out,
    )


def _fewest(robot: Robot, request: DesignRequest) -> int:
    """The number of winches to begin with: those that stay, two where a mirrored network has a cable on each."""
    constraints, cables = request.constraints, request.cables
    least = max(1, len(constraints.staying(robot)[0]))
    if constraints.mirror is not None and constraints.cables_per_winch == 1:
        least = max(least, 2)
    if least > cables:
        raise InputError(
            f"{least} winches are needed at the least, for what is locked or mirrored, but there may be {cables} cables"
        )
    return least


def _keep_best(front: dict[Size, Alternative], networks: Iterable[Alternative]) -> None:
    """Put networks in place of those of their size that have a larger error."""
    for network in networks:
        size = size_of(network)
        if size not in front or _worth(network) < _worth(front[size]):
            front[size] = network


def _worth(network: Alternative | Network) -> tuple[bool, float]:
    """By which the best is the least: those whose kit would be refused come last, then the error once built."""
    return not kit_fits(network), network.expected_error


def _all(network: Network) -> tuple[Alternative, ...]:
    return Alternative(
        robot=network.robot,
        ik_results=network.ik_results,
        expected_error=network.expected_error,
    ), *network.alternatives
