"""What a pose leaves free. Oracle: where the simulation puts the markers."""

import numpy as np
from builders import gallery_robot

from hydrostat.ik import IKResult, IKStatus, unconstrained_motion
from hydrostat.robot import PoseTarget
from hydrostat.simulation import Simulation


def test_markers_that_nobody_asked_for_are_told_if_they_go_far() -> None:
    """The arms "top" and "left" share a winch."""
    simulation = Simulation(gallery_robot("starfish"))
    pose = simulation.solve({"left": 0.03})
    places = {name: tuple(np.asarray(place).tolist()) for name, place in pose.markers.items()}
    way = float(np.linalg.norm(np.subtract(places["left"], simulation.rest.markers["left"])))
    assert way > 0.03

    def told(*names: str) -> str:
        target = PoseTarget(name="wave", targets={name: places[name] for name in names})
        return unconstrained_motion(
            IKResult(target=target, pose=pose, errors={}, status=IKStatus.REACHED, iterations=0, solves=0)
        )

    assert f"free markers move: left by {1e3 * way:.0f} mm. " in told("top")
    assert told(*places) == ""
