"""A learned model on the command line: to be read for a robot, and to begin from."""

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hydrostat.learning import LearnedModel
    from hydrostat.robot import PoseTarget, Robot
    from hydrostat.simulation import Equilibrium, Simulation


def read_model(path: Path, robot: "Robot") -> "tuple[LearnedModel, Robot]":
    """A model, and the robot, with contact if the model was trained with it (InputError: another robot's model)."""
    from hydrostat.learning import LearnedModel
    from hydrostat.robot import Contact

    model = LearnedModel.load(path)
    silent = model.card.contact and robot.contact is None
    robot = replace(robot, contact=Contact()) if silent else robot
    model.check(robot)
    if silent:
        print("note: model was trained with contact; self-contact enabled")
    return model, robot


def learned_start(simulation: "Simulation", model: "LearnedModel", target: "PoseTarget") -> "Equilibrium | None":
    """The pose that a model's answer leads to, and a line about it; None where that is no equilibrium."""
    from hydrostat.learning import verify

    found = verify(simulation, model, model.solve(target))
    expected = _root_mean_square(found.errors)
    words = f"model predicts rms error {1e3 * expected:.2f} mm, uncertainty {1e3 * found.uncertainty:.2f} mm"
    if found.certified is None:
        print(f"{target.name}: {words}; simulator: {found.status}")
        return None
    print(f"{target.name}: {words}; simulated rms error {1e3 * _root_mean_square(found.certified):.2f} mm")
    return found.pose


def _root_mean_square(errors: "Mapping[str, float]") -> float:
    """Root mean square of distances from targets [m], the same measure as in all other printed results of a pose."""
    return math.sqrt(sum(error**2 for error in errors.values()) / len(errors))
