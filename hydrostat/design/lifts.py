"""`find_lifts`, `search_front`: networks of other numbers of winches, and of winches that pull both ways."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from hydrostat.design.drawn_shapes import drawn_zones
from hydrostat.design.fixed_drives import restore_drives, simplify_robot
from hydrostat.design.network import Alternative, Network
from hydrostat.design.request import COUNTS, DesignRequest
from hydrostat.design.routes.finalists import kit_fits
from hydrostat.design.routes.quick_search import propose_routes
from hydrostat.errors import HydrostatError
from hydrostat.robot import Robot


@dataclass(frozen=True, kw_only=True)
class Lift:
    """A change of a request that lowers the error."""

    words: str  # as options of `hydrostat design`
    network: Alternative  # that a quick search finds with it


def find_lifts(network: Network) -> tuple[Lift, ...]:
    """Find changes that would leave a clearly smaller error where fewer winches than poses share contractions.

    Tried are one more winch, winches that pull both ways, and, where the error is large, cables across drawn shapes
    or, without such shapes, cables that cross. A quick search (`propose_routes`) takes about as long as the whole one;
    that may find better. Only networks count whose kit would be made.
    """
    request, lifts = network.request, []
    if not isinstance(request.winches, int) or request.warm_start:
        return ()
    changes = list(_changes(request, request.winches)) if request.winches < len(request.poses) else []
    if network.expected_error > _LARGE_ERROR * network.source.body.mesh.size:
        if across := _across_drawings(network.source, request):
            changes.append((CROSSING, across))
        elif request.winches >= len(request.poses) and request.constraints.cable_gap > 0:
            changes.append((CROSSING_LINE, replace(request, constraints=replace(request.constraints, cable_gap=0.0))))
    for words, changed in changes:
        best = _find_quickly(network.source, changed)
        if best is not None and best.expected_error < _BETTER_RATIO * network.expected_error:
            lifts.append(Lift(words=words, network=best))
    return tuple(lifts)


def may_cross(robot: Robot, request: DesignRequest) -> bool:
    """True if a quick search finds a network that only drawn shapes are in the way of."""
    across = _across_drawings(robot, request)
    return across is not None and _find_quickly(robot, across) is not None


def _across_drawings(robot: Robot, request: DesignRequest) -> DesignRequest | None:
    """The request with cables across drawn shapes; None if nothing is drawn, or they may cross it already."""
    limits = request.constraints
    drawn = drawn_zones(robot.body, limits.drawing_gap)
    zones = tuple(zone for zone in limits.keep_out if zone not in drawn)
    return replace(request, constraints=replace(limits, drawing_gap=0.0, keep_out=zones)) if drawn else None


def _find_quickly(robot: Robot, request: DesignRequest) -> Alternative | None:
    """The network of a quick search whose kit would be made; None if there is none."""
    simple = simplify_robot(robot)
    try:
        found = [one for one in propose_routes(simple, request) if one.is_refined and one.is_buildable]
    except HydrostatError:  # such as no room for one more motor
        return None
    if not found:
        return None
    best = found[-1]
    taken = Alternative(robot=best.robot, ik_results=best.ik_results, expected_error=best.expected_error)
    return restore_drives(taken, robot)


def search_front(network: Network, request: DesignRequest, design: Callable[[DesignRequest], Network]) -> Network:
    """The network with further alternatives: of a winch fewer and more, pulling one way and both ways.

    Each is the result of a whole search (`design`) for the request with other counts. Kept are those whose kit would be
    made. Stopped (KeyboardInterrupt), the network has those that were found.
    """
    found, complete = [], True
    others = []
    for asked in _neighbors(request, len(network.robot.winches)):
        try:
            other = design(asked)
        except KeyboardInterrupt:
            complete = False
            break
        except HydrostatError:  # such as no room for one more motor
            continue
        others.append(other)
        if kit_fits(other):
            found.append(
                Alternative(robot=other.robot, ik_results=other.ik_results, expected_error=other.expected_error)
            )
        if not other.complete and not other.timed_out:
            complete = False
            break
    return replace(
        network,
        alternatives=(*network.alternatives, *found),
        num_evaluated=network.num_evaluated + sum(other.num_evaluated for other in others),
        seconds=network.seconds + sum(other.seconds for other in others),
        complete=network.complete and complete,
    )


def _changes(request: DesignRequest, winches: int) -> Iterator[tuple[str, DesignRequest]]:
    """Options to add, and the request with them."""
    cables = request.cables + 1
    yield f"--winches {winches + 1} --cables {cables}", replace(request, winches=winches + 1, cables=cables)
    if not request.constraints.two_way:
        yield "--two-way", replace(request, constraints=replace(request.constraints, two_way=True))


def _neighbors(request: DesignRequest, own: int) -> Iterator[DesignRequest]:
    """Requests for one winch fewer, as many and one more; both ways only where winches are fewer than poses."""
    limits = request.constraints
    for winches in range(max(1, own - 1), min(own + 1, int(COUNTS["winches"].most)) + 1):
        cables = min(request.cables + (winches > own), winches * limits.cables_per_winch)
        for two_way in (False, True):
            done = winches == own and two_way == limits.two_way
            if not done and winches <= cables and (winches < len(request.poses) or not two_way):
                constraints = replace(limits, two_way=two_way)
                yield replace(request, winches=winches, cables=cables, constraints=constraints, front=False)


CROSSING = 'drawing_gap = "0 mm" in a file for --constraints'
"""Line that allows cables across drawn shapes."""

CROSSING_LINE = 'cable_gap = "0 mm" in a file for --constraints (cables may cross)'
"""Line that allows cables to cross."""

_BETTER_RATIO = 0.85  # an error below this multiple of the network's is reported
_LARGE_ERROR = 0.01  # share of the body's size above which an error may be due to drawn shapes that cables avoid
