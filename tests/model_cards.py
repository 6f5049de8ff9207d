"""`model_card`: the card of a learned model of any robot, for tests without training."""

from typing import Any

from hydrostat.learning import ModelCard, SamplePlan
from hydrostat.robot import Robot


def model_card(robot: Robot, **facts: Any) -> ModelCard:
    """Return the card of a model that was trained on nothing; facts replace what it says."""
    trained = {"version": "0.1.0", "samples": 20, "lost": 0, "error": 1e-3, "displacement": 0.01, "seconds": 1.0}
    return ModelCard.from_json(
        SamplePlan.of_robot(robot, 20).facts() | trained | {"stopped": False, "options": {}} | facts
    )
