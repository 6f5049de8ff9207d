"""Columns of measurements in a wrong unit, order or frame. Oracle: the faults that were made in a right table."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.identification import Measurements, identify, read_measurements
from hydrostat.identification.check_columns import check_columns
from hydrostat.identification.identified_robot import start_of
from hydrostat.identification.kinds import named_model
from hydrostat.robot import Robot, gallery_folder, load_robot
from hydrostat.simulation import Simulation

COMMANDS = 1e-3 * np.array([[0, 0, 0], [25, 0, 0], [0, 30, 0], [0, 0, 20], [20, 25, 5], [10, 0, 30], [30, 20, 10]])
"""Contractions of the winches right, left and feet [m]."""


@cache
def starfish() -> Robot:
    return load_robot(gallery_folder("starfish"))


@cache
def right_table() -> Measurements:
    """Positions of a robot with spools 5 % larger than assumed, with errors of 0.3 mm."""
    simulation = Simulation(starfish())
    places = np.array([[*simulation.solve(1.05 * command).markers.values()] for command in COMMANDS])
    places += 3e-4 * np.random.default_rng(0).standard_normal(places.shape)
    return Measurements(commands=COMMANDS, markers=tuple(one.name for one in starfish().markers), places=places)


def check(table: Measurements) -> None:
    assumed = start_of(named_model(starfish(), ()))
    check_columns(assumed, table, assumed.predict(table))


def command_change(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[Measurements], Measurements]:
    return lambda table: replace(table, commands=change(table.commands))


def place_change(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[Measurements], Measurements]:
    return lambda table: replace(table, places=change(table.places))


FAULTS = {
    "cm": (
        command_change(lambda one: 0.1 * one),
        "right, left, feet: markers move 10 times as far, as if written in cm",
    ),
    "m": (
        command_change(lambda one: 1e-3 * one),
        "right, left, feet: markers move 1000 times as far, as if written in m",
    ),
    "one in cm": (command_change(lambda one: one * [1, 0.1, 1]), "of left: markers move 10 times as far"),
    "exchanged": (command_change(lambda one: one[:, [1, 0, 2]]), "right and left: markers move as if these were exch"),
    "left out": (
        command_change(lambda one: one * [1, 1, 0]),
        r"feet: all 0, but .* by \d+ mm \(row 6\). Add .* feet_mm",
    ),
    "all left out": (
        command_change(lambda one: 0 * one),
        r"all 0, but .* moves by \d+ mm .* right_mm, left_mm, feet_mm",
    ),
    "y down": (place_change(lambda one: one * [1, -1]), "Replace y by -y in all"),
    "markers exchanged": (
        place_change(lambda one: one[:, [0, 2, 1, *range(3, one.shape[1])]]),
        r"those of right and right_foot are exchanged\. Exchange their columns",
    ),
    "axes exchanged": (place_change(lambda one: one[..., ::-1]), "Replace x by y and y by x in all"),
    "rows shifted": (place_change(lambda one: np.roll(one, 1, axis=0)), "row 1 fit the positions of row 2"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_wrong_table_is_named_in_one_line(name: str) -> None:
    change, words = FAULTS[name]
    with pytest.raises(InputError) as caught:
        check(change(right_table()))
    assert re.search(words, str(caught.value))
    assert "\n" not in str(caught.value)


def test_a_right_table_passes() -> None:
    """A robot that is much softer than assumed, and markers that are misread, are no faults of columns."""
    check(right_table())
    misread = right_table().places.copy()
    misread[3, 0], misread[5] = np.nan, np.nan
    misread[4, :2] = misread[4, 1::-1]
    check(replace(right_table(), places=misread))


@pytest.mark.parametrize("turn", [[[0, -1], [1, 0]], [[-1, 0], [0, -1]]])
def test_a_turned_frame_is_left_to_a_fit_of_the_frame(turn: list[list[int]]) -> None:
    """Oracle: the rotation; a mirror image is no rotation."""
    table = replace(right_table(), places=right_table().places @ np.array(turn))
    assumed = start_of(named_model(starfish(), ("frame",)))
    check_columns(assumed, table, assumed.predict(table))
    with pytest.raises(InputError, match="in all markers, or add frame to --fit"):
        check(table)
    mirrored = replace(right_table(), places=right_table().places * [1, -1])
    with pytest.raises(InputError, match="Replace y by -y in all markers\\."):
        check_columns(assumed, mirrored, assumed.predict(mirrored))


def test_hung_masses_alone_are_no_fault() -> None:
    """Oracle: the robot 60 % softer than assumed, pulled by masses, whose markers move by 4 % of the body and more."""
    robot = replace(starfish(), gravity=(0.0, -9.81))
    markers = tuple(one.name for one in robot.markers)
    masses = 0.15 * np.eye(3, len(markers))
    commands = np.zeros((3, 3))
    nothing = np.zeros((3, len(markers), 2))
    table = Measurements(commands=commands, markers=markers, places=nothing, masses=masses)
    assumed, soft = (start_of(named_model(each, ())) for each in (robot, robot.with_material(young=12e3)))
    table = replace(table, places=soft.predict(table))
    away = np.linalg.norm(assumed.predict(table) - table.places, axis=2)
    assert away.max() > 0.04 * robot.body.mesh.size
    check_columns(assumed, table, assumed.predict(table))


def test_identify_refuses_before_it_fits() -> None:
    table = replace(right_table(), commands=0.1 * COMMANDS)
    fits = []
    with pytest.raises(InputError, match="written in cm"):
        identify(starfish(), table, fit="gain", progress=lambda *given: fits.append(given))
    assert not fits


@pytest.mark.parametrize(("contraction", "is_refused"), [("500", False), ("20000", True)])
def test_contractions_far_beyond_the_travel_are_refused(tmp_path: Path, contraction: str, is_refused: bool) -> None:
    """Oracle: ten times the travel of the winch, 60 mm."""
    file = tmp_path / "measured.csv"
    file.write_text(f"right_mm,right_x_mm,right_y_mm\n0,128,41\n{contraction},100,50\n")
    if is_refused:
        with pytest.raises(InputError, match=r"line 3, column right_mm: 20000 mm, but the travel of right is \d+ mm"):
            read_measurements(file, starfish())
    else:
        assert len(read_measurements(file, starfish()).commands) == 2
