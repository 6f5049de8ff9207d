"""The table of materials. Oracles: physical bounds, stresses of data sheets, the page in docs/, the files of robots."""

import math
import sys
from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
import pytest
from robot_files import GOOD, edit, load

from hydrostat.cli.main import main
from hydrostat.errors import InputError
from hydrostat.robot import (
    FOAMS,
    MATERIALS,
    FoamTerm,
    Material,
    Volume,
    get_material,
    load_robot,
    robot_text,
    save_robot,
)
from hydrostat.simulation import Simulation

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("material", MATERIALS.values(), ids=lambda material: material.name)
def test_bounds(material: Material) -> None:
    """Oracle: what soft solids can be: lighter than 1.5 g/cm^3, softer than 20 MPa, with a source that has words."""
    assert 10 < material.density < 1500
    assert 1e3 < material.young < 20e6
    assert 0 <= material.poisson < 0.5
    assert material.largest_stretch is not None
    assert 1 < material.largest_stretch <= 4
    assert material.largest_squeeze is not None
    assert 0 < material.largest_squeeze < 0.9
    assert len(material.source) > 30
    assert len(material.note) > 30
    assert material.loss_factor is not None
    assert 0.01 < material.loss_factor < 1
    assert len(material.loss_source) > 20
    assert material.name == material.name.lower()
    assert not material.source.endswith(".")  # the page adds it


def test_what_saved_robots_rest_on() -> None:
    """Oracle: the numbers with which the examples were posed."""
    fibre, foam = MATERIALS["polyester fibre"], MATERIALS["flexfoam-it x"]
    assert (fibre.young, fibre.poisson, fibre.density) == (30e3, 0.3, 40)
    assert (foam.young, foam.poisson, foam.density) == (60e3, 0.3, 160)
    assert "0.531 MPa is not this foam's" in foam.note


@pytest.mark.parametrize(("name", "psi"), [("ecoflex 00-30", 10), ("dragon skin 20", 49), ("dragon skin 30", 86)])
def test_stress_of_rubbers_at_twice_their_length(name: str, psi: float) -> None:
    """Oracle: the 100 % modulus of the data sheet, 1 psi = 6.895 kPa; stress is force over the area at rest.

    The Neo-Hookean energy of the body (docs/theory/mechanics.md) at stretch 2, sideways free: slightly compressible
    at 0.49.
    """
    mu, lam = get_material(name).lame
    sideways = np.linspace(0.5, 1.0, 200_001)
    volume = 2 * sideways**2
    energy = mu / 2 * (4 + 2 * sideways**2 - 3) - mu * np.log(volume) + lam / 2 * np.log(volume) ** 2
    free = sideways[np.argmin(energy)]
    stress = mu * (2 - 1 / 2) + lam * np.log(2 * free**2) / 2
    assert stress == pytest.approx(6895 * psi, rel=0.02)


def test_lattices_scale_with_the_square_of_density() -> None:
    """Oracle: Gibson and Ashby's law for open cells."""
    solid, thin, thick = (get_material(f"tpu 85a{share}") for share in ("", " gyroid 10%", " gyroid 20%"))
    for lattice in (thin, thick):
        assert lattice.young / solid.young == pytest.approx((lattice.density / solid.density) ** 2)
    assert thick.young / thin.young == pytest.approx(4)


