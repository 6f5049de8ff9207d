"""`unconstrained_motion`: markers without a target that a pose moves anyway."""

import numpy as np

from hydrostat.ik.ik_result import IKResult


def unconstrained_motion(reached: IKResult) -> str:
    """Markers that the pose does not name and that go far, in words; "" if none does.

    A pose leaves free what it does not name: an arm that waves may lift a leg, if nobody asks the leg to stay.
    """
    pose, robot = reached.pose, reached.pose.robot
    named = set() if reached.target is None else set(reached.target.targets)
    moved = {
        marker.name: float(np.linalg.norm(np.subtract(pose.markers[marker.name], marker.at)))
        for marker in robot.markers
        if marker.name not in named
    }
    far = sorted(
        (name for name, way in moved.items() if way > _FAR * robot.body.mesh.size), key=lambda name: -moved[name]
    )
    if not named or not far:
        return ""
    goes = ", ".join(f"{name} by {1e3 * moved[name]:.0f} mm" for name in far[:_MOST])
    more = f" and {len(far) - _MOST} more" if len(far) > _MOST else ""
    return f"free markers move: {goes}{more}. Give them targets at rest to hold them"


_FAR = 0.1  # of the size of the body
_MOST = 3
