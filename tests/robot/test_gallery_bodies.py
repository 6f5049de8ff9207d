"""The robots in space of the gallery: what they are made of, what they can do, and that their scripts write them."""

import re
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot

import hydrostat as hs
from hydrostat.geometry import find_crossings, locate
from hydrostat.robot import Mount, Robot, find_risks, gallery_folder

TOP = Path(__file__).parents[2]
sys.path.append(str(TOP / "docs"))

import gallery  # noqa: E402

HANDS = ("cupping_hand", "extended_hand")
KNOWN_RISK = re.compile(r"body: a limb has only [\d.]+ elements across")
"""They are as coarse as the thesis's hand (N3): a finger has two elements across."""


@cache
def robot(name: str) -> Robot:
    return gallery_robot(name)


def characteristic(triangles: np.ndarray) -> int:
    """Euler's vertices - edges + triangles: 2 for one closed surface without handles."""
    edges = np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    return len(np.unique(triangles)) - len(edges) + len(triangles)


@pytest.mark.parametrize("name", gallery.SHEETS)
@pytest.mark.slow
def test_bodies(name: str) -> None:
    """Oracle: no healing needed; the mesh is a ball, so no fingers are fused; no risk but coarse limbs."""
    body = robot(name).body
    assert body.healing.clean
    assert characteristic(body.mesh.boundary) == 2
    assert body.mesh.volumes.sum() == pytest.approx(body.healing.surface.volume, rel=0.02)
    assert [risk for risk in find_risks(robot(name)) if not KNOWN_RISK.match(risk)] == []
    assert len(body.content) < 150_000


@pytest.mark.parametrize("name", gallery.ALL)
@pytest.mark.slow
def test_poses(name: str) -> None:
    """Oracle: at least two poses; each target far from rest for some marker, and with whole millimeters."""
    rest = {marker.name: np.array(marker.at) for marker in robot(name).markers}
    assert len(robot(name).poses) >= 2
    for pose in robot(name).poses.values():
        assert set(pose.targets) == set(rest)
        assert max(np.linalg.norm(rest[marker] - target) for marker, target in pose.targets.items()) > 7e-3
        targets = np.array(list(pose.targets.values()))
        assert targets * 1e3 == pytest.approx(np.round(targets * 1e3), abs=1e-9)


@pytest.mark.parametrize("name", HANDS)
@pytest.mark.slow
def test_hands_are_as_in_the_thesis(name: str) -> None:
    """Oracle: N3 (916 nodes, 3030 elements), R64 (10 cables), R54 (motors outside, tubes), five fingertips, foam."""
    one = robot(name)
    assert len(one.body.mesh.nodes) == pytest.approx(916, rel=0.1)
    assert len(one.body.mesh.elements) == pytest.approx(3030, rel=0.1)
    assert (len(one.winches), len(one.cables)) == (10, 10)
    assert [marker.name for marker in one.markers] == ["thumb", "index", "middle", "ring", "little"]
    for marker in one.markers:
        assert sum(winch.name.startswith(marker.name) for winch in one.winches) == 2
    assert all(winch.mount is Mount.WORLD for winch in one.winches)
    assert all(cable.sheathed for cable in one.cables)
    assert one.body.material.name == "flexfoam-it x"


@pytest.mark.slow
def test_the_thumbs_differ() -> None:
    """Oracle: both cables of the first thumb run along it, one of the second comes from the other side of the palm."""
    along, crossing = (
        [cable for cable in robot(name).cables if cable.winch.startswith("thumb")][1].points[3][0] for name in HANDS
    )
    assert along > 0.02
    assert crossing < 0


@pytest.mark.parametrize(("name", "pose"), [("cupping_hand", "pinch"), ("octopus_arm", "corkscrew")])
def test_poses_are_reached(name: str, pose: str) -> None:
    """Oracle: targets are simulated places in whole millimeters, so at most root(3)/2 mm is left at each marker."""
    reached = hs.solve_ik(hs.Simulation(robot(name)), robot(name).poses[pose])
    assert reached.pose.result.converged
    assert max(reached.errors.values()) < 3**0.5 / 2 * 1e-3


