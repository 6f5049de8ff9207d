"""`drive_energies`: from the drives of a robot to their energy."""

import numpy as np

from hydrostat.mechanics import DriveEnergy, PinEnergy
from hydrostat.robot import Robot


def drive_energies(robot: Robot, pins: PinEnergy) -> list[DriveEnergy]:
    """Energy of all drives, whose controls follow those of the winches; empty without drives."""
    order = {drive.name: index for index, drive in enumerate(robot.drives)}
    owners = np.array([-1 if pin.drive is None else order[pin.drive] for pin in robot.pins], dtype=np.int64)
    if not order:
        return []
    terms = np.flatnonzero(owners[pins.support_of] >= 0)
    drives, places = owners[pins.support_of[terms]], pins.targets[terms]
    first, second = np.zeros_like(places), np.zeros_like(places)
    for index, drive in enumerate(robot.drives):
        first[drives == index], second[drives == index] = drive.directions(places[drives == index])
    turns = np.array([drive.turns for drive in robot.drives])[drives]
    controls = len(robot.winches) + drives
    return [DriveEnergy(pins, terms=terms, controls=controls, directions=(first, second), turns=turns)]
