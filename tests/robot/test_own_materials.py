"""A user's own materials. Oracle: the numbers that were written, and the design tolerance that they stand for."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from robot_files import GOOD, edit, load

from hydrostat.design import BuildTolerances
from hydrostat.errors import InputError
from hydrostat.robot import (
    MATERIALS,
    Material,
    PrandtlElement,
    get_material,
    load_robot,
    merged_text,
    own_materials,
    robot_hash,
    robot_text,
    save_own_material,
    save_robot,
)

FELT = Material(
    name="Gray felt",
    young=22e3,
    young_interval=(20e3, 25e3),
    poisson=0.3,
    density=40,
    hysteresis=(PrandtlElement(young=4e3, strain=0.02),),
    source="hydrostat identify, 10 rows of seen.csv",
)


@pytest.fixture(autouse=True)
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "own" / "materials.toml"
    monkeypatch.setenv("HYDROSTAT_MATERIALS", str(path))
    return path


def test_a_material_is_saved_found_and_replaced(file: Path) -> None:
    assert own_materials() == {}
    file.parent.mkdir()
    file.write_text("# mine\n")
    save_own_material(FELT)
    assert file.read_text().startswith("# mine\n")
    file.write_text(file.read_text() + "\n# kept\n")
    save_own_material(replace(FELT, name="foam 2"))
    assert list(own_materials()) == ["gray felt", "foam 2"]
    assert own_materials()["gray felt"] == FELT
    save_own_material(replace(FELT, young=23e3))
    assert own_materials()["gray felt"].young == 23e3
    assert len(own_materials()) == 2
    assert "# kept" in file.read_text()
    own = rf'did you mean "gray felt".* lists all {len(MATERIALS) + 2}, your own of {re.escape(str(file))} included'
    with pytest.raises(InputError, match=own):
        get_material("grey felt")


def test_a_robot_keeps_the_values(tmp_path: Path) -> None:
    """It is the same robot where the file is not, and the name stays in a text that is merged."""
    save_own_material(FELT)
    text = edit(GOOD, 'material = "polyester fibre"', 'material = "gray felt"  # measured')
    robot = load(tmp_path, text)
    assert robot.body.material == replace(FELT, name="", source="")
    assert robot == load(tmp_path, GOOD).with_material("gray felt")
    assert "# measured" in merged_text(text, replace(robot, name="other"))
    save_own_material(replace(FELT, young=24e3))
    saved = load_robot(save_robot(robot, tmp_path / "saved"))
    assert saved == robot
    assert 'young_interval = ["20 kPa", "25 kPa"]' in robot_text(saved)
    assert robot_hash(saved) != robot_hash(load(tmp_path, text))


def test_designs_take_the_interval(tmp_path: Path) -> None:
    """Oracle: a 95 % interval of a normal distribution has 2 x 1.96 standard deviations."""
    robot = load(tmp_path, GOOD).with_material(FELT)
    tolerances = BuildTolerances.of(robot.body)
    assert tolerances.young == pytest.approx(np.log(25 / 20) / 3.92)
    assert replace(tolerances, young=0.2) == BuildTolerances()
    assert tolerances.draw(robot, np.random.default_rng(0)).body.material.young_interval is None
    assert BuildTolerances.of(robot.with_material(young=80e3).body).young == BuildTolerances().young


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('[[material]]\nname = "a"\nyoung = "20 kPa"\npoisson = 0.3\n', 'the key "density" is missing'),
        (
            '[[material]]\nname = "a"\nyoung = "20 kPa"\nyoung_interval = ["21 kPa", "25 kPa"]\npoisson = 0.3\n'
            'density = "40 kg/m^3"\n',
            "line 4: material[0].young_interval must hold young (20000 Pa), not 21000 to 25000 Pa",
        ),
        (2 * '[[material]]\nname = "a"\nyoung = "20 kPa"\npoisson = 0.3\ndensity = "40 kg/m^3"\n', "two of this name"),
        ("[material]\n", "begin each with [[material]]"),
    ],
)
def test_wrong_files_are_named(file: Path, text: str, told: str) -> None:
    file.parent.mkdir()
    file.write_text(text)
    with pytest.raises(InputError) as error:
        own_materials()
    assert str(error.value).startswith(str(file))
    assert told in str(error.value)
    with pytest.raises(InputError):
        save_own_material(FELT)
    assert file.read_text() == text
