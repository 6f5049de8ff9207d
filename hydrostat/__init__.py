"""hydrostat: from a shape to a working cable-driven soft robot.

    import hydrostat as hs

    robot = hs.load_robot("examples/starfish")
    simulation = hs.Simulation(robot)
    pose = simulation.solve({"left": 0.012})

The public names below load their module when they are first used, so that `import hydrostat` stays light.
"""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_HOMES = {
    "Cable": "robot",
    "DesignOptions": "design",
    "HydrostatError": "errors",
    "InputError": "errors",
    "InverseOptions": "ik",
    "Marker": "robot",
    "Material": "robot",
    "Network": "design",
    "NewtonOptions": "mechanics",
    "NotConvergedError": "errors",
    "PatternOptions": "fabrication",
    "Pin": "robot",
    "Pose": "robot",
    "ReachedPose": "ik",
    "Robot": "robot",
    "Simulation": "simulation",
    "SolvedPose": "simulation",
    "Winch": "robot",
    "design_cables": "design",
    "export_kit": "fabrication",
    "load_robot": "robot",
    "save_robot": "robot",
    "solve_ik": "ik",
}

__all__ = sorted([*_HOMES, "__version__"])


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'hydrostat' has no attribute '{name}'")
    return getattr(import_module(f"hydrostat.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return list(__all__)
