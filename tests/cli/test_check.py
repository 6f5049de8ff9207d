"""`hydrostat check`: what it says of the body. Oracle: a rectangle 60 x 40 x 20 mm of 40 kg/m^3, and a box like it."""

import json
import re
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from builders import box_mesh
from manifold3d import Manifold

from hydrostat.cli.check import _across_words, name_cables
from hydrostat.cli.check_poses import print_reached_poses
from hydrostat.cli.main import main
from hydrostat.design import BuildCost
from hydrostat.geometry import Surface, write_ply, write_vtu
from hydrostat.ik import IKOptions, solve_ik
from hydrostat.robot import (
    Cable,
    CableSide,
    Marker,
    Obstacle,
    PoseTarget,
    Winch,
    gallery_folder,
    load_robot,
    robot_hash,
    save_robot,
)
from hydrostat.simulation import Simulation, is_stuffed_motion_fast

Check = Callable[..., list[str]]

FLAT = """\
format = 1
name = "flat"

[body]
outline = "body.svg"
element_size = "12 mm"
thickness = "20 mm"
material = "polyester fibre"

[[pin]]
at = [-20, 0]
radius = 12
"""

SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">{}</svg>'

SOLID = """\
format = 1
name = "solid"
length_unit = "m"

[body]
mesh = "solid.vtu"
material = { young = "30 kPa", poisson = 0.3, density = "40 kg/m^3" }

[[pin]]
box = [[-0.001, -1, -1], [0.001, 1, 1]]
"""


@pytest.fixture
def check(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Check:
    """Run the command on a folder; returns its lines."""

    def run(folder: Path, *, thorough: bool = True) -> list[str]:
        monkeypatch.setattr(sys, "argv", ["hydrostat", "check", str(folder), *["--thorough"] * thorough])
        with pytest.raises(SystemExit) as stop:
            main()
        assert stop.value.code == 0
        return capsys.readouterr().out.splitlines()

    return run


NO_CABLES = "OK: 0 errors, 0 warnings (body only: no cables yet)."


def test_tips_are_no_limbs_of_part_of_an_element() -> None:
    assert _across_words(2.25) == "2.2 elements across"
    assert _across_words(0.4) == "less than 1 element across, as at tips and corners"


def test_flat_body(check: Check, tmp_path: Path) -> None:
    """Oracle: 48 cm^3, 1.92 g, 40 mm across where it is narrow, that is 40 / 12 elements; 20 mm are thin for motors.

    The smallest unit is 25 mm thick, and stuffing gives a quarter.
    """
    (tmp_path / "body.svg").write_text(SVG.format('<rect width="60" height="40"/>'))
    (tmp_path / "robot.toml").write_text(FLAT)
    lines = check(tmp_path)
    assert lines[0].startswith("flat: 60 mm, ")
    assert lines[1] == "polyester fibre: 1.92 g, 48 cm³"
    few = float(lines[2].removeprefix("width from 40 mm (").split(" ")[0])
    assert "elements across), thickness 20 mm; " in lines[2]
    assert few == pytest.approx(40 / 12, rel=0.15)
    assert "smallest angle" in lines[2]
    words = 'plane strain: as thick everywhere as at rest; plane = "stress" would bend with 9 % less force'
    assert lines[3] == words
    assert lines[4] == "1 pin, 0 winches, 0 cables, 0 markers, poses: none"
    told = re.fullmatch(r"warning: body: no room for the motor .* Make it at least (\d+) mm thick\. .*", lines[5])
    assert told is not None
    assert 25 / 1.25 <= float(told[1]) < 1.05 * 25 / 1.25 + 1
    assert lines[6:] == [NO_CABLES.replace("0 warnings", "1 warning")]


def test_body_in_space(check: Check, tmp_path: Path) -> None:
    """Oracle: 192 cm^3, 7.68 g; cubes cut in six have 45 degrees between two faces; warnings are counted."""
    for cells, risks in (((12, 4, 4), 0), ((6, 2, 2), 1)):
        mesh = box_mesh(cells, size=(0.12, 0.04, 0.04))
        (tmp_path / "solid.vtu").write_bytes(write_vtu(mesh, mesh.nodes, {}))
        lossy = SOLID.replace('m^3" }', 'm^3", hysteresis = [{ young = "9 kPa", strain = 0.02 }] }') if risks else SOLID
        (tmp_path / "robot.toml").write_text(lossy)
        lines = check(tmp_path)
        assert any(line.startswith("note: hysteresis: refused by pose, ") for line in lines) == bool(risks)
        assert lines[1] == "custom material: 7.68 g, 192 cm³"
        across = cells[1] / np.sqrt(2) ** (1 / 3)
        assert lines[2].startswith(f"thickness from 40 mm ({across:.1f} elements across); ")
        assert lines[2].endswith("smallest angle between faces 45°")
        assert sum(line.startswith("warning: ") for line in lines) == risks + 1
        assert sum("(40 kg/m^3) is not cast from two parts" in line for line in lines) == 1
        assert lines[-1] == NO_CABLES.replace("0 warnings", "2 warnings" if risks else "1 warning")


def test_holes_that_the_mesh_leaves_out_are_a_note(check: Check, tmp_path: Path) -> None:
    """Oracle: a hole of 1.5 mm through the middle of a plate 30 x 20 x 8 mm, in elements of 4 mm."""
    plate = Manifold.cube((30, 20, 8)) - Manifold.cylinder(10, 0.75, 0.75, 24).translate((10, 10, -1))
    mesh = plate.to_mesh()
    surface = Surface(1e-3 * np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts))
    (tmp_path / "plate.ply").write_bytes(write_ply(surface))
    text = SOLID.replace('length_unit = "m"\n', "").replace(
        "[[-0.001, -1, -1], [0.001, 1, 1]]", "[[-1, -1, -1], [1, 99, 99]]"
    )
    text = text.replace('mesh = "solid.vtu"', 'surface = "plate.ply"\nelement_size = "4 mm"')
    (tmp_path / "robot.toml").write_text(text)
    notes = [
        line for line in check(tmp_path) if line.startswith("note: 1 hole 1.5 mm wide at (10, 10, 4) mm is filled")
    ]
    assert len(notes) == 1


