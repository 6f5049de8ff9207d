"""What load_robot refuses, and how it says so. The oracle is the message: file, line, key, value, what is allowed."""

import os
from pathlib import Path

import meshio
import numpy as np
import pytest
from robot_files import GOOD, RECTANGLE, SVG, edit, load, refusal, robot_folder

from hydrostat.errors import InputError
from hydrostat.robot import load_robot

LINES = [
    # outline and its files
    ('outline = "body.svg"', 'outline = "gone.svg"', 'line 6: body.outline: file "gone.svg" not found next to'),
    ('"body.svg"', '"../body.svg"', 'line 6: body.outline: "../body.svg" must be the plain name of a file beside'),
    ('"body.svg"', '"/etc/passwd"', 'line 6: body.outline: "/etc/passwd" must be the plain name'),
    ('"body.svg"', '"a\\\\b.svg"', 'line 6: body.outline: "a\\b.svg" must be the plain name'),
    ('"body.svg"', '".."', 'line 6: body.outline: ".." must be the plain name'),
    ('"body.svg"', '"robot.toml"', 'line 6: body.outline: "robot.toml" must be the plain name'),
    ('"body.svg"', '"a\\u0000b"', 'line 6: body.outline: "a\\x00b" must be the plain name'),
    ('"body.svg"', f'"{"語" * 199}"', "line 6: body.outline: file "),
    ('"body.svg"', f'"{"x" * 201}"', "line 6: body.outline: ", "at most 200 characters"),
    ('outline = "body.svg"', 'outline = ""', "line 6: body.outline: must not be empty"),
    ('outline = "body.svg"\n', "", "line 5: body: give one of outline (a drawing), surface (a scan"),
    ('outline = "body.svg"', 'outline = "body.svg"\nmesh = "body.svg"', "line 5: body: give one of outline"),
    ('outline = "body.svg"', 'mesh = "body.svg"', "line 7: body.element_size: a ready mesh has its own"),
    ('outline = "body.svg"', 'surface = "hand.stl"', 'line 6: body.surface: file "hand.stl" not found'),
    # keys
    ("format = 1", "format = 2", "line 2: format: 2 is not known; this version reads format = 1"),
    ("format = 1", 'format = "1"', 'line 2: format: "1" is not known'),
    ("format = 1", "format = true", "line 2: format: true is not known"),
    ("format = 1", "format = 1.0", "line 2: format: 1.0 is not known"),
    ("format = 1", "format = 0x" + 5000 * "f", "line 2: format: a huge number is not known"),
    ("format = 1\n", "", 'robot.toml: format: the key "format" is missing; write format = 1'),
    ('name = "small"\n', "", 'robot.toml: name: the key "name" is missing; write name = "left"'),
    ("format = 1", "format = 1\nfromat = 1", 'line 3: fromat: unknown key "fromat", did you mean format? allowed here'),
    (
        "[body]",
        "[body]\ncolour = 1",
        'line 6: body.colour: unknown key "colour"; allowed here are: outline, surface, mesh',
    ),
    ("[body]", "[boddy]", 'line 5: boddy: unknown key "boddy", did you mean body? allowed here are: format, name'),
    ("radius = 12", "radios = 12", 'line 13: pin[0].radios: unknown key "radios", did you mean radius?'),
    ("travel", "strength", 'line 19: winch[0].strength: unknown key "strength"; allowed here are: name, at, spool_'),
    ("points =", "pionts =", 'line 29: cable[0].pionts: unknown key "pionts", did you mean points?'),
    (
        'winch = "right"',
        'winch = "right"\nfriction = 2.1',
        "line 33: cable[1].friction must be at least 0 and at most 2",
    ),
    ('"tip"', '"tip"\nsize = 2', 'line 40: marker[0].size: unknown key "size"; allowed here are: name, at'),
    ('"wave"', '"wave"\ngoal = 2', 'line 44: pose[0].goal: unknown key "goal"; allowed here are: name, targets'),
    ("[body]", '["bo\\ndy"]', 'unknown key "bo\\ndy"'),
    ('"polyester fibre"', '{ young = "1 kPa", poison = 0.3 }', "line 9: body.material", "did you mean poisson?"),
    ('"polyester fibre"', '{ young = "1 kPa", poisson = 0.3 }', "line 9: body.material.density: the key", "is missing"),
    ('thickness = "20 mm"\n', "", 'line 5: body: the key "thickness" is missing; a flat body needs it: thickness ='),
    ('element_size = "12 mm"\n', "", 'line 5: body: the key "element_size" is missing; a flat body needs it'),
    ("at = [-20, 5]\n", "", 'line 15: winch[0].at: the key "at" is missing; write at = [0, 0]'),
    ('winch = "left"\n', "", 'line 27: cable[0].winch: the key "winch" is missing'),
    # units
    ('"12 mm"', '"12 zorks"', 'line 7: body.element_size: unknown unit "zorks"; write a length for example as "12 mm"'),
    ('"12 mm"', '"12 kPa"', 'line 7: body.element_size: "kPa" does not measure a length'),
    ('"12 mm"', '"12 m^9^9^9"', 'line 7: body.element_size: unknown unit "m^9^9^9"'),
    ('"12 mm"', '"12"', 'line 7: body.element_size: "12" has no unit; write for example "12 mm"'),
    ('"12 mm"', "12", 'line 7: body.element_size: 12 has no unit; write a length as text: "12 mm"'),
    ('"12 mm"', '"big"', 'line 7: body.element_size: "big" is not a length'),
    ('"12 mm"', "[12]", "line 7: body.element_size: a list has no unit"),
    ('"12 mm"', '"1e999 mm"', 'line 7: body.element_size: "1e999 mm" is too large'),
    ('"12 mm"', '"1e300 m"', 'line 7: body.element_size: "1e300 m" is too large'),
    ('"12 mm"', '"nan mm"', 'line 7: body.element_size: "nan mm" is not a length'),
    ('"12 mm"', f'"{"1" * 9999} mm"', "line 7: body.element_size:", "is not a length"),
    ("format = 1", 'format = 1\nlength_unit = "kg"', 'line 3: length_unit: "kg" does not measure a length'),
    ("format = 1", 'format = 1\nlength_unit = "5 mm"', 'line 3: length_unit: unknown unit "5 mm"'),
    # numbers
    ('"12 mm"', '"0 mm"', "line 7: body.element_size must be finite and above 0, not 0 m"),
    ('"12 mm"', '"-12 mm"', "line 7: body.element_size must be finite and above 0, not -0.012 m"),
    (
        '"12 mm"',
        '"90 mm"',
        "line 7: body.element_size: elements of 90 mm are too large for a body of 60 mm: take 24 mm",
    ),
    ('"12 mm"', '"1 um"', "line 7: body.element_size: elements of 0.001 mm would be", "mm or more"),
    ('"20 mm"', '"-20 mm"', "line 8: body.thickness must be finite and above 0, not -0.02 m"),
    ("[body]", '[body]\nsize = "0 mm"', "line 6: body.size must be finite and above 0, not 0 m"),
    ("[body]", '[body]\nsize = "1e-300 mm"', "robot.toml, line "),
    ("[body]", '[body]\nsize = "1e11 m"', "line 8: body.element_size: elements of 12 mm would be"),
    (
        '"polyester fibre"',
        '"steel"',
        'line 9: body.material: unknown material "steel"; `hydrostat materials` lists',
    ),
    ('"polyester fibre"', "5", "line 9: body.material: 5 is not text"),
    (
        '"polyester fibre"',
        '{ young = "1 kPa", poisson = 0.5, density = "9 kg/m^3" }',
        "line 9: body.material.poisson must",
    ),
    (
        '"polyester fibre"',
        '{ young = "-1 kPa", poisson = 0.3, density = "9 kg/m^3" }',
        ".young must",
        "above 0, not -1000",
    ),
    ('"polyester fibre"', '{ young = "1 kPa", poisson = 0.3, density = "0 kg/m^3" }', "material.density must", "not 0"),
    ('"polyester fibre"', '{ young = "1 kPa", poisson = nan, density = "9 kg/m^3" }', "poisson: NaN is not a finite"),
    ("radius = 12", "radius = -1", "line 13: pin[0].radius must be finite and not negative, not -0.001 m"),
    ("radius = 12", 'radius = "12 mm"', 'line 13: pin[0].radius: "12 mm" is not a number'),
    ("radius = 12", 'radius = 12\nstiffness = "0 N/m"', "line 14: pin[0].stiffness must be finite and above 0, not 0"),
    ("at = [-20, 5]", "at = [nan, 5]", "line 17: winch[0].at[0]: NaN is not a finite number"),
    ("at = [-20, 5]", "at = [-inf, 5]", "line 17: winch[0].at[0]: -Infinity is not a finite number"),
    ("at = [-20, 5]", "at = [-20, 1e300]", "line 17: winch[0].at[1]: 1E+300 is too large; write a number between"),
    ("at = [-20, 5]", f"at = [-20, 1{400 * '0'}]", "line 17: winch[0].at[1]: a huge number is too large"),
    (
        "at = [-20, 5]",
        f"at = [-20, 1{5000 * '0'}]",
        "not TOML of a robot: a number is too large or has too many digits",
    ),
    ("at = [-20, 5]", "at = [-20, 1e99999999999999999999]", "a number is too large or has too many digits"),
    ("at = [-20, 5]", 'at = [-20, "5"]', 'line 17: winch[0].at[1]: "5" is not a number'),
    ("at = [-20, 5]", "at = [-20, true]", "line 17: winch[0].at[1]: true is not a number"),
    ("at = [-20, 5]", "at = [-20, 1979-05-27]", "line 17: winch[0].at[1]: 1979-05-27 is not a number"),
    ("at = [-20, 5]", "at = [-20]", "line 17: winch[0].at: has 1 entries, at least 2 are needed"),
    ("at = [-20, 5]", "at = [-20, 5, 0, 0]", "line 17: winch[0].at: has more than 3 entries"),
    ("at = [-20, 5]", "at = [-20, 5, 0]", "line 17: winch[0].at has 3 coordinates, but the body has 2"),
    ("at = [-20, 5]", "at = 5", "line 17: winch[0].at: 5 is not a list; write for example at = [0, 0]"),
    ("[0, 10]", "[0, 10, 1]", "line 29: cable[0].points[1] has 3 coordinates, but points[0] has 2"),
    ('travel = "20 mm"', 'travel = "-2 mm"', "line 19: winch[0].travel must be finite and above 0, not -0.002 m"),
    ('travel = "20 mm"', 'mount = "wall"', 'line 19: winch[0].mount: "wall" is not known; allowed are: body or world'),
    ('travel = "20 mm"', 'release = "-1 mm"', "line 19: winch[0].release must be finite and not negative, not -0.001"),
    ('winch = "left"', 'winch = "left"\nslack = "-1 m"', "line 29: cable[0].slack must be finite and not negative"),
    ('winch = "left"', 'winch = "left"\nsmoothing = "0 m"', "line 29: cable[0].smoothing must be finite and above 0"),
    ('winch = "left"', 'winch = "left"\nsheathed = [[0, 1.0]]', "cable[0].sheathed[0][1]: 1.0 is not a whole number"),
    (
        'winch = "left"',
        'winch = "left"\nsheathed = [[1, 0]]',
        "line 29: cable[0].sheathed = [1, 0] must be two",
        "0 to 2",
    ),
    ('winch = "left"', 'winch = "left"\nsheathed = [[0]]', "line 29: cable[0].sheathed[0]: has 1 entries"),
    (
        'winch = "left"',
        'winch = "left"\nsheathed = [[0, 2]]',
        "line 29: cable[0].sheathed: the whole cable is sheathed",
    ),
    (
        'winch = "left"',
        'winch = "left"\nspool_radius = "0 mm"',
        "line 29: cable[0].spool_radius must be finite and above 0, not 0 m",
    ),
    (
        'winch = "left"',
        'winch = "left"\nspool_radius = 4',
        "line 29: cable[0].spool_radius: 4 has no unit",
    ),
    (
        'winch = "left"',
        'winch = "left"\nspool_radius = "12.1 mm"',
        "line 29: cable[0].spool_radius must be from 0.75 mm to 12 mm, at most 4 times smaller or larger than that of "
        'winch "left", not 12.1 mm',
    ),
    (
        'winch = "left"',
        'winch = "left"\nspool_radius = "0.74 mm"',
        "line 29: cable[0].spool_radius must be from 0.75 mm to 12 mm",
    ),
    # gravity, viscosity, relaxation, volume, friction
    (
        "format = 1",
        'format = 1\ngravity = "down"',
        'line 3: gravity: "down" is no direction; allowed are: -x, +x, -y, +y, -z, +z; or an acc',
    ),
    (
        "format = 1",
        'format = 1\ngravity = "-z"',
        'line 3: gravity: "-z" is no direction of this body; allowed are: -x, +x, -y, +y',
    ),
    (
        "format = 1",
        "format = 1\ngravity = 5",
        'line 3: gravity: 5 is not a list; write for example gravity = ["0 m/s^2", "-9.81 m/s^2"]',
    ),
    ("format = 1", "format = 1\ngravity = { y = 1 }", "line 3: gravity: a table is not a list; write"),
    ("format = 1", 'format = 1\ngravity = ["0 m/s^2"]', "line 3: gravity: has 1 entries, at least 2"),
    (
        "format = 1",
        'format = 1\ngravity = ["0 m/s^2", "1 m/s^2", "0 m/s^2"]',
        "line 3: gravity has 3 entries, but the body has 2 axes; give one for each",
    ),
    (
        "format = 1",
        "format = 1\ngravity = [0, -9.81]",
        'line 3: gravity[0]: 0 has no unit; write an acceleration as text: "9.81 m/s^2"',
    ),
    (
        "format = 1",
        'format = 1\ngravity = ["0 m/s^2", "9.81 kg"]',
        'line 3: gravity[1]: "kg" does not measure an acceleration',
    ),
    (
        "format = 1",
        'format = 1\ngravity = ["0 m/s^2", "-1000.1 m/s^2"]',
        "line 3: gravity[1] must be from -1000 to 1000 m/s^2, not -1000.1 m/s^2",
    ),
    ("[body]", '[body]\ngravity = "-y"', "line 6: body.gravity: gravity stands at the top of the file, before [body]"),
    (
        "[body]",
        '[body]\nviscosity = "9 Pa s"',
        "line 6: body.viscosity: it belongs to the material; write material = {",
    ),
    (
        '"polyester fibre"',
        '{ name = "steel", viscosity = "1 Pa s" }',
        'line 9: body.material: unknown material "steel"; `hydro',
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", poisson = 0.4 }',
        "line 9: body.material.poisson: a material with a name has its own; remove",
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", viscoity = 1 }',
        "line 9: body.material.viscoity: unknown key",
        "did you mean viscosity? allowed here are: name, ",
    ),
    ('"polyester fibre"', "{ name = 5 }", "line 9: body.material.name: 5 is not text"),
    (
        '"polyester fibre"',
        '{ viscosity = "1 Pa s" }',
        'line 9: body.material.young: the key "young" is missing; write young =',
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", viscosity = 40 }',
        'line 9: body.material.viscosity: 40 has no unit; write a viscosity as text: "40 Pa s"',
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", viscosity = "40 Pa" }',
        'line 9: body.material.viscosity: "Pa" does not measure a viscosity',
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", viscosity = "-1 Pa s" }',
        "line 9: body.material.viscosity must be finite and not negative, not -1 Pa s",
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", relaxation = [5] }',
        "line 9: body.material.relaxation[0]: 5 is not a table",
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", relaxation = { time = "2 s" } }',
        "line 9: body.material.relaxation: a table is not a list; write for example relaxation = [{ modulus",
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", relaxation = [{ modulus = "1 kPa" }] }',
        'line 9: body.material.relaxation[0].time: the key "time" is missing; write time = "2 s"',
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", relaxation = [{ modulus = "1 kPa", time = "2 m" }] }',
        'line 9: body.material.relaxation[0].time: "m" does not measure a time',
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", relaxation = [{ modulus = "0 Pa", time = "2 s" }] }',
        "line 9: body.material.relaxation[0].modulus must be finite and above 0, not 0 Pa",
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", relaxation = [{ modulus = "1 Pa", time = "-2 s" }] }',
        "line 9: body.material.relaxation[0].time must be finite and above 0, not -2 s",
    ),
    (
        '"polyester fibre"',
        '{ name = "polyester fibre", relaxation = [' + 11 * '{ modulus = "1 Pa", time = "1 s" }, ' + "] }",
        "line 9: body.material.relaxation: has more than 10 entries",
    ),
    (
        'material = "polyester fibre"',
        'volume = "node"\nmaterial = "polyester fibre"',
        'line 9: body.volume: "node" is not known; allowed are: element or patch',
    ),
    (
        'winch = "right"',
        'winch = "right"\nfriction = -0.1',
        "line 33: cable[1].friction must be at least 0 and at most 2",
    ),
    ('winch = "right"', 'winch = "right"\nfriction = nan', "line 33: cable[1].friction: NaN is not a finite number"),
    ('winch = "right"', 'winch = "right"\nfriction = "0.2"', 'line 33: cable[1].friction: "0.2" is not a number'),
    # how the parts fit together
    ("[0, 10]", "[0, 100]", "line 29: cable[0].points[1] = [0, 100] lies 80 mm outside the body; move it inside"),
    ("[20, -10]", "[40, -10]", "line 33: cable[1].points[1] = [40, -10] lies 10 mm outside the body; move it inside"),
    (
        "[[-20, 5]",
        "[[0, 5]",
        'line 29: cable[0].points[0]: a cable begins at its winch, but this is 20 mm from winch "left"',
    ),
    (", [0, 10], [20, 10]", "", "line 29: cable[0].points must hold at least 2 points, not 1"),
    ("[0, 10], [20, 10]", "[0, 10], [0, 10]", "line 29: cable[0].points[1] and points[2] are the same; remove one"),
    (
        'winch = "right"',
        'winch = "rigth"',
        'line 32: cable[1].winch: unknown winch "rigth". Available: left, right.',
    ),
    (
        "tip = [20, 10]",
        "top = [20, 10]",
        'line 45: pose[0].targets.top: unknown marker "top". Available: tip.',
    ),
    ("tip = [20, 10]\n", "", "line 44: pose[0].targets must name at least one marker"),
    ("at = [25, 0]", "at = [31, 0]", "line 40: marker[0].at = [31, 0] lies 1 mm outside the body; move it inside"),
    ('"right"', '"left"', 'line 22: winch[1].name: there are two of the name "left"; names must be unique'),
    (
        "[[pose]]",
        '[[marker]]\nname = "tip"\nat = [0, 0]\n[[pose]]',
        'line 43: marker[1].name: there are two of the name "tip"',
    ),
    (
        "tip = [20, 10]",
        'tip = [20, 10]\n[[pose]]\nname = "wave"\ntargets = { tip = [0, 0] }',
        "pose[1].name: there are two",
    ),
    ("[[pin]]\nat = [-20, 0]\nradius = 12\n", "", "robot.toml: no [[pin]]: the body is unconstrained"),
    ("at = [-20, 0]\nradius = 12", "at = [-200, 0]\nradius = 12", "line 11: pin[0]: the pin lies outside the body"),
    ("radius = 12", "radius = 0", "line 11: pin[0]: the pins hold too few nodes", "widen a radius or add a pin"),
    ("radius = 12", "box = [[0, 0], [1, 1]]", "line 11: pin[0]: give either at (with a radius) or box"),
    ("at = [-20, 0]", "box = [[0, 0], [9, 9]]", "line 13: pin[0].radius goes with at, not with box; remove it"),
    ("at = [-20, 0]\n", "box = [[0, 0]]\n", "line 12: pin[0].box: has 1 entries, at least 2 are needed"),
    # tables
    ("[[pin]]", "[pin]", "line 11: pin: begin each with [[pin]], in two pairs of brackets"),
    ("[body]", "[[body]]", "line 5: body: must be one table, begun with [body] in one pair of brackets"),
    ("[pose.targets]\ntip = [20, 10]", "targets = [20, 10]", "line 44: pose[0].targets: a list is not a table; write"),
    # names
    ('name = "small"', 'name = ""', "line 3: name: a name must not be empty"),
    ('name = "small"', "name = 5", "line 3: name: 5 is not text; write it in quotes"),
    (
        'name = "small"',
        'name = "../up"',
        'line 3: name: "../up" has "/" in it; a name has letters, digits, space and . _ -',
    ),
    ('name = "small"', 'name = "a\\nb"', 'line 3: name: "a\\nb" has "\\n" in it'),
    ('name = "small"', 'name = "..up"', 'line 3: name: "..up" begins with "."; a name begins with a letter or digit'),
    ('name = "left"', 'name = "<b>"', 'line 16: winch[0].name: "<b>" has "<" in it'),
    ('name = "left"', 'name = "a\\u202eb"', 'line 16: winch[0].name: "a\\u202eb" has "\\u202e" in it'),
    ('name = "tip"', f'name = "{"x" * 61}"', "line 39: marker[0].name:", "has 61 characters; a name has at most 60"),
    ('name = "wave"', 'name = " wave"', 'line 43: pose[0].name: " wave" begins with " "'),
    # TOML
    ("format = 1", "format 1", "line 2: not TOML: Expected '='"),
    ("format = 1", "format = 1\nformat = 1", "line 3: not TOML: Cannot overwrite a value"),
    ("format = 1", "format = " + 5000 * "[", "not TOML of a robot: brackets are nested too deep"),
    ("format = 1", "a." * 200_000 + "b = 1", "not TOML of a robot: a key has more than 30 parts"),
    ("format = 1", '"a". ' * 100_000 + "b = 1", "not TOML of a robot: a key has more than 30 parts"),
]


