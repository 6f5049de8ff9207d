"""A winch that slips in the middle of a table. Oracle: the slip that was made."""

import numpy as np
import pytest

from hydrostat.identification import Measurements, fit_model, named_model
from hydrostat.identification.find_faults import find_slip
from hydrostat.robot import gallery_folder, load_robot
from hydrostat.simulation import Simulation

COMMANDS = 1e-3 * np.array(
    [[0, 0, 0], [0, 20, 0], [25, 0, 0], [0, 0, 20], [0, 15, 30], [40, 0, 10], [30, 35, 0], [0, 25, 0], [20, 0, 0]]
)
"""Contractions of the winches right, left and feet [m]; in rows without, lost cable only hangs loose."""


@pytest.mark.slow
@pytest.mark.parametrize("slipped", [0.0, 0.006])
def test_lost_cable_shows_only_where_its_winch_contracts(slipped: float) -> None:
    robot = load_robot(gallery_folder("starfish"))
    simulation, made = Simulation(robot), COMMANDS.copy()
    made[5:, 1] -= slipped
    places = np.array([[*simulation.solve(row, strict=False).markers.values()] for row in made])
    places += 2e-4 * np.random.default_rng(0).standard_normal(places.shape)
    names = tuple(marker.name for marker in robot.markers)
    table = Measurements(commands=COMMANDS, markers=names, places=places)
    for fit in ("gain", "zero,gain,frame"):
        fitted = fit_model(named_model(robot, tuple(fit.split(","))), table, refine=False)
        slip = find_slip(fitted, table)
        if not slipped:
            assert slip is None
            continue
        assert slip is not None
        assert (slip.winch, slip.row) == ("left", 5)
        assert slip.length == pytest.approx(slipped, rel=0.4)
