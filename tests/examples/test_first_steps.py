"""The tutorial script runs, and what it prints is true."""

import runpy
from pathlib import Path

import pytest

import hydrostat as hs

SCRIPT = Path(__file__).parents[2] / "examples" / "first_steps.py"


def test_first_steps_reach_the_wave(capsys: pytest.CaptureFixture[str]) -> None:
    """Oracle: the error recomputed from the markers of a fresh solve at the contractions found."""
    error = runpy.run_path(str(SCRIPT))["main"]()
    robot = hs.load_robot(SCRIPT.parent / "starfish")
    simulation = hs.Simulation(robot)
    contractions = hs.solve_ik(simulation, robot.poses["wave"]).pose.contractions
    pose = simulation.solve(contractions)
    squares = [sum((pose.markers[name] - goal) ** 2) for name, goal in robot.poses["wave"].targets.items()]
    assert error == pytest.approx(1e3 * (sum(squares) / len(squares)) ** 0.5, rel=1e-3)
    assert error < 8
    assert f"error: {error:.2f} mm rms" in capsys.readouterr().out
