"""Taking home: results belong to one robot, and are zips, pages and pictures that others can read."""

import io
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np
import pytest
from builders import gallery_robot
from PIL import Image
from plush_robots import crossed

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.fabrication import KitOptions
from hydrostat.project import Work
from hydrostat.robot import Robot
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.document import Document
from hydrostat.studio.exporting.exporter import Export, Exporter
from hydrostat.studio.exporting.kit_work import KitMade, make_kit
from hydrostat.studio.exporting.report_work import make_pictures, make_report
from hydrostat.studio.jobs import Jobs

LONGEST = 60.0


class Told:
    """Keeps the stages that work tells."""

    def __init__(self) -> None:
        self.stages: list[str] = []

    def progress(self, stage: str, done: int, total: int) -> None:
        """One stage."""
        self.stages.append(stage)

    def part(self, value: object) -> None:
        """Nothing is handed over on the way."""

    def finish(self) -> None:
        """The work is done."""


@pytest.fixture(scope="module")
def starfish() -> Robot:
    return gallery_robot("starfish")


@pytest.fixture(scope="module")
def waving(starfish: Robot) -> Robot:
    """The starfish with one pose."""
    return replace(starfish, poses={"wave": starfish.poses["wave"]})


@pytest.fixture(scope="module")
def kit(starfish: Robot) -> tuple[KitMade, Told]:
    told = Told()
    return make_kit(told, starfish, KitOptions()), told


@pytest.fixture
def exporter(waving: Robot) -> Exporter:
    bell = Bell()
    document = Document(bell)
    document.open(Work(robot=waving))
    return Exporter(document, Jobs(bell))


def finished(exporter: Exporter) -> None:
    """Wait until nothing is being made."""
    done = Event()

    def hear(topic: Topic) -> None:
        if topic is Topic.JOB and exporter.busy is None:
            done.set()

    exporter._document.bell.listen(hear)
    if exporter.busy is not None:
        assert done.wait(LONGEST)


