"""`hydrostat identify`. Oracle: measurements that a robot with other spools would give."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hydrostat.design import BuildTolerances, read_uncertainty
from hydrostat.robot import Material, gallery_folder, get_material, load_robot, save_own_material
from hydrostat.simulation import Simulation

Run = Callable[..., tuple[int, str, str]]


def test_spools_are_found_and_doubtful_rows_named(run: Run, tmp_path: Path) -> None:
    robot = load_robot(gallery_folder("starfish"))
    simulation, names = Simulation(robot), [marker.name for marker in robot.markers]
    gains = np.array([1.04, 1.0, 0.97])
    lines = [
        ",".join([*(f"{winch.name}_mm" for winch in robot.winches), *(f"{n}_{a}_mm" for n in names for a in "xy")])
    ]
    commands = np.array([[12.0, 20.0, 15.0], [20.0, 5.0, 30.0], [8.0, 14.0, 9.0], [25.0, 22.0, 20.0]])
    for command in commands:
        pose = simulation.solve(1e-3 * gains * command)
        places = 1e3 * np.array([pose.markers[name] for name in names])
        lines.append(",".join(f"{value:.4f}" for value in [*command, *places.ravel()]))
    table = tmp_path / "seen.csv"
    table.write_text("\n".join(lines) + "\n")
    out = tmp_path / "fitted"
    code, text, _ = run("identify", "gallery:starfish", table, "--fit", "gain", "--out", out)
    assert code == 0
    assert "warning" not in text
    fitted = load_robot(out)
    found = [one.spool_radius / old.spool_radius for one, old in zip(fitted.winches, robot.winches, strict=True)]
    assert np.abs(np.array(found) - gains).max() < 1e-4
    assert {"parameters.csv", "identified.png", "robot.toml"} <= {file.name for file in out.iterdir()}
    assert "# A plush starfish" in (out / "robot.toml").read_text()
    tolerances = read_uncertainty(out / "tolerances.toml", fitted)
    assert 0 < tolerances.spool < 1e-4  # places are rounded to 0.1 micrometers
    assert tolerances.young == BuildTolerances().young
    table.write_text("\n".join([*lines[:-1], "400" + lines[-1][lines[-1].index(",") :]]) + "\n")
    code, text, _ = run("identify", "gallery:starfish", table, "--fit", "gain", "--out", out)
    assert code == 0
    assert "contracts by 400 mm in row 4, beyond its travel of 60 mm" in text


def test_a_material_is_saved_with_its_interval(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the hidden modulus of a robot whose pulls were measured."""
    monkeypatch.setenv("HYDROSTAT_MATERIALS", str(tmp_path / "materials.toml"))
    robot = load_robot(gallery_folder("starfish"))
    hidden = Simulation(robot.with_material(young=25e3))
    table = tmp_path / "pulls.csv"
    lines = ["left_mm,left_force_n,top_x_mm,top_y_mm"]
    for pull in (10.0, 20.0, 30.0):
        pose = hidden.solve({"left": 1e-3 * pull})
        force = sum(
            tension for cable, tension in zip(robot.cables, pose.tensions, strict=True) if cable.winch == "left"
        )
        lines.append(",".join(f"{value:.4f}" for value in (pull, force, *(1e3 * pose.markers["top"]))))
    table.write_text("\n".join(lines) + "\n")
    save_own_material(Material(name="My felt", young=20e3, poisson=0.3, density=40.0))
    options = ("--fit", "young", "--out", tmp_path / "fitted")
    code, text, _ = run("identify", "gallery:starfish", table, *options, "--save-material", "my felt")
    assert code == 0, text
    assert "never contracts" not in text  # neither zeros nor gains are fitted
    low, high = get_material("my felt").young_interval or (0.0, 0.0)
    assert low < 25e3 < high
    assert load_robot(tmp_path / "fitted").body.material == get_material("my felt")
    assert f"Wrote {tmp_path / 'materials.toml'}: " in text
    assert 'Use it: material = "my felt"' in text
    assert "my felt" in run("materials")[1]
    assert "3 rows of pulls.csv" in run("materials", "my felt")[1]
    own = (tmp_path / "materials.toml").read_text()
    (tmp_path / "materials.toml").write_text(own + own.replace("my felt", "Pdms"))
    assert 'warning: your material "Pdms" is not used' in (listed := run("materials")[1])
    assert listed.lower().count("\npdms ") == 1
    assert ("the interval of Young's modulus is wide" in text) == (high > 2 * low)
    assert "my felt: " in run("check", tmp_path / "fitted")[1]
    assert 'it replaces your earlier "My felt", 20 kPa' in text
    for name, told in (
        ("PDMS", "is in the table of materials"),
        ("a/b", '--save-material: "a/b" has "/" in it'),
        ("", "--save-material: a name must not be empty"),
    ):
        code, _, errors = run("identify", "gallery:starfish", table, *options, "--save-material", name)
        assert code == 2
        assert told in errors


def test_ruler_distances_have_an_error_of_their_own(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: distances of the assumed robot, 2 mm too long in all rows."""
    robot = load_robot(starfish)
    simulation, lines = Simulation(robot), ["left_mm,top_to_left_mm"]
    for pull in (0, 15, 30):
        markers = simulation.solve({"left": 1e-3 * pull}).markers
        lines.append(f"{pull},{2 + 1e3 * np.linalg.norm(markers['top'] - markers['left']):.4f}")
    table = tmp_path / "ruler.csv"
    table.write_text("\n".join(lines) + "\n")
    code, text, _ = run("identify", starfish, table, "--fit", "gain", "--out", tmp_path / "fitted")
    assert code == 0
    assert "3 rows: rms error of distances 2.00 mm as assumed, " in text
    assert "nan" not in text