@pytest.mark.parametrize(("old", "new", "fragments"), [(old, new, told) for old, new, *told in LINES])
def test_refused(tmp_path: Path, old: str, new: str, fragments: list[str]) -> None:
    """Oracle: one printable line that names the file, the line and key, the value, and what is allowed."""
    message = refusal(tmp_path, edit(GOOD, old, new))
    assert all(fragment in message for fragment in fragments), message


@pytest.mark.parametrize(
    ("shapes", "fragment"),
    [
        ('<path d="M0,0 h60 v40 h-30"/>', "body.svg: the outline is open between (0, 0) and (30, 40)"),
        ('<path d="M0,0 L60,40 V0 L0,40 Z"/>', "body.svg: the outline crosses itself at (30, 20)"),
        ("", "body.svg: no closed shape"),
    ],
)
def test_bad_drawing(tmp_path: Path, shapes: str, fragment: str) -> None:
    """Oracle: the drawing's own complaint, at the line of its key."""
    assert f"robot.toml, line 6: body.outline: {fragment}" in refusal(tmp_path, GOOD, svg=SVG.format(shapes))


@pytest.mark.parametrize(
    ("content", "fragment"),
    [
        (b"", "robot.toml: the file is empty; begin with format = 1, or run hydrostat new"),
        (b" \r\n\t", "robot.toml: the file is empty"),
        (b"\xef\xbb\xbf", "robot.toml: the file is empty"),
        (
            GOOD.replace("small", "sm\xe4ll").encode("latin-1"),
            "robot.toml, line 3: not UTF-8 text; save the file again",
        ),
        (GOOD.encode("utf-16"), "robot.toml, line 1: not UTF-8 text"),
        (GOOD.encode().replace(b"small", b"sm\x00all"), "robot.toml, line 3: not TOML: "),
        (np.random.default_rng(0).bytes(5_000_000), "robot.toml: the file has 5 MB, at most 1 MB are read"),
        (np.random.default_rng(0).bytes(900_000), "not UTF-8"),
        (b"[" * 900_000, "robot.toml"),
        (b"[a]\n" * 200_000, "robot.toml, line 2: not TOML: Cannot declare"),
        (b"a={" * 300_000, "robot.toml"),
        (b"x" * 900_000, "robot.toml: not TOML: Expected '='"),
        (b'x="' + b"1" * 900_000, "robot.toml: not TOML: Unterminated string"),
        (b"".join(b"k%d=1\n" % index for index in range(60_000)), 'line 1: k0: unknown key "k0"'),
    ],
    ids=range(14),
)
def test_not_a_robot(tmp_path: Path, content: bytes, fragment: str) -> None:
    """Oracle: one line that names the file; no traceback, hang or flood, whatever the bytes."""
    assert fragment in refusal(tmp_path, content)