@pytest.mark.parametrize("name", gallery.ALL)
def test_no_pose_touches(name: str) -> None:
    """What the winches of each pose lead to neither crosses nor feels itself: it is the same with contact."""
    felt = hs.Simulation(replace(robot(name), contact=hs.Contact()))
    for play in gallery.ALL[name]().plays.values():
        pose = felt.solve(play.controls(felt.robot))
        assert hs.find_contacts(felt, pose) == ()
        assert not len(find_crossings(felt.robot.body.mesh, pose.nodes))


@pytest.mark.parametrize("name", gallery.ALL)
def test_the_scripts_write_the_files(name: str) -> None:
    """Oracle: the committed robot.toml, letter by letter."""
    assert gallery.ALL[name]().text() == (gallery_folder(name) / "robot.toml").read_text(encoding="utf-8")


def test_the_script_writes_the_surface(tmp_path: Path) -> None:
    """Oracle: the committed file of one body, byte by byte here; elsewhere rounding may choose other triangles."""
    folder = gallery.write_robot(gallery.SHEETS["tongue"](), tmp_path)
    written, kept = ((place / "tongue.ply").read_bytes() for place in (folder, gallery_folder("tongue")))
    if written != kept:
        body, other = robot("tongue").body.healing.surface, hs.load_robot(folder).body.healing.surface
        assert other.volume == pytest.approx(body.volume, rel=1e-4)
        assert other.area == pytest.approx(body.area, rel=1e-4)
        assert other.box == pytest.approx(body.box, abs=1e-4)


@pytest.mark.parametrize("name", gallery.TENDON_SHEETS)
def test_bodies_of_hinges_bones_and_disks(name: str) -> None:
    """Oracle: committed file, byte by byte; in one piece; no risk but cables that cross the slits."""
    sheet, body = gallery.ALL[name](), robot(name).body
    for file, content in sheet.files().items():
        assert (gallery_folder(name) / file).read_bytes() == content
    assert (euler_of_plane(body.mesh.elements) if body.mesh.dim == 2 else characteristic(body.mesh.boundary) / 2) == 1
    assert [risk for risk in find_risks(robot(name)) if "unless it crosses a slit" not in risk] == []


def euler_of_plane(triangles: np.ndarray) -> int:
    """Vertices - edges + triangles: 1 for a disc."""
    edges = np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    return len(np.unique(triangles)) - len(edges) + len(triangles)


def test_the_spiral_is_logarithmic() -> None:
    """Oracle: turns of all hinges under one tension are alike, as their sizes are chosen for."""
    pose = hs.Simulation(robot("spiral")).solve({"left": 0.02, "right": -0.04})
    route = np.array(robot("spiral").cables[0].points)[2:-1].reshape(-1, 2, 2)  # both faces of each slit
    units = np.concatenate([route[:-1, 1], route[1:, 0]], axis=1).reshape(-1, 2, 2)  # both ends of each hole
    ends = locate(robot("spiral").body.mesh, units.reshape(-1, 2)).positions(pose.nodes).reshape(-1, 2, 2)
    ways = ends[:, 1] - ends[:, 0]
    turns = np.diff(np.unwrap(np.arctan2(ways[:, 1], ways[:, 0])))
    assert len(turns) == 11
    assert turns.mean() > np.radians(8)
    assert turns == pytest.approx(turns.mean(), rel=0.2)


def test_bones_and_disks_stay_rigid() -> None:
    """Oracle: singular values of the best affine map of each rigid part are 1."""
    for name, pull in (("finger", {"flex": 0.012, "extend": -0.016}), ("spine", {"a1": 0.005, "b1": 0.009})):
        body, pose = robot(name).body, hs.Simulation(robot(name)).solve(pull)
        for index in range(1, len(body.parts) + 1):
            own = np.unique(body.mesh.elements[body.element_materials == index])
            rest, now = (places[own] - places[own].mean(axis=0) for places in (body.mesh.nodes, pose.nodes))
            stretch = np.linalg.svd(np.linalg.lstsq(rest, now, rcond=None)[0], compute_uv=False)
            assert stretch == pytest.approx(1.0, abs=4e-3)
