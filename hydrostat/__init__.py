"""hydrostat: from a shape to a working cable-driven soft robot.

    import hydrostat as hs

    robot = hs.load_robot("examples/starfish")
    simulation = hs.Simulation(robot)
    pose = simulation.solve({"left": 0.012})

The public names below load their module when they are first used, so that `import hydrostat` stays light.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

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

__version__ = "0.1.0"

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

_HOMES = {
    "Branch": "simulation",
    "Cable": "robot",
    "CentreGoal": "ik",
    "Closeness": "ik",
    "Constraints": "design",
    "Effort": "ik",
    "HydrostatError": "errors",
    "InputError": "errors",
    "InverseOptions": "ik",
    "InverseReason": "ik",
    "Keyframe": "ik",
    "Kit": "fabrication",
    "KitOptions": "fabrication",
    "Limits": "ik",
    "Marker": "robot",
    "MarkerGoal": "ik",
    "Material": "robot",
    "ManyPoses": "simulation",
    "Motion": "simulation",
    "Moves": "ik",
    "Network": "design",
    "NewtonOptions": "mechanics",
    "NotConvergedError": "errors",
    "Objective": "ik",
    "PathDependence": "simulation",
    "PatternOptions": "fabrication",
    "Pin": "robot",
    "PointGoal": "ik",
    "Pose": "robot",
    "Posture": "ik",
    "Profile": "simulation",
    "ReachedPose": "ik",
    "Robot": "robot",
    "RouteOptions": "design",
    "ShapeGoal": "ik",
    "Simulation": "simulation",
    "SolvedPose": "simulation",
    "StepOptions": "simulation",
    "Term": "ik",
    "Touch": "simulation",
    "Tracker": "ik",
    "Trajectory": "ik",
    "TrajectoryOptions": "ik",
    "TreeOptions": "design",
    "UnbuildableError": "fabrication",
    "Contact": "robot",
    "Obstacle": "robot",
    "Winch": "robot",
    "Uncertainty": "design",
    "Zone": "design",
    "build_kit": "fabrication",
    "design_cables": "design",
    "draw_network": "plot",
    "draw_pose": "plot",
    "draw_reached": "plot",
    "draw_rest": "plot",
    "drawn_pose": "ik",
    "export_kit": "fabrication",
    "find_material": "robot",
    "follow_branch": "simulation",
    "friction_band": "simulation",
    "gallery": "robot",
    "load_robot": "robot",
    "new_robot": "ik",
    "path_dependence": "simulation",
    "save_robot": "robot",
    "solve_ik": "ik",
    "solve_ik_trajectory": "ik",
    "touches": "simulation",
}

_OWN_NAMES = {"gallery": "gallery_names"}
"""What is called otherwise within the package."""


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'hydrostat' has no attribute '{name}'")
    return getattr(import_module(f"hydrostat.{_HOMES[name]}"), _OWN_NAMES.get(name, name))


def __dir__() -> list[str]:
    return list(__all__)
