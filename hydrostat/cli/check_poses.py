"""`print_reached_poses`: poses of a robot, solved for a check."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hydrostat.robot import Robot

FAR_SHARE = 0.25  # share of the distance to its targets above which a pose gets a warning
_FAST_NODES = 2000  # nodes of a flat body of which each pose takes a second at most


def is_solved_fast(robot: "Robot") -> bool:
    """Return True if a check solves the poses of a robot without being asked."""
    return robot.body.mesh.dim == 2 and len(robot.body.mesh.nodes) <= _FAST_NODES


def print_reached_poses(robot: "Robot") -> tuple[str, ...]:
    """Print the error of each pose that inverse kinematics leaves; return a warning for each that stays far away.

    One search a pose is quick. A pose that stays far is solved again with the restarts of `hydrostat pose`.
    """
    from hydrostat.cli.options import pose_limits
    from hydrostat.errors import HydrostatError
    from hydrostat.ik import IKOptions, solve_ik
    from hydrostat.simulation import Simulation

    simulation, limits, once = Simulation(robot), pose_limits(robot, None, None, None), IKOptions(restarts=0)
    told, warnings = [], []
    places = {marker.name: marker.at for marker in robot.markers}
    for name, pose in robot.poses.items():
        rest = pose.mean_square_error(places) ** 0.5
        try:
            error = solve_ik(simulation, pose, limits=limits, options=once).rms_error
            if error > FAR_SHARE * rest:
                error = solve_ik(simulation, pose, limits=limits).rms_error
        except HydrostatError as problem:
            told.append(f"{name} not solved")
            warnings.append(f"pose {name}: not solved ({problem})")
            continue
        told.append(f"{name} {_millimeters(error)} mm")
        if error > FAR_SHARE * rest:
            left = f"{_millimeters(error)} of {_millimeters(rest)} mm are left"
            warnings.append(f"pose {name}: target not reached ({left}). Run hydrostat design, or move its targets")
    print(f"poses solved, rms error: {', '.join(told)}")
    return tuple(warnings)


def _millimeters(length: float) -> str:
    """Length [m] in millimeters to two digits, without an exponent."""
    return f"{float(f'{1e3 * length:.2g}'):g}"
