"""Small robot folders: a rectangle 60 x 40 mm, centered, of few elements."""

import sys
from pathlib import Path

import pytest

from hydrostat import geometry
from hydrostat.errors import InputError
from hydrostat.robot import Robot, load_robot

SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">{}</svg>'
RECTANGLE = SVG.format('<rect width="60" height="40"/>')

GOOD = """\
# A robot that is good in every line.
format = 1
name = "small"

[body]
outline = "body.svg"
element_size = "12 mm"
thickness = "20 mm"
material = "polyester fibre"

[[pin]]
at = [-20, 0]
radius = 12

[[winch]]
name = "left"
at = [-20, 5]
spool_radius = "3 mm"
travel = "20 mm"

[[winch]]
name = "right"
at = [-20, -5]
spool_radius = "3 mm"
travel = "20 mm"

[[cable]]
winch = "left"
points = [[-20, 5], [0, 10], [20, 10]]

[[cable]]
winch = "right"
points = [
  [-20, -5],
  [20, -10],
]

[[marker]]
name = "tip"
at = [25, 0]

[[pose]]
name = "wave"
[pose.targets]
tip = [20, 10]
"""

MAXIMAL = """\
format = 1
name = "größtes Tier 2.0_a-b"
length_unit = "{unit}"
gravity = ["0.3 m/s^2", "-981 cm/s^2"]

[body]
outline = "body.svg"
size = "0.06 m"
element_size = "12 mm"
thickness = "2.05 cm"
volume = "patch"

[body.material]
young = "31.7 kPa"
poisson = 0.35
density = "0.0411 g/cm^3"
viscosity = "12.3 Pa.s"
relaxation = [{{ modulus = "1.7 kPa", time = "30 ms" }}, {{ modulus = "450 Pa", time = "0.5 min" }}]

[[pin]]
at = [{a}, 0]
radius = {b}

[[pin]]
at = [{a}, {b}]
radius = {b}
stiffness = "12.3 N/mm"

[[pin]]
box = [[{c}, -{b}], [{a}, {b}]]
stiffness = "3e4 N/m"

[[winch]]
name = "in the body"
at = [{a}, {b}]
spool_radius = "0.3 cm"
travel = "0.02 m"
release = "1.3 mm"
mount = "body"

[[winch]]
name = "世界"
at = [-9, 0.7]
mount = "world"

[[cable]]
winch = "in the body"
points = [[{a}, {b}], [0, {b}], [0.1, -{b}], [0.2, {b}]]
stiffness = "4.4 kN/m"
smoothing = "0.7 mm"
slack = "2 mm"
sheathed = [[0, 1], [2, 3]]
friction = 0.15
spool_radius = "4.5 mm"

[[cable]]
winch = "世界"
points = [[-9, 0.7], [{a}, {b}], [0, 0]]

[[marker]]
name = "tip"
at = [0.3, -0.0]

[[marker]]
name = "हाथ"
at = [0.3, {b}]

[[pose]]
name = "wave"
targets = {{ tip = [0.4, 9], "हाथ" = [-1e-3, 1e3] }}

[[pose]]
name = "rest"
targets = {{ tip = [0.3, 0] }}
"""

MAXIMAL_IN = {
    "mm": MAXIMAL.format(unit="mm", a=-20, b=10.1, c=-29.9),
    "cm": MAXIMAL.format(unit="cm", a=-2, b=1.01, c=-2.99),
    "in": MAXIMAL.format(unit="in", a=-0.8, b=0.35, c=-1.15),
}


def mesh_once(patch: pytest.MonkeyPatch) -> None:
    """From now on the same outline and size are meshed once: that a mesh is the same again is tested elsewhere."""
    mesh, kept = geometry.triangulate, {}  # loads its module
    module = sys.modules[mesh.__module__]

    def once(outline, element_size):
        key = (outline.exterior.tobytes(), element_size)
        kept[key] = kept.get(key) or mesh(outline, element_size)
        return kept[key]

    patch.setattr(module, "triangulate", once)


def robot_folder(folder: Path, text: str | bytes = GOOD, *, svg: str = RECTANGLE) -> Path:
    """A folder with this robot.toml and the rectangle."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "body.svg").write_text(svg, encoding="utf-8")
    (folder / "robot.toml").write_bytes(text if isinstance(text, bytes) else text.encode())
    return folder


def load(folder: Path, text: str | bytes = GOOD, *, svg: str = RECTANGLE) -> Robot:
    return load_robot(robot_folder(folder, text, svg=svg))


def edit(text: str, old: str, new: str) -> str:
    """The text with the first `old` made `new`."""
    assert old in text
    return text.replace(old, new, 1)


def refusal(folder: Path, text: str | bytes, *, svg: str = RECTANGLE) -> str:
    """The one line with which a robot is refused, without the name of its folder."""
    try:
        load(folder, text, svg=svg)
    except InputError as error:
        message = str(error)
    else:
        raise AssertionError("it was accepted")
    assert message.isprintable()
    assert message.startswith(f"{folder}/robot.toml")
    assert len(message) < 500 + len(str(folder))
    return message.removeprefix(f"{folder}/")