def test_page_is_in_step() -> None:
    """Oracle: docs/materials.md is what docs/materials.py prints."""
    spec = spec_from_file_location("docs_materials", DOCS / "materials.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    assert (DOCS / "materials.md").read_text(encoding="utf-8") == module.page()
    for name in MATERIALS:
        assert f"| {name} |" in module.page()


def test_every_name_can_stand_in_a_file(tmp_path: Path) -> None:
    """Oracle: read from robot.toml and written back, the name is still a name."""
    robot = load(tmp_path, GOOD)
    for name, material in MATERIALS.items():
        made = replace(robot, body=replace(robot.body, material=material))
        assert f'material = "{name}"' in robot_text(made)
    assert load(tmp_path, edit(GOOD, "polyester fibre", "Ecoflex 00-30")).body.material == MATERIALS["ecoflex 00-30"]


def test_rubber_can_be_simulated(tmp_path: Path) -> None:
    """Oracle: at Poisson's ratio 0.49, with patches, area is kept to 2 % while a cable bends the body."""
    robot = load(tmp_path, edit(GOOD, 'material = "polyester fibre"', 'material = "ecoflex 00-30"\nvolume = "patch"'))
    assert robot.body.volume is Volume.PATCH
    pose = Simulation(robot).solve({"left": 0.004})
    corners = pose.nodes[robot.body.mesh.elements]
    areas = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 2
    assert areas.sum() == pytest.approx(robot.body.mesh.volumes.sum(), rel=0.02)
    assert np.linalg.norm(pose.markers["tip"] - [0.025, 0]) > 1e-3


def test_unknown_name_suggests_the_nearest() -> None:
    """Oracle: a misspelled name and one that is like none."""
    with pytest.raises(InputError, match='did you mean "dragon skin 10"'):
        get_material("Dragonskin 10")
    with pytest.raises(InputError, match='unknown material "granite"; `hydrostat materials` lists all'):
        get_material("granite")


@pytest.mark.parametrize(
    ("stretch", "squeeze", "words"),
    [
        (1.0, None, "largest_stretch must be above 1"),
        (float("nan"), None, "largest_stretch must be above 1"),
        (None, 1.0, "largest_squeeze must be above 0 and below 1"),
    ],
)
def test_ranges_are_checked(stretch: float | None, squeeze: float | None, words: str) -> None:
    """Oracle: a range that cannot be is refused by its field's name."""
    with pytest.raises(InputError, match=words):
        Material(young=1e3, poisson=0.3, density=40, largest_stretch=stretch, largest_squeeze=squeeze)


def test_command(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: every name with its modulus; one of them with its source, whatever its capitals."""

    def run(*words: str) -> str:
        monkeypatch.setattr(sys, "argv", ["hydrostat", "materials", *words])
        with pytest.raises(SystemExit) as stop:
            main()
        assert stop.value.code == 0
        return capsys.readouterr().out

    table = run()
    for name in MATERIALS:
        assert name in table
    assert "1.32 MPa" in table
    one = run("Polyester Fibre")
    for words in ("30 kPa", "40 kg/m^3", "0.30", "-60 to +50 %", "assumed: loosely stuffed toy filling"):
        assert words in one


NUMBERS = '{ young = "30 kPa", poisson = 0.3, density = "40 kg/m^3", '


@pytest.mark.parametrize(
    ("material", "foam"),
    [
        ('{ name = "polyurethane foam", law = "foam" }', FOAMS["polyurethane foam"]),
        ('{ name = "polyurethane foam", law = "neo-hookean" }', MATERIALS["polyurethane foam"]),
        (
            '{ name = "flexfoam-it x", law = "foam", terms = [{ share = 1, exponent = -2 }] }',
            replace(MATERIALS["flexfoam-it x"], foam=(FoamTerm(share=1.0, exponent=-2.0),)),
        ),
        (
            NUMBERS + 'law = "foam", terms = [{ share = 0.25, exponent = 8 }, { share = 0.75, exponent = -1.5 }] }',
            Material(
                young=30e3,
                poisson=0.3,
                density=40,
                foam=(FoamTerm(share=0.25, exponent=8.0), FoamTerm(share=0.75, exponent=-1.5)),
            ),
        ),
    ],
)
def test_foam_laws_in_files(material: str, foam: Material, tmp_path: Path) -> None:
    """Oracle: what was written, read, saved and read again."""
    robot = load(tmp_path / "a", edit(GOOD, '"polyester fibre"', material))
    assert robot.body.material == foam
    save_robot(robot, tmp_path / "b")
    assert load_robot(tmp_path / "b") == robot


@pytest.mark.parametrize(
    ("material", "told"),
    [
        (
            '{ name = "ecoflex 00-30", law = "foam" }',
            '"ecoflex 00-30" has no foam law; those with one: polyester',
        ),
        (NUMBERS + 'law = "foam" }', r"terms are missing; a foam law needs them: terms = \[\{ share = 1, exponent = 8"),
        (NUMBERS + "terms = [{ share = 1, exponent = 8 }] }", 'terms are those of a foam law; write law = "foam"'),
        (NUMBERS + 'law = "foam", terms = [{ share = 0.5, exponent = 8 }] }', "their shares add up to 0.5, not to 1"),
        (
            NUMBERS + 'law = "foam", terms = [{ share = 1, exponent = 0 }] }',
            r"terms\[0\].exponent must be from -50",
        ),
        (NUMBERS + 'law = "foam", terms = [{ share = -1, exponent = 2 }] }', r"terms\[0\].share must be"),
        (
            NUMBERS.replace("0.3", "0.46") + 'law = "foam", terms = [{ share = 1, exponent = 8 }] }',
            r"poisson = 0.46 is too large for a foam law \(maximum 0.45\)",
        ),
        ('{ name = "polyurethane foam", law = "rubber" }', "law.*neo-hookean"),
        (NUMBERS + 'law = "foam", terms = [] }', "terms"),
    ],
)
def test_foam_laws_that_are_wrong(material: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told) as caught:
        load(tmp_path, edit(GOOD, '"polyester fibre"', material))
    assert "\n" not in str(caught.value)
    assert "body.material" in str(caught.value)


def test_damping_of_the_table_is_read(tmp_path: Path) -> None:
    """Oracle: in shear the loss modulus, viscosity x 2 pi f, is the loss factor times the shear modulus."""
    for text, frequency in (("material", 2), ("material at 7 Hz", 7)):
        robot = load(tmp_path, edit(GOOD, '"polyester fibre"', f'{{ name = "polyester fibre", viscosity = "{text}" }}'))
        assert robot.body.material.viscosity * 2 * math.pi * frequency == pytest.approx(0.5 * 30e3 / 2.6)
    assert 'viscosity = "131.' in robot_text(robot)
    for text, told in (
        ("material at 7 s", '"s" does not measure a frequency'),
        ("material at -1 Hz", "frequency must be"),
    ):
        with pytest.raises(InputError, match=f"material.*{told}"):
            load(tmp_path, edit(GOOD, '"polyester fibre"', f'{{ name = "polyester fibre", viscosity = "{text}" }}'))
    numbers = '{ young = "30 kPa", poisson = 0.3, density = "40 kg/m^3", viscosity = "material" }'
    with pytest.raises(InputError, match=r'body.material.viscosity: "material" is not a viscosity; write for example'):
        load(tmp_path, edit(GOOD, '"polyester fibre"', numbers))
    with pytest.raises(InputError, match="the material has no loss factor"):
        Material(young=1e4, poisson=0.3, density=40.0).with_damping(2.0)
