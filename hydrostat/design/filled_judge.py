"""`evaluate_stuffed`: finalists of a design compared on the filled body, with their cables on its skin."""

from dataclasses import replace

from hydrostat.design.filled_reach import FilledReach, filled_reach
from hydrostat.design.network import Alternative, Network, RouteTrace, size_of
from hydrostat.errors import HydrostatError
from hydrostat.fabrication import Demand, find_refusals
from hydrostat.progress import Progress

FINALISTS = 4  # so many networks are compared: the one that was found, and the first of its alternatives
GAIN = 0.95  # another network takes its place if its error on the filled body is less than this share of its own


def evaluate_stuffed(found: Network, *, progress: Progress) -> Network:
    """The network with what it reaches on the filled body; an alternative that does better there takes its place.

    Compared are alternatives with no more winches and no more cables, of which a kit can be made. Stopped
    (KeyboardInterrupt), the best of those that were looked at is returned.
    """
    first = Alternative(robot=found.robot, reached=found.reached, built=found.built)
    winches, cables = size_of(found)
    small = [one for one in found.alternatives if size_of(one)[0] <= winches and size_of(one)[1] <= cables]
    fitting = [one for one in small if not find_refusals(one.robot, Demand.of_results(one.robot, one.reached))]
    finalists = [first, *fitting[: FINALISTS - 1]]
    judged: list[tuple[Alternative, FilledReach]] = []
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
        return replace(found, filled=reach, complete=complete)
    others = (first, *(one for one in found.alternatives if one is not best))
    trace = replace(found.trace, certificate=None) if isinstance(found.trace, RouteTrace) else found.trace
    return replace(
        found,
        robot=best.robot,
        reached=best.reached,
        built=best.built,
        alternatives=others,
        trace=trace,
        filled=reach,
        complete=complete,
    )


def _reach(found: Network, one: Alternative) -> FilledReach | None:
    """Return the results of a network on the filled body; None where a pose has no equilibrium there."""
    try:
        return filled_reach(one.robot, one.reached, limits=found.constraints.limits)
    except HydrostatError:
        return None
