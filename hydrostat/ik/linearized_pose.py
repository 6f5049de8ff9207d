"""`LinearizedPose`: contractions for targets that have just moved, before the next update of a `Tracker` is done."""
# Of the thesis (docs/thesis.md): R34

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.ik.ik_result import IKResult
from hydrostat.ik.search.linear_model import LinearModel
from hydrostat.ik.search.problem import effort_weight


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearizedPose:
    """First-order model of the poses around an equilibrium, small enough to be sent to another process.

    It answers in half a millisecond, knows slack and taut cables, and keeps within limits and the radius that the
    tracker trusts. Its answer is no solved pose: the next update of the tracker begins at the old one, and mends it.

    Attributes:
        model: linear model at the pose.
        targets: marker targets that the model was made for [m]; they are the first rows of its residual.
        worth: residual that the tension of each cable is worth at weight 1 [m/N].
        size: size of the body [m].
        effort: maximum weight of the effort, as in `IKOptions`.
        radius: maximum step, as a share of each range.
        spread: matrix from channels to winches: 1 where a winch follows a channel.
    """

    model: LinearModel
    targets: Mapping[str, Point]
    worth: Vector
    size: float
    effort: float
    radius: float
    spread: Float[np.ndarray, "winches channels"]

    def towards(self, targets: Mapping[str, Point]) -> Vector:
        """Contractions of the winches [m] towards targets of the same markers [m] (InputError: other markers)."""
        if targets.keys() != self.targets.keys():
            raise InputError(f"targets must be of the markers of the last update: {', '.join(self.targets)}")
        moved = np.concatenate([np.subtract(self.targets[name], targets[name]) for name in self.targets])
        residual = self.model.residual.copy()
        residual[: len(moved)] += moved
        model, weight = self.model.with_residual(residual), effort_weight(residual, self.size, self.effort)
        return self.spread @ model.apply_step(model.best(weight * self.worth, self.radius)[0])


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
    most = 3
    goes = ", ".join(f"{name} by {1e3 * moved[name]:.0f} mm" for name in far[:most])
    more = f" and {len(far) - most} more" if len(far) > most else ""
    return f"free markers move: {goes}{more}. Give them targets at rest to hold them"


_FAR = 0.1  # of the size of the body