@pytest.mark.parametrize("change", [lambda text: text.replace("\n", "\r\n"), lambda text: "\ufeff" + text])
def test_windows_files(tmp_path: Path, change) -> None:
    """Oracle: the same robot from the same text with CRLF or with a byte order mark, and the same lines in errors."""
    assert load(tmp_path / "there", change(GOOD)) == load(tmp_path / "here")
    bad = edit(GOOD, 'name = "tip"', 'name = "t/p"')
    assert refusal(tmp_path / "there", change(bad)) == refusal(tmp_path / "here", bad)


def test_paths(tmp_path: Path) -> None:
    """Oracle: a folder, its robot.toml under any name, and a text path all give the same robot."""
    folder = robot_folder(tmp_path / "small")
    other = folder / "other.toml"
    other.write_text(GOOD)
    assert load_robot(folder) == load_robot(folder / "robot.toml") == load_robot(str(other))


@pytest.mark.parametrize(
    ("name", "fragment"),
    [
        ("nowhere", "nowhere/robot.toml: there is no such file"),
        ("nowhere.toml", "nowhere.toml: there is no such file"),
        ("small/body.svg", "body.svg: is neither the folder of a robot nor a robot.toml"),
        ("small/robot.toml/on", "robot.toml/on/robot.toml: cannot be read (Not a directory)"),
        ("folder.toml", "folder.toml/robot.toml: is not a file"),
        ("pipe.toml", "pipe.toml: is not a file"),
        ("x" * 300, "cannot be read (File name too long)"),
        ("a\0b", "cannot be read (embedded null byte)"),
    ],
)
def test_no_such_robot(tmp_path: Path, name: str, fragment: str) -> None:
    """Oracle: the message names the path that was tried; a pipe is not waited for."""
    robot_folder(tmp_path / "small")
    (tmp_path / "folder.toml" / "robot.toml").mkdir(parents=True)
    os.mkfifo(tmp_path / "pipe.toml")
    with pytest.raises(InputError) as caught:
        load_robot(tmp_path / name)
    assert fragment in str(caught.value)
    assert str(caught.value).isprintable()


