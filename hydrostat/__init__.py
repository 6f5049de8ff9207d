"""hydrostat: from a shape to a working cable-driven soft robot.

    import hydrostat as hs

    robot = hs.load_robot("examples/starfish")
    simulation = hs.Simulation(robot)
    pose = simulation.solve({"left": 0.012})

The public names below load their module when they are first used, so that `import hydrostat` stays light. So do the
rooms `hs.learning`, `hs.control`, `hs.grasp`, `hs.training`, `hs.export`, `hs.plot`, `hs.teleop` and `hs.testing`.
"""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package, use_later
from hydrostat.painters import register_painters
from hydrostat.version import __version__

if TYPE_CHECKING:
    from hydrostat import control as control
    from hydrostat import export as export
    from hydrostat import grasp as grasp
    from hydrostat import learning as learning
    from hydrostat import plot as plot
    from hydrostat import teleop as teleop
    from hydrostat import testing as testing
    from hydrostat import training as training
    from hydrostat.design import BuildTolerances, Constraints, Network, RouteOptions, TreeOptions, Zone, design_cables
    from hydrostat.design import review_robot as check
    from hydrostat.errors import HydrostatError, HydrostatWarning, InputError, NotConvergedError
    from hydrostat.fabrication import Kit, KitOptions, PatternOptions, UnbuildableError, build_kit, write_kit
    from hydrostat.geometry import Mesh
    from hydrostat.identification import Measurements, identify, read_measurements
    from hydrostat.ik import (
        CenterOfMassTarget,
        Effort,
        EquilibriumState,
        IKOptions,
        IKResult,
        IKStatus,
        Keyframe,
        Limits,
        MarkerTarget,
        Objective,
        PointTarget,
        PoseRegularizer,
        Residual,
        ShapeTarget,
        StateJacobian,
        Tracker,
        Trajectory,
        TrajectoryOptions,
        load_target_outline,
        new_robot,
        solve_ik,
        solve_ik_trajectory,
        solve_pulls,
    )
    from hydrostat.mechanics import Energy, NewtonOptions
    from hydrostat.plot import draw_network, draw_pose, draw_reached, draw_rest
    from hydrostat.result_table import ResultTable
    from hydrostat.robot import (
        Body,
        BodyPart,
        Cable,
        Contact,
        Load,
        LoadDrive,
        Marker,
        Material,
        Membrane,
        Obstacle,
        Pin,
        PinDrive,
        PoseTarget,
        Robot,
        Rod,
        Sensor,
        SheetSide,
        Winch,
        fit_winch_bodies,
        get_material,
        list_gallery,
        load_robot,
        save_robot,
    )
    from hydrostat.simulation import (
        BatchResult,
        Branch,
        ContactPatch,
        ContractionProfile,
        Equilibrium,
        Modes,
        Motion,
        Multistability,
        SensorReader,
        Simulation,
        StateSpace,
        StepOptions,
        continue_branch,
        find_contacts,
        find_equilibria,
        find_modes,
        friction_hysteresis,
        linearize,
        marker_compliance,
    )

__all__ = [
    "BatchResult",
    "Body",
    "BodyPart",
    "Branch",
    "BuildTolerances",
    "Cable",
    "CenterOfMassTarget",
    "Constraints",
    "Contact",
    "ContactPatch",
    "ContractionProfile",
    "Effort",
    "Energy",
    "Equilibrium",
    "EquilibriumState",
    "HydrostatError",
    "HydrostatWarning",
    "IKOptions",
    "IKResult",
    "IKStatus",
    "InputError",
    "Keyframe",
    "Kit",
    "KitOptions",
    "Limits",
    "Load",
    "LoadDrive",
    "Marker",
    "MarkerTarget",
    "Material",
    "Measurements",
    "Membrane",
    "Mesh",
    "Modes",
    "Motion",
    "Multistability",
    "Network",
    "NewtonOptions",
    "NotConvergedError",
    "Objective",
    "Obstacle",
    "PatternOptions",
    "Pin",
    "PinDrive",
    "PointTarget",
    "PoseRegularizer",
    "PoseTarget",
    "Residual",
    "ResultTable",
    "Robot",
    "Rod",
    "RouteOptions",
    "Sensor",
    "SensorReader",
    "ShapeTarget",
    "SheetSide",
    "Simulation",
    "StateJacobian",
    "StateSpace",
    "StepOptions",
    "Tracker",
    "Trajectory",
    "TrajectoryOptions",
    "TreeOptions",
    "UnbuildableError",
    "Winch",
    "Zone",
    "__version__",
    "build_kit",
    "check",
    "continue_branch",
    "design_cables",
    "draw_network",
    "draw_pose",
    "draw_reached",
    "draw_rest",
    "find_contacts",
    "find_equilibria",
    "find_modes",
    "fit_winch_bodies",
    "friction_hysteresis",
    "get_material",
    "identify",
    "linearize",
    "list_gallery",
    "load_robot",
    "load_target_outline",
    "marker_compliance",
    "new_robot",
    "read_measurements",
    "save_robot",
    "solve_ik",
    "solve_ik_trajectory",
    "solve_pulls",
    "write_kit",
]

_DRAWN = ("network", "pose", "reached", "rest", "trajectory")

open_package(__name__)
register_painters({kind: use_later("hydrostat.plot", f"draw_{kind}") for kind in _DRAWN})
register_painters({"winches": use_later("hydrostat.fabrication.winch_bodies", "winch_bodies")})
register_painters({"motor": use_later("hydrostat.fabrication.parts.motor", "check_motor")})
