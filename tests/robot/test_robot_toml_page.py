"""The page on robot.toml: its file is read, and no key is left out."""

import re
from pathlib import Path

import pytest

from hydrostat.robot import FoamTerm, Material, load_robot
from hydrostat.robot.schema import RobotTable
from hydrostat.robot.schema_errors import allowed_keys

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "robot_toml.md").read_text(encoding="utf-8")


def test_robot_toml_of_its_page_is_read(tmp_path: Path) -> None:
    """Oracle: the numbers of its lines."""
    first, driven, foam, viscous, sliding = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "starfish.svg").write_text((ROOT / "examples" / "starfish" / "starfish.svg").read_text())
    (tmp_path / "grading.csv").write_text("x_mm,y_mm,factor\n0,0,1\n0,80,2\n")
    (tmp_path / "robot.toml").write_text(first)
    robot = load_robot(tmp_path)
    assert robot.winches[0].travel == pytest.approx(0.06)
    assert [cable.name for cable in robot.cables] == ["thumb"]
    assert robot.contact is not None
    assert robot.contact.friction == 0.4
    assert robot.obstacles[0].friction == 0.6
    (tmp_path / "robot.toml").write_text(f"{first}\n{driven}")
    assert load_robot(tmp_path).drives[1].limits == (-0.5, 2.0)
    lines = first.splitlines()
    lines.remove(next(line for line in lines if line.startswith("material")))
    assert robot.sheets[0].wrinkles
    assert set(robot.body.stiffness_factors) == {1.0, 2.0}

    def read(table: str) -> Material:
        (tmp_path / "robot.toml").write_text("\n".join(lines).replace("[[pin]]", f"{table}\n[[pin]]", 1))
        return load_robot(tmp_path).body.material

    material = read(viscous)
    assert material.viscosity == 40.0
    assert len(material.relaxation) == 1
    assert read(foam).foam == (FoamTerm(share=1.0, exponent=8.0),)
    assert [slider.strain for slider in read(sliding).hysteresis] == [0.02, 0.1]


def test_every_key_of_robot_toml_is_on_its_page() -> None:
    """Oracle: the form that the reader holds a file against."""
    assert "spool_radius" in allowed_keys("cable[0]", RobotTable)
    for table in ("", *RobotTable.model_fields):
        assert [key for key in allowed_keys(table, RobotTable) if not re.search(rf"\b{key}\b", PAGE)] == [], table