BOX = np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], dtype=float)
MESHED = """\
format = 1
name = "m"
[body]
mesh = "m.vtk"
material = "polyester fibre"
{}[[pin]]
at = [2, 2{}]
radius = 99
"""


@pytest.mark.parametrize(
    ("points", "cells", "text", "fragment"),
    [
        (
            BOX,
            [("tetra", [[0, 1, 2, 3]])],
            MESHED.format('thickness = "9 mm"\n', ", 2"),
            "line 6: body.thickness is only",
        ),
        (
            BOX,
            [("triangle", [[0, 1, 2]])],
            MESHED.format("", ""),
            "line 3: body.thickness is missing; a flat body needs one",
        ),
        (
            BOX,
            [("triangle", [[0, 1, 3]])],
            MESHED.format('thickness = "9 mm"\n', ""),
            "line 4: body.mesh: m.vtk: its tri",
        ),
        (BOX, [("line", [[0, 1]])], MESHED.format("", ""), "line 4: body.mesh: m.vtk: holds neither tetrahedra nor"),
        (
            BOX[:3] * 0,
            [("triangle", [[0, 1, 2]])],
            MESHED.format('thickness = "9 mm"\n', ""),
            "body.mesh: 1 mesh elements",
        ),
    ],
    ids=range(5),
)
def test_bad_mesh(tmp_path: Path, points: np.ndarray, cells: list, text: str, fragment: str) -> None:
    """Oracle: the mesh's own complaint, at the line of its key."""
    robot_folder(tmp_path)
    meshio.write(tmp_path / "m.vtk", meshio.Mesh(points, [(kind, np.array(rows)) for kind, rows in cells]))
    assert fragment in refusal(tmp_path, text)


@pytest.mark.parametrize("content", [b"", b"garbage", b"# vtk DataFile Version 4.2\nx\nASCII\n", RECTANGLE.encode()])
@pytest.mark.parametrize("ending", ["vtk", "vtu", "msh", "xyz"])
def test_garbage_mesh(tmp_path: Path, content: bytes, ending: str) -> None:
    """Oracle: one line at the mesh's key, whatever stands in the file."""
    robot_folder(tmp_path)
    (tmp_path / f"m.{ending}").write_bytes(content)
    assert "line 4: body.mesh: " in refusal(tmp_path, MESHED.format("", "").replace("m.vtk", f"m.{ending}"))