@pytest.mark.slow
def test_a_kit_is_the_files_of_the_library_in_one_zip(
    kit: tuple[KitMade, Told], starfish: Robot, plush_kit: hs.Kit
) -> None:
    made, told = kit
    assert made.zip is not None
    with zipfile.ZipFile(io.BytesIO(made.zip.content)) as zipped:
        assert zipped.testzip() is None
        unpacked = {name: zipped.read(name) for name in zipped.namelist()}
        assert list(unpacked) == sorted(unpacked)
        assert {entry.date_time for entry in zipped.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    assert unpacked == {f"starfish_kit/{path}": content for path, content in plush_kit.files.items()}
    assert made.summary == plush_kit.summary
    assert made.check_summary == f"{len(plush_kit.checks)} of {len(plush_kit.checks)} checks passed"
    assert "Pattern" in told.stages


@pytest.mark.slow
def test_pages_are_pictures_of_the_sheet(kit: tuple[KitMade, Told]) -> None:
    made, _ = kit
    assert len(made.pages) == 5  # of a robot of plush: the fourth has small maps, the last the wires
    for page in made.pages:
        with Image.open(io.BytesIO(page)) as picture:
            assert picture.height / picture.width == pytest.approx(297 / 210, abs=0.01)
    assert made.pattern is not None
    assert ET.fromstring(made.pattern).tag.endswith("svg")


@pytest.mark.slow
def test_what_cannot_be_built_is_told_and_made_all_the_same_if_forced() -> None:
    small = replace(KitOptions(), mould=replace(KitOptions().mould, bed=(20.0, 20.0, 20.0)))
    refused = make_kit(Told(), crossed(), small)
    assert refused.refused
    assert refused.zip is None
    forced = make_kit(Told(), crossed(), replace(small, force=True))
    assert forced.problems == refused.refused
    assert forced.zip is not None


@pytest.mark.slow
def test_results_belong_to_the_robot_they_were_made_of(exporter: Exporter) -> None:
    document = exporter._document
    exporter.make_pictures()
    with pytest.raises(InputError, match="still running"):
        exporter.make_report()
    finished(exporter)
    assert exporter.errors == {}
    assert exporter.pictures
    assert not exporter.is_outdated(Export.PICTURES)
    document.change("remove markers", robot=replace(document.robot, gravity=(0.0, -1.0)))
    assert not exporter.pictures
    assert exporter.is_outdated(Export.PICTURES)
    document.undo()
    assert exporter.pictures


@pytest.mark.slow
def test_a_refused_kit_says_why(exporter: Exporter) -> None:
    """The motor that robot.toml names reaches the kit of the studio."""
    document = exporter._document
    document.change("name a motor", robot=replace(document.robot, motor="sts3215"))
    exporter.make_kit()
    finished(exporter)
    assert exporter.kit is not None
    assert exporter.kit.zip is None
    assert any("smaller motors" in problem for problem in exporter.kit.refused)


class Hasty(Jobs):
    """Work that fails before its start returns."""

    def start(self, title: str, function: Callable[..., Any], *arguments: Any, **calls: Any) -> None:
        """It has failed already."""
        calls["on_end"]("no process could be started")


def test_work_that_fails_at_once_leaves_nothing_busy(exporter: Exporter) -> None:
    hasty = Exporter(exporter._document, Hasty(exporter._document.bell))
    hasty.make_report()
    assert hasty.busy is None
    assert hasty.errors == {Export.REPORT: "no process could be started"}


def test_work_that_is_refused_leaves_all_as_it_was(exporter: Exporter) -> None:
    exporter.make_pictures()
    with pytest.raises(InputError, match="still running"):
        exporter.make_report()
    assert exporter.busy is Export.PICTURES
    exporter._jobs.close()


def test_a_robot_without_cables_has_no_kit(exporter: Exporter) -> None:
    document = exporter._document
    document.change("remove cables", robot=document.robot.with_network((), ()))
    with pytest.raises(InputError, match="Design"):
        exporter.make_kit()


def test_the_robot_reads_back_the_same(exporter: Exporter, tmp_path: Path) -> None:
    robot = exporter._document.robot
    download = exporter.robot_zip()
    with zipfile.ZipFile(io.BytesIO(download.content)) as zipped:
        zipped.extractall(tmp_path)
    again = hs.load_robot(tmp_path / "starfish")
    assert hs.robot.robot_hash(again) == hs.robot.robot_hash(robot)
    assert exporter.robot_zip().content == download.content


@pytest.mark.slow
def test_pictures_open_and_the_same_robot_gives_the_same(waving: Robot) -> None:
    pictures = make_pictures(Told(), waving)
    names = [picture.name for picture in pictures]
    assert len(names) == len(set(names))
    for pose in waving.poses:
        assert f"starfish_pose_{pose}.png" in names
    for picture in pictures:
        if picture.name.endswith(".png"):
            with Image.open(io.BytesIO(picture.content)) as opened:
                opened.verify()
        else:
            assert ET.fromstring(picture.content).tag.endswith("svg")
    first = {picture.name: picture.content for picture in pictures}
    again = make_pictures(Told(), replace(waving, poses={}))
    assert again
    assert all(picture.content == first[picture.name] for picture in again)


@pytest.mark.slow
def test_a_report_tells_errors_and_tensions(waving: Robot) -> None:
    report = make_report(Told(), waving)
    text = report.content.decode()
    for pose in waving.poses.values():
        reached = hs.solve_ik(hs.Simulation(waving), pose)
        for error in reached.errors.values():
            assert f"{1e3 * error:.2f}" in text
        assert f"{max(reached.pose.tensions):.2f}" in text
    assert "http" not in text.replace("http://www.w3.org", "")


def test_a_report_of_a_bare_body_has_no_network(starfish: Robot) -> None:
    bare = replace(starfish.with_network((), ()), poses={})
    text = make_report(Told(), bare).content.decode()
    assert "The body" in text
    assert "Winches and cables" not in text


def test_a_pose_is_shown_as_the_winches_reach_it(exporter: Exporter) -> None:
    robot = exporter._document.robot
    name = next(iter(robot.poses))
    exporter.show(name)
    np.testing.assert_array_equal(exporter.shape().nodes, robot.body.mesh.nodes)
    assert not exporter.step(0.0)
    reached = hs.solve_ik(hs.Simulation(robot), robot.pose(name))
    assert exporter.shape().errors == pytest.approx(dict(reached.errors), abs=1e-4)
    assert exporter.shape().tensions.max() > 0
    exporter.show("")
    np.testing.assert_array_equal(exporter.shape().nodes, robot.body.mesh.nodes)
    exporter.show("no such pose")
    assert not exporter.step(1.0)
    np.testing.assert_array_equal(exporter.shape().nodes, robot.body.mesh.nodes)
