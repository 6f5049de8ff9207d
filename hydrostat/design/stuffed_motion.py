"""`find_stuffed_motion`: motion of the stuffed body by the contractions of a network, found once."""

from weakref import WeakKeyDictionary

from hydrostat.design.network import Network
from hydrostat.fabrication import KitOptions, Method
from hydrostat.simulation import StuffedMotion, is_stuffed_motion_fast, solve_stuffed_motion


def find_stuffed_motion(network: Network) -> StuffedMotion | None:
    """Compare the stuffed body with the flat model in the poses of a network; None where that takes long.

    Raises:
        InputError: a body too thick for its outline.
        NotConvergedError: a pose that has no equilibrium.
    """
    if network not in _FOUND:
        pulled = [reached.pose.contractions for reached in network.ik_results]
        fast = is_stuffed_motion_fast(network.robot, len(pulled))
        _FOUND[network] = solve_stuffed_motion(network.robot, pulled) if fast else None
    return _FOUND[network]


def describe_uncounted_motion(network: Network) -> str:
    """Return the motion of the stuffed body in words if it is larger than the as-built error, which leaves it out."""
    if KitOptions().method_for(network.robot.body) is not Method.PLUSH:
        return ""
    found = find_stuffed_motion(network)
    if found is None or max(found.out, found.aside) <= network.expected_error:
        return ""
    return f"{found}, at the worst marker. The as-built error does not count it. Search with --stuffed"


_FOUND: WeakKeyDictionary[Network, StuffedMotion | None] = WeakKeyDictionary()