def test_a_part_counts_elements_whatever_their_kind(check: Check, tmp_path: Path) -> None:
    """Oracle: the same body in linear elements; quadratic ones have four points of integration each."""
    (tmp_path / "body.svg").write_text(SVG.format('<rect width="60" height="40"/>'))
    part = '[[body.part]]\nname = "plate"\nshape = "box"\nat = [-12, -20]\nto = [12, 20]\nrigid = true\n'
    text = FLAT.replace("\n[[pin]]", part + 'density = "1 g/cm^3"\n\n[[pin]]')
    told = []
    for kind in ("linear", "quadratic"):
        (tmp_path / "robot.toml").write_text(text.replace("thickness", f'elements = "{kind}"\nthickness'))
        told += [line for line in check(tmp_path) if line.startswith("part plate: rigid, ")]
    assert re.search(r" \d+ elements$", told[0])
    assert told[0] == told[1]


@pytest.mark.slow
def test_a_flat_robot_says_where_its_cables_run_and_what_that_does(
    check: Check, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Oracle: decision 0029: on the front alone centimeters out of the plane, in pairs less than a millimeter.

    Workspaces are left out: test_commands.py has them.
    """
    monkeypatch.setattr("hydrostat.cli.check._LARGE_BODY_NODES", 1)
    robot = load_robot(gallery_folder("letter_s"))
    found = {}
    for face in (CableSide.FRONT, CableSide.PAIRS):
        save_robot(replace(robot, face=face), tmp_path / face)
        lines = check(tmp_path / face)
        (place,) = (number for number, line in enumerate(lines) if line.startswith("cables: "))
        assert re.match(r"build: \d+ holes, .* USD \(1 motor, power, cables\)", lines[place + 1])
        out = re.match(r"3D effect when stuffed: ([\d.]+) mm out of plane", lines[place + 2])
        assert out is not None
        found[lines[place].removeprefix("cables: ")] = float(out[1])
        warned = [line for line in lines if line.startswith("warning: cables on the front: they bend")]
        assert len(warned) == (face is CableSide.FRONT)
        far = [line for line in lines if line.startswith("warning: pose stretch: target not reached (35 of 35 mm")]
        assert lines[-1] == f"OK: 0 errors, {len(warned) + 1} warning{'s' * len(warned)}."
        assert len(far) == 1, "one winch curls it, and nothing stretches it"
    assert 10 < found["on the front"] < 30
    assert found["on both faces, in pairs"] < 1
    fine = replace(robot, face=CableSide.PAIRS, body=replace(robot.body, element_size=1e-4))
    assert not is_stuffed_motion_fast(fine, len(fine.poses))


def test_poses_are_solved_or_named_as_not_computed(check: Check, tmp_path: Path) -> None:
    """Oracle: the errors of `solve_ik`, and a target 300 mm away."""
    robot = load_robot(gallery_folder("starfish"))
    name, place = next((marker.name, marker.at) for marker in robot.markers)
    far = PoseTarget(name="far", targets={name: (place[0], place[1] + 0.3)})
    save_robot(replace(robot, poses={**robot.poses, "far": far}), tmp_path / "robot")
    lines = check(tmp_path / "robot")
    errors = {pose.name: solve_ik(Simulation(robot), pose).rms_error for pose in (*robot.poses.values(), far)}
    told = ", ".join(f"{pose} {float(f'{1e3 * error:.2g}'):g} mm" for pose, error in errors.items())
    assert f"poses solved, rms error: {told}" in lines
    (warned,) = [line for line in lines if line.startswith("warning: pose ") and "not reached" in line]
    assert warned.startswith(
        f"warning: pose far: target not reached ({float(f'''{1e3 * errors['far']:.2g}'''):g} of 300 mm are left)"
    )


def test_poses_that_mirror_name_the_option_for_cables_that_do(check: Check, tmp_path: Path) -> None:
    """Oracle: a bar with a marker at each end; poses that lift both by as much, and by different lengths."""
    (tmp_path / "body.svg").write_text(SVG.format('<rect width="60" height="40"/>'))
    (tmp_path / "robot.toml").write_text(FLAT)
    ends = (Marker(name="left", at=(-0.025, 0.0)), Marker(name="right", at=(0.025, 0.0)))
    robot = replace(load_robot(tmp_path), markers=ends)
    told = []
    for lift in (0.01, 0.02):
        pose = PoseTarget(name="lift", targets={"left": (-0.025, 0.01), "right": (0.025, lift)})
        save_robot(replace(robot, poses={"lift": pose}), tmp_path / f"{lift}")
        told.append([line for line in check(tmp_path / f"{lift}") if "--symmetric x" in line])
    assert told[0] == ["note: body, markers and poses mirror about x. Try hydrostat design --symmetric x"]
    assert told[1] == []


def test_a_pose_that_one_search_misses_is_solved_with_restarts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: errors by hand, far without restarts and near with them."""
    asked = []

    def solve(*_: object, options: IKOptions | None = None, **__: object) -> SimpleNamespace:
        asked.append((options or IKOptions()).restarts)
        return SimpleNamespace(rms_error=1.0 if asked[-1] == 0 else 1e-3)

    monkeypatch.setattr("hydrostat.ik.solve_ik", solve)
    robot = load_robot(gallery_folder("starfish"))
    assert print_reached_poses(robot) == ()
    assert asked == [0, IKOptions().restarts] * len(robot.poses)


def test_cables_with_a_name_are_named() -> None:
    """Oracle: by hand; names stand behind numbers, once, and quoted words stay."""
    robot = load_robot(gallery_folder("starfish"))
    first, *others = robot.cables
    named = robot.with_network(robot.winches, [replace(first, name="arm"), *others])
    for text, told in (
        ("cable 1, point 3: too near", 'cable 1 "arm", point 3: too near'),
        ("cable 1 between points 2 and 3", 'cable 1 "arm" between points 2 and 3'),
        ("cable 2, point 3: too near", "cable 2, point 3: too near"),
        ('cable 1 "arm": sharp', 'cable 1 "arm": sharp'),
        ('"cable 1, point 3"', '"cable 1, point 3"'),
    ):
        assert name_cables(text, named) == told


def test_reach_is_left_out_of_large_bodies(check: Check, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nine poses of 22,000 nodes take minutes; a limit below the starfish's nodes makes it such a body."""
    nodes = len(load_robot(gallery_folder("starfish")).body.mesh.nodes)
    monkeypatch.setattr("hydrostat.cli.check._LARGE_BODY_NODES", nodes - 1)
    monkeypatch.setattr("hydrostat.simulation.is_stuffed_motion_fast", lambda *_: False)
    lines = [line for line in check(gallery_folder("starfish")) if line.startswith("workspace")]
    assert lines == [f"workspace: skipped ({nodes} nodes, maximum {nodes - 1}). Use larger elements"]


def test_an_error_ends_with_1_and_warnings_with_0(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Oracle: exit code 1 exactly where a line begins with "error"; two winches at one place share their room."""
    robot = load_robot(gallery_folder("starfish"))
    one, two, *rest = robot.winches
    cables = [
        replace(cable, points=(one.at, *cable.points[1:])) if cable.winch == two.name else cable
        for cable in robot.cables
    ]
    met = replace(robot, winches=(one, replace(two, at=one.at), *rest), cables=tuple(cables))
    save_robot(met, tmp_path / "met")
    for folder, code in ((tmp_path / "met", 1), (gallery_folder("squid"), 0)):
        monkeypatch.setattr(sys, "argv", ["hydrostat", "check", str(folder)])
        with pytest.raises(SystemExit) as stop:
            main()
        told = capsys.readouterr().out.splitlines()
        assert (stop.value.code or 0) == code
        assert any(line.startswith("error: ") for line in told) is bool(code)
        assert any(line.startswith("warning: ") for line in told) or code


@pytest.mark.parametrize(("friction", "words"), [(0.0, "no pin holds the robot"), (0.5, "with friction or hysteresis")])
def test_a_robot_without_pins_gets_its_verdict(check: Check, tmp_path: Path, friction: float, words: str) -> None:
    """Where it comes to rest on the ground is not known, so no compliance is; the review does not need it."""
    (tmp_path / "body.svg").write_text(SVG.format('<rect width="60" height="40"/>'))
    (tmp_path / "robot.toml").write_text(FLAT.replace("20 mm", "40 mm"))
    ground = Obstacle(name="ground", shape="plane", at=(0.0, -0.021), normal=(0.0, 1.0), friction=friction)
    loose = replace(load_robot(tmp_path), pins=(), obstacles=(ground,), gravity=(0.0, -9.81))
    ends = ((-0.02, 0.01), (0.02, 0.01))
    pulled = replace(
        loose,
        winches=(Winch(name="up", at=ends[0], travel=0.01),),
        cables=(Cable(winch="up", points=ends),),
        markers=(Marker(name="tip", at=ends[1]),),
    )
    save_robot(pulled, tmp_path / "loose")
    lines = check(tmp_path / "loose")
    assert any(line.startswith(f"compliance: not computed ({words}") for line in lines)
    assert lines[-1].startswith("OK: 0 errors")


def test_a_robot_of_a_design_costs_what_the_design_printed(check: Check, tmp_path: Path) -> None:
    """Oracle: the price in score.json next to the robot; simulations have no part in it and are left out."""
    robot = replace(load_robot(gallery_folder("starfish")), poses={})
    save_robot(robot, tmp_path / "robot")
    cost = replace(BuildCost.of_robot(robot, ()), price=243.0)
    card = {"robot": robot_hash(load_robot(tmp_path / "robot")), "craft": cost.as_values, "alternatives": []}
    (line,) = [line for line in check(tmp_path / "robot", thorough=False) if line.startswith("build:")]
    assert line.endswith("; more if poses need stronger motors. Whole kit: hydrostat fabricate --summary")
    (tmp_path / "score.json").write_text(json.dumps(card))
    (line,) = [line for line in check(tmp_path / "robot", thorough=False) if line.startswith("build:")]
    assert line == f"build: {cost}. Whole kit: hydrostat fabricate --summary"
    assert "243 USD" in line
    for wrong in (None, "243", float("nan"), -7.0):
        card["craft"]["price"] = wrong
        (tmp_path / "score.json").write_text(json.dumps(card))
        (line,) = [line for line in check(tmp_path / "robot", thorough=False) if line.startswith("build:")]
        assert "more if poses need" in line
