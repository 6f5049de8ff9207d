"""`identified_tolerances`: standard deviations of what measurements show of a robot, for its next design."""

import numpy as np

from hydrostat.identification.identified_robot import IdentifiedRobot

FIELDS = {"stiffness": "stiffness", "gain": "spool"}
"""Field of `design.BuildTolerances` for each kind of parameter whose logarithm is fitted."""


def identified_tolerances(found: IdentifiedRobot) -> bytes:
    """Text of a file of constraints whose table [tolerances] holds the intervals of the fit.

    A field is the largest standard deviation of its parameters that the measurements show. Fields of others are left
    out, so that the usual tolerances hold. Pins are left out as well: a design does not depend on them. Young's modulus
    has its interval in the material of the fitted robot.
    """
    fitted, deviations, friction = found.fitted, dict[str, float](), ""
    widths = np.sqrt(np.diag(fitted.interval_covariance)).tolist()
    for parameter, width in zip(fitted.model.parameters, widths, strict=True):
        if parameter.name in found.unknown:
            continue
        kind = parameter.name.rpartition(".")[2]
        if parameter.name == "friction":
            low, high = (min(max(each, 0.0), 1.0) for each in fitted.intervals["friction"])
            friction = f"friction = [{low:.3g}, {high:.3g}]"
        elif kind in FIELDS and parameter.log:
            deviation = parameter.spread * width
            deviations[FIELDS[kind]] = max(deviations.get(FIELDS[kind], 0.0), deviation)
    lines = [f"{field} = {deviation:.3g}" for field, deviation in deviations.items()]
    lines += [friction] if friction else []
    head = "# Build tolerances of the fitted robot, by hydrostat identify. hydrostat design reads them."
    return "\n".join([head, "[tolerances]", *lines, ""]).encode()
