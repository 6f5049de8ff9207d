"""Outlines drawn by hand."""

from dataclasses import replace
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import gallery_robot
from shapely import LinearRing

from hydrostat.design import Zone
from hydrostat.errors import InputError
from hydrostat.geometry import read_outline
from hydrostat.project import Paint, Wishes, Work
from hydrostat.robot import load_robot, save_robot
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.starting.loops import (
    Loop,
    LoopCorner,
    curve,
    fit_loops,
    loops_svg,
    outline_of,
    read_loops,
    send_loops,
)
from hydrostat.studio.starting.outlining import Outlining, Reshaped, beginnings, reshape_outline
from hydrostat.studio.starting.starter import Starter

FLAT = ("letter_e", "letter_s", "pig", "puppy", "robot", "squid", "starfish")
SQUARE = (LoopCorner(-50, -30), LoopCorner(50, -30), LoopCorner(50, 30), LoopCorner(-50, 30))


@pytest.mark.parametrize("name", FLAT)
def test_few_corners_follow_the_outlines_of_the_gallery(name: str) -> None:
    """Oracle: Hausdorff distance to the outline; 0.5 % of the size, with a twentieth of its points."""
    outline = gallery_robot(name).body.outline
    assert outline is not None
    loops = fit_loops(outline)
    assert len(loops) == len(outline.rings)
    for loop, ring in zip(loops, outline.rings, strict=True):
        assert LinearRing(1e-3 * curve(loop)).hausdorff_distance(LinearRing(ring)) < 0.005 * outline.size
    assert 4 <= sum(map(len, loops)) <= sum(map(len, outline.rings)) / 18


@pytest.mark.parametrize("corners", [6, 8, 12])
def test_smooth_corners_on_a_circle_make_one(corners: int) -> None:
    """Oracle: the circle's radius, to 1.5 %."""
    places = [(100 * cos(2 * pi * k / corners), 100 * sin(2 * pi * k / corners)) for k in range(corners)]
    radii = np.linalg.norm(curve(tuple(LoopCorner(x, y, True) for x, y in places)), axis=1)
    assert np.abs(radii - 100).max() < 1.5


def test_what_is_drawn_is_what_is_read() -> None:
    """Oracle: the loops' own outline, moved to the middle of its box; a hole stays a hole."""
    hole = tuple(LoopCorner(20 + 10 * cos(k), 5 + 10 * sin(k), True) for k in (0, 1.5, 3, 4.5))
    loops: tuple[Loop, ...] = (hole, SQUARE)
    drawing, corner = loops_svg(loops)
    assert corner == pytest.approx((-50, 30))
    read, drawn = read_outline(drawing, name="a.svg"), outline_of(loops)
    assert read.area == pytest.approx(drawn.area, rel=1e-3)
    assert len(read.holes) == 1
    assert read.holes[0].mean(axis=0) == pytest.approx([0.020, 0.005], abs=1e-3)


@pytest.mark.parametrize(
    ("loops", "words"),
    [
        ((), "no outline yet"),
        (
            ((LoopCorner(0, 0), LoopCorner(100, 100), LoopCorner(100, 0), LoopCorner(0, 100)),),
            "crosses itself at (50, 50) mm",
        ),
        ((SQUARE, (LoopCorner(40, 0), LoopCorner(60, 0), LoopCorner(60, 10))), "crossed or touched by a hole"),
        (((LoopCorner(0, 0), LoopCorner(1, 0)),), "(minimum 3)"),
        (((LoopCorner(0, 0), LoopCorner(1, 0), LoopCorner(2, 0)),), "no area"),
    ],
)
def test_faults_are_told_while_drawing(loops: tuple[Loop, ...], words: str) -> None:
    """Oracle: the words of the outline's own check."""
    outlining = Outlining()
    outlining.take(send_loops(loops))
    assert words in outlining.fault
    with pytest.raises(InputError):
        outlining.drawing()


@pytest.mark.parametrize(
    "raw",
    [
        None, 3, "abc", [[1, 2, 3]], [[[1, 2]]], [[["a", 2, True]]], [[[float("nan"), 0, True]]],
        [[[1e300, 0, False]]], [[[10**400, 0, False]]], {"a": 1}, [[]] * 51, [[[0, 0, False]] * 1001],
    ],
)  # fmt: skip
def test_what_is_no_outline_is_refused(raw: Any) -> None:
    """Oracle: InputError, and the loops are as they were."""
    outlining = Outlining((SQUARE,))
    with pytest.raises(InputError):
        outlining.take(raw)
    assert outlining.loops == (SQUARE,)


def test_loops_go_to_the_screen_and_back() -> None:
    """Oracle: the loops; beginnings are bodies."""
    for loops in beginnings().values():
        assert read_loops(send_loops(loops)) == loops
        assert Outlining(loops).fault == ""


def starfish() -> Work:
    wishes = Wishes(zones=((Paint.KEEP_OUT, Zone(at=(0.01, 0.02), radius=0.005)),))
    return Work(robot=gallery_robot("starfish"), wishes=wishes)


def test_an_unchanged_outline_keeps_all_parts_in_their_places(tmp_path: Path) -> None:
    """Oracle: the robot before, to the accuracy of the corners."""
    work = starfish()
    found = Outlining.of(work.robot).apply_outline(work)
    robot = found.work.robot
    assert found.dropped == ()
    assert robot.body.mesh.size == pytest.approx(work.robot.body.mesh.size, rel=0.01)
    assert (robot.body.thickness, robot.body.element_size) == (work.robot.body.thickness, work.robot.body.element_size)
    for one, other in zip(robot.cables, work.robot.cables, strict=True):
        assert np.array(one.points) == pytest.approx(np.array(other.points), abs=2e-3)
    save_robot(robot, tmp_path)
    assert load_robot(tmp_path) == robot


