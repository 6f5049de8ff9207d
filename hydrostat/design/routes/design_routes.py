"""`design_routes`: routes priced by the pose error, added one by one, and moved to where it is least."""

from collections.abc import Sequence

from hydrostat.design.constraints import Constraints
from hydrostat.design.network import Network
from hydrostat.design.progress import Progress
from hydrostat.design.route_options import RouteOptions
from hydrostat.robot import Pose, Robot


def design_routes(
    robot: Robot,
    poses: Sequence[Pose],
    *,
    winches: int,
    cables: int,
    constraints: Constraints,
    options: RouteOptions,
    progress: Progress,
) -> Network:
    """Routes."""
    raise NotImplementedError
