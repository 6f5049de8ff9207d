"""`find_lifts`: changes of a request that would leave a clearly smaller error, by quick searches."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from hydrostat.design.network import Network
from hydrostat.design.request import DesignRequest
from hydrostat.design.routes.quick_search import propose_routes
from hydrostat.errors import HydrostatError


@dataclass(frozen=True, kw_only=True)
class Lift:
    """A change of a request."""

    words: str  # as options of `hydrostat design`
    expected_error: float  # expected as-built error of a network that a quick search finds with it [m]


def find_lifts(network: Network) -> tuple[Lift, ...]:
    """Find changes that would leave a clearly smaller error where fewer winches than poses share contractions.

    Tried are one more winch, and winches that pull both ways. A quick search (`propose_routes`) takes as long as
    half of the whole one; that may find better. Only networks count whose kit would be made.
    """
    request = network.request
    if not isinstance(request.winches, int) or request.winches >= len(request.poses) or request.warm_start:
        return ()
    lifts = []
    for words, changed in _changes(request, request.winches):
        try:
            found = [one for one in propose_routes(network.source, changed) if one.is_refined and one.is_buildable]
        except HydrostatError:  # such as no room for one more motor
            continue
        if found and found[-1].expected_error < _CLEARLY * network.expected_error:
            lifts.append(Lift(words=words, expected_error=found[-1].expected_error))
    return tuple(lifts)


def _changes(request: DesignRequest, winches: int) -> Iterator[tuple[str, DesignRequest]]:
    """Options to add, and the request with them."""
    cables = request.cables + 1
    yield f"--winches {winches + 1} --cables {cables}", replace(request, winches=winches + 1, cables=cables)
    if not request.constraints.two_way:
        yield "--two-way", replace(request, constraints=replace(request.constraints, two_way=True))


_CLEARLY = 0.85  # an error below this multiple of the network's is reported