def test_what_lies_outside_is_named_and_goes() -> None:
    """Oracle: a starfish without the arm that points up loses what was in it; the rest is at the same material place.

    The body gets lower, so its middle moves down, and all coordinates up by as much.
    """
    work = starfish()
    robot = work.robot
    (loop,) = Outlining.of(robot).loops
    cut = tuple(replace(corner, y=min(corner.y, 45.0)) for corner in loop)
    kept = tuple(
        corner
        for k, corner in enumerate(cut)
        if corner.y < 45.0 or cut[k - 1].y < 45.0 or cut[(k + 1) % len(cut)].y < 45.0
    )
    found = Outlining((tuple(replace(corner, smooth=False) for corner in kept),), robot).apply_outline(work)
    lost = [marker.name for marker in robot.markers if marker.at[1] > 0.046]
    assert lost
    assert {f"marker {name}" for name in lost} <= set(found.dropped)
    made = found.work.robot
    shift = np.subtract(made.pins[0].at, robot.pins[0].at)
    assert shift[1] > 0.01
    for marker in made.markers:
        (before,) = [other for other in robot.markers if other.name == marker.name]
        assert np.subtract(marker.at, before.at) == pytest.approx(shift, abs=1e-8)
    zone = found.work.wishes.zones[0][1]
    assert zone.at == pytest.approx(np.array([0.01, 0.02]) + shift)
    for pose in made.poses.values():
        assert not set(lost) & set(pose.targets)


def test_an_outline_without_any_pin_is_refused() -> None:
    """Oracle: InputError that says what to do; a box far from the body."""
    work = starfish()
    far = tuple(replace(corner, x=corner.x + 800) for corner in SQUARE)
    with pytest.raises(InputError, match="no pin lies inside"):
        Outlining((far,), work.robot).apply_outline(work)


def test_editing_an_outline_is_one_change() -> None:
    """Oracle: undo brings the robot of before."""
    bell = Bell()
    document = Document(bell)
    starter = Starter(document, Jobs(bell))
    document.open(starfish())
    before = document.robot
    starter.outline_open()
    assert starter.outlining is not None
    starter.outlining.take(
        [[[x * 1.1, y, smooth] for x, y, smooth in loop] for loop in send_loops(starter.outlining.loops)]
    )
    starter.outline_apply()
    assert starter.outlining is None
    assert document.undo_label == "edit outline"
    assert document.robot.body.mesh.size > 1.05 * before.body.mesh.size
    document.undo()
    assert document.robot is before


@pytest.mark.parametrize("meanwhile", ["part", "robot", "drawing"])
@pytest.mark.slow
def test_a_slow_outline_loses_nothing(monkeypatch: pytest.MonkeyPatch, meanwhile: str) -> None:
    """Oracle: what was changed while the body was made is there after it; another robot stays as it is."""
    bell = Bell()
    document = Document(bell)
    starter = Starter(document, Jobs(bell))
    document.open(starfish())
    other = Work(robot=gallery_robot("fish_tail"))
    starter.outline_open()
    begun = [meanwhile]

    def slowly(work: Work, drawing: bytes, corner: tuple[float, float]) -> Reshaped:
        made = reshape_outline(work, drawing, corner)
        if begun and begun.pop() == "part":
            document.change("rename", robot=replace(document.robot, name="mine"))
        elif meanwhile == "robot":
            document.open(other)
        elif meanwhile == "drawing":
            starter.outline_new()
        return made

    monkeypatch.setattr("hydrostat.studio.starting.outlining.reshape_outline", slowly)
    before = document.robot
    if meanwhile == "part":
        starter.outline_apply()
        assert document.undo_label == "edit outline"
        assert document.robot.name == "mine"
        return
    with pytest.raises(InputError, match="meanwhile"):
        starter.outline_apply()
    assert document.robot is (other.robot if meanwhile == "robot" else before)
    assert starter.outlining is not None


def test_cables_that_are_kept_stay_kept_in_a_new_outline() -> None:
    """Oracle: the stoppers of the kept cables, in a body without the arm that the first cable runs through."""
    work = starfish()
    work = replace(work, wishes=replace(work.wishes, kept_cables=tuple(cable.name for cable in work.robot.cables)))
    arm = work.robot.cables[0].points[-1]
    (loop,) = Outlining.of(work.robot).loops
    cut = 1e3 * 0.6 * arm[0]
    corners = [replace(corner, x=min(corner.x, cut), smooth=False) for corner in loop]
    kept = [
        corner
        for place, corner in enumerate(corners)
        if corner.x < cut or corners[place - 1].x < cut or corners[(place + 1) % len(corners)].x < cut
    ]
    found = Outlining((tuple(kept),), work.robot).apply_outline(work)
    assert "cable 1" in found.dropped
    assert found.work.wishes.kept_cables == tuple(cable.name for cable in found.work.robot.cables)


def test_only_drawn_bodies_have_an_outline() -> None:
    """Oracle: InputError."""
    with pytest.raises(InputError, match="no outline"):
        Outlining.of(gallery_robot("trunk"))
