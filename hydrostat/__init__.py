"""hydrostat: from a shape to a working cable-driven soft robot.

    import hydrostat as hs

    robot = hs.load_robot("examples/starfish")
    simulation = hs.Simulation(robot)
    pose = simulation.solve({"left": 0.012})

The public names below load their module when they are first used, so that `import hydrostat` stays light.
"""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package, use_later
from hydrostat.painters import register_painters
from hydrostat.version import __version__

if TYPE_CHECKING:
    from hydrostat.design import Constraints, Network, RouteOptions, TreeOptions, Uncertainty, Zone, design_cables
    from hydrostat.errors import HydrostatError, InputError, NotConvergedError
    from hydrostat.fabrication import Kit, KitOptions, PatternOptions, UnbuildableError, build_kit, export_kit
    from hydrostat.ik import (
        CentreGoal,
        Closeness,
        Effort,
        InverseOptions,
        InverseReason,
        Keyframe,
        Limits,
        MarkerGoal,
        Moves,
        Objective,
        PointGoal,
        Posture,
        ReachedPose,
        ShapeGoal,
        Term,
        Tracker,
        Trajectory,
        TrajectoryOptions,
        drawn_pose,
        new_robot,
        solve_ik,
        solve_ik_trajectory,
    )
    from hydrostat.mechanics import NewtonOptions
    from hydrostat.plot import draw_network, draw_pose, draw_reached, draw_rest
    from hydrostat.robot import (
        Cable,
        Contact,
        Marker,
        Material,
        Obstacle,
        Pin,
        Pose,
        Robot,
        Winch,
        find_material,
        load_robot,
        save_robot,
    )
    from hydrostat.robot import gallery_names as gallery
    from hydrostat.simulation import (
        Branch,
        ManyPoses,
        Motion,
        PathDependence,
        Profile,
        Simulation,
        SolvedPose,
        StepOptions,
        Touch,
        follow_branch,
        friction_band,
        path_dependence,
        touches,
    )

__all__ = [
    "Branch",
    "Cable",
    "CentreGoal",
    "Closeness",
    "Constraints",
    "Contact",
    "Effort",
    "HydrostatError",
    "InputError",
    "InverseOptions",
    "InverseReason",
    "Keyframe",
    "Kit",
    "KitOptions",
    "Limits",
    "ManyPoses",
    "Marker",
    "MarkerGoal",
    "Material",
    "Motion",
    "Moves",
    "Network",
    "NewtonOptions",
    "NotConvergedError",
    "Objective",
    "Obstacle",
    "PathDependence",
    "PatternOptions",
    "Pin",
    "PointGoal",
    "Pose",
    "Posture",
    "Profile",
    "ReachedPose",
    "Robot",
    "RouteOptions",
    "ShapeGoal",
    "Simulation",
    "SolvedPose",
    "StepOptions",
    "Term",
    "Touch",
    "Tracker",
    "Trajectory",
    "TrajectoryOptions",
    "TreeOptions",
    "UnbuildableError",
    "Uncertainty",
    "Winch",
    "Zone",
    "__version__",
    "build_kit",
    "design_cables",
    "draw_network",
    "draw_pose",
    "draw_reached",
    "draw_rest",
    "drawn_pose",
    "export_kit",
    "find_material",
    "follow_branch",
    "friction_band",
    "gallery",
    "load_robot",
    "new_robot",
    "path_dependence",
    "save_robot",
    "solve_ik",
    "solve_ik_trajectory",
    "touches",
]

open_package(__name__)
register_painters({kind: use_later("hydrostat.plot", f"draw_{kind}") for kind in ("pose", "reached", "rest")})
