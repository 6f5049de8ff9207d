"""Results as tables. Oracles: the results themselves, the csv module, a pandas of our own."""

import csv
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from builders import gallery_robot, strip_robot

import hydrostat as hs
from hydrostat.identification import IdentifiedRobot
from hydrostat.simulation import write_pose


@pytest.fixture(scope="module")
def simulation() -> hs.Simulation:
    return hs.Simulation(gallery_robot("starfish"))


def read(path: Path) -> dict[str, list[float]]:
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def test_poses_are_rows_of_a_file(simulation: hs.Simulation, tmp_path: Path) -> None:
    poses = [simulation.solve({"left": pull}) for pull in (0.004, 0.012)]
    columns = read(hs.ResultTable.of(poses).write_csv(tmp_path / "poses.csv"))
    assert columns["contraction_left_m"] == [0.004, 0.012]
    assert columns["marker_left_y_m"] == pytest.approx([pose.markers["left"][1] for pose in poses], rel=1e-8)
    assert columns["tension_left 1_N"] == pytest.approx([pose.tensions["left 1"] for pose in poses], rel=1e-8)
    batch = simulation.solve_batch([{"left": 0.004}, {"left": 0.012}])
    for name, values in batch.columns().items():
        assert columns[name] == pytest.approx(values, rel=1e-6, abs=1e-9)
    with pytest.raises(hs.InputError, match="at least one result"):
        hs.ResultTable.of([])


def test_inverse_kinematics_and_motions_are_tables(simulation: hs.Simulation) -> None:
    found = hs.solve_ik(simulation, {"left": (-0.103, 0.052)})
    assert found.columns()["error_left_m"] == [found.errors["left"]]
    motions = list(simulation.play(hs.ContractionProfile.ramp(np.array([0.0, 0.002, 0.0]), 0.02), 0.02, 0.01))
    table = hs.ResultTable.of(motions)
    assert table.columns()["time_s"] == pytest.approx([0.0, 0.01, 0.02])
    assert table.columns()["contraction_left_m"][-1] == pytest.approx(0.002)
    assert "3 x" in repr(table)
    assert table._repr_html_().count("<tr>") == 4


@pytest.mark.usefixtures("unchecked")  # stand-ins
def test_other_results_are_tables_for_notebooks() -> None:
    """Oracle: their own fields; a kit has a list of its contents."""
    strip = strip_robot(columns=4, rows=1)
    simulation = hs.Simulation(strip)
    pull = {"up": 0.004, "down": 0.001}
    pose = simulation.solve(pull)
    branch = hs.continue_branch(simulation, simulation.rest, pull)
    found = hs.find_equilibria(simulation, pull, count=2)
    modes, space = hs.find_modes(simulation, count=3), hs.linearize(simulation, pose, modes=2, drag=1.0)
    measured = hs.Measurements(commands=np.array([[0.004, 0.0]]), markers=("tip",), places=np.array([[[0.1, np.nan]]]))
    fitted = SimpleNamespace(values={"young": 2e4}, intervals={"young": (1e4, 3e4)})
    fit = IdentifiedRobot(
        **{**dict[str, Any].fromkeys(IdentifiedRobot.__annotations__, (0,)), "fitted": fitted, "robot": strip}
    )
    kit = hs.Kit(**{**dict[str, Any].fromkeys(hs.Kit.__annotations__, ()), "robot": strip, "summary": ("a < b",)})
    for result, name, value in (
        (branch, "contraction_up_m", 0.004),
        (found, "energy_J", pose.energy),
        (modes, "frequency_Hz", modes.frequencies[-1]),
        (space, "pole_imaginary_1/s", space.poles[-1].imag),
        (measured, "marker_tip_x_m", 0.1),
        (fit, "young_high", 3e4),
    ):
        assert result.columns()[name][-1] == pytest.approx(value)
        assert len(repr(result)) < 200
        assert result._repr_html_().startswith("<div><pre>&lt;")
    assert kit._repr_html_() == "<pre>&lt;Kit of strip: 0 files, 0 of 0 checks passed&gt;\na &lt; b</pre>"


def test_a_dataframe_needs_pandas(simulation: hs.Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(hs.InputError, match="pip install pandas"):
        simulation.rest.to_dataframe()
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=dict))  # type: ignore[arg-type]
    assert simulation.rest.to_dataframe() == simulation.rest.columns()


def test_a_solve_beyond_travel_warns_its_caller(simulation: hs.Simulation) -> None:
    with pytest.warns(hs.HydrostatWarning, match="winch left: contraction 60.1 mm is outside"):
        simulation.solve({"left": 0.0601})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        simulation.solve({"left": 0.0601}, strict=False)


def test_rooms_need_no_import_of_their_own() -> None:
    assert hs.learning.LearnOptions.__module__.startswith("hydrostat.learning")
    assert {"learning", "control", "grasp"} <= set(dir(hs))
    assert hs.check(gallery_robot("starfish")) == ()


def test_files_are_written_into_folders_named_by_text(
    simulation: hs.Simulation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, unchecked: None
) -> None:
    monkeypatch.chdir(tmp_path)
    write_pose(simulation, simulation.rest, "rest")
    assert {path.name for path in Path("rest").iterdir()} == {"pose.json", "pose.vtu", "cables.vtu"}
    hs.learning.sample_robot(hs.learning.SamplePlan(robot=simulation.robot, count=2), "samples")
    assert len(hs.learning.Samples.read("samples")) == 2
    with pytest.raises(hs.InputError, match="SamplePlan"):
        hs.learning.sample_robot(simulation.robot, "samples")  # type: ignore[arg-type]
    with pytest.raises(hs.InputError, match="given by its path"):
        write_pose(simulation, simulation.rest, 7)  # type: ignore[arg-type]
