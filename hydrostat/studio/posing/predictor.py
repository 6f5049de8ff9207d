"""`Predictor`: a learned model, asked for what a person holds."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.ik import Targets, named_targets
from hydrostat.learning import LearnedModel
from hydrostat.robot import Point, Robot
from hydrostat.simulation import Equilibrium
from hydrostat.studio.posing.pose_state import HeldPoint
from hydrostat.studio.view.things import Prediction


@dataclass(frozen=True, kw_only=True)
class HeldAnswer:
    """Contractions that networks know, and what they say of the markers that are held."""

    contractions: Vector  # of each winch [m]
    error: float  # mean distance of held markers from their targets that is expected [m]
    uncertainty: float  # mean spread of the networks there [m]
    markers: Mapping[str, Point]  # where they expect each held marker [m]

    def as_prediction(self, *, exact: bool) -> Prediction:
        """Return the prediction to show, next to an answer that is exact or still being solved."""
        return Prediction(markers=self.markers, error=self.error, uncertainty=self.uncertainty, exact=exact)


class Predictor:
    """Answers for held markers, while the others shall stay where they are; it fits `hs.Tracker` as a model."""

    def __init__(self, model: LearnedModel, robot: Robot) -> None:
        """The model of a robot (InputError: it is another's)."""
        model.check(robot)
        self._model = model
        self._places = {marker.name: marker.at for marker in robot.markers}
        self._stay: Mapping[str, Point] = {}
        self._last: tuple[Mapping[str, Point], HeldAnswer] | None = None

    def check(self, robot: Robot) -> None:
        """Check that it is a model of this robot (InputError: it is another's)."""
        self._model.check(robot)

    def knows(self, held: Mapping[str, HeldPoint]) -> bool:
        """True if markers are held, and all of them are markers of the model."""
        return bool(held) and all(self._places.get(name) == point.at for name, point in held.items())

    def stay(self, pose: Equilibrium) -> None:
        """Let markers that are not held stay where they are in a pose."""
        self._stay = {name: tuple(np.asarray(place).tolist()) for name, place in pose.markers.items()}

    def solve(self, targets: Targets) -> HeldAnswer:
        """The answer for targets of held markers [m]; the same targets are asked once."""
        asked = dict(named_targets(targets))
        if self._last is None or self._last[0] != asked:
            found = self._model.solve({**self._stay, **asked})
            answer = HeldAnswer(
                contractions=found.contractions,
                error=float(np.mean([found.errors[name] for name in asked])),
                uncertainty=float(np.mean([found.spread[name] for name in asked])),
                markers={name: tuple(found.markers[name].tolist()) for name in asked},
            )
            self._last = asked, answer
        return self._last[1]
