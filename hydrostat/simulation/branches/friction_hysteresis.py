"""`friction_hysteresis`: distance of the markers between loading and unloading."""

import numpy as np

from hydrostat.errors import InputError
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.simulation import Simulation


def friction_hysteresis(simulation: Simulation, pose: Equilibrium, *, overshoot: float = 0.1) -> dict[str, float]:
    """Distance of each marker between a pose and the one that the same contractions leave when come to from above [m].

    From the pose all winches take in a share more, and let it out again. Empty where no physics remember the way.

    Args:
        simulation: the robot's physics.
        pose: an equilibrium of it.
        overshoot: share by which all contractions grow on the way; beyond the travel of a winch too.

    Raises:
        InputError: a share that is not above 0.
        NotConvergedError: the way there or back cannot be followed.
    """
    if not overshoot > 0:
        raise InputError(f"overshoot must be a share above 0, not {overshoot:g}")
    if not simulation.assembly.has_history:
        return {}
    above = simulation.solve((1.0 + overshoot) * pose.contractions, start=pose)
    back = simulation.solve(pose.contractions, start=above)
    return {name: float(np.linalg.norm(back.markers[name] - place)) for name, place in pose.markers.items()}
