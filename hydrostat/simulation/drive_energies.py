"""`drive_energies`: from the drives of pins and loads to their energies."""

import numpy as np

from hydrostat.mechanics import DrivenPinEnergy, Energy, PinEnergy
from hydrostat.robot import PinDrive, Robot
from hydrostat.simulation.body_physics import BodyPhysics
from hydrostat.simulation.load_energies import driven_loads


def drive_energies(robot: Robot, body: BodyPhysics) -> list[Energy]:
    """Energies of all drives, of pins and then of loads."""
    return [*pin_drives(robot, body.pins), *driven_loads(robot, body.rest_unknowns)]


def pin_drives(robot: Robot, pins: PinEnergy) -> list[DrivenPinEnergy]:
    """Energy of all drives of pins, whose controls follow those of the winches; empty without them."""
    order = {drive.name: index for index, drive in enumerate(robot.drives)}
    owners = np.array([-1 if pin.drive is None else order[pin.drive] for pin in robot.pins], dtype=np.int64)
    terms = np.flatnonzero(owners[pins.support_of] >= 0)
    if not len(terms):
        return []
    drives, places = owners[pins.support_of[terms]], pins.targets[terms]
    first, second = np.zeros_like(places), np.zeros_like(places)
    for index, drive in enumerate(robot.drives):
        if isinstance(drive, PinDrive):
            first[drives == index], second[drives == index] = drive.directions(places[drives == index])
    turns = np.array([drive.turns for drive in robot.drives])[drives]
    controls = len(robot.winches) + drives
    return [DrivenPinEnergy(pins, terms=terms, controls=controls, directions=(first, second), turns=turns)]
