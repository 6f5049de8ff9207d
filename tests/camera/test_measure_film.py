"""Markers from a film. Oracle: rendered frames of simulated poses, and the table of moves that they follow."""

from pathlib import Path

import numpy as np
import pytest
from builders import routed_strip

pytest.importorskip("cv2", reason="extra photos (OpenCV) is not installed")

import cv2
from photographs import Camera, Scene, photograph

from hydrostat.camera import FilmOptions, LensFile, PhotoOptions, measure_film
from hydrostat.camera.lens import Lens
from hydrostat.errors import InputError
from hydrostat.identification import read_measurements
from hydrostat.robot import Robot
from hydrostat.simulation import ContractionProfile, Simulation

UPPER = ((0.0083, 0.0137), (0.0587, 0.0161), (0.1129, 0.0147), (0.1833, 0.0143))
PULLS = (0.0, 0.003, 0.006)
RATE, HELD, BEGIN = 10, 5, 0.4  # frames a second, frames of each pose, and seconds before the moves begin
CAMERA = Camera.above((0.01, 0.0), 0.27, 4, 30, roll=90, width=960, height=720, focal=862.0, center=(491.0, 352.0))


@pytest.fixture(scope="module")
def robot() -> Robot:
    """A flat strip with one cable."""
    return routed_strip({"up": UPPER}, slack=0.001)


@pytest.fixture(scope="module")
def film(robot: Robot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three poses of half a second each after a start at rest; in the last half second the camera is turned."""
    scene, simulation = Scene(robot, (0.01, -0.1, 90.0), robot.body.thickness or 0.0), Simulation(robot)
    pictures = []
    for index, pull in enumerate((*PULLS, PULLS[-1])):
        pose = simulation.solve({"up": pull})
        camera = CAMERA if index < len(PULLS) else Camera(**{**CAMERA.__dict__, "center": (501.0, 352.0)})
        pictures.append(photograph(camera, scene.planes(pose.nodes, pose.markers), seed=index, over=1))
    file = tmp_path_factory.mktemp("film") / "moves.mp4"
    video = cv2.VideoWriter(str(file), cv2.VideoWriter_fourcc(*"mp4v"), RATE, pictures[0].shape[::-1])
    for picture, count in zip(pictures, (HELD + round(BEGIN * RATE), HELD, HELD, HELD), strict=True):
        for _ in range(count):
            video.write(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR))
    video.release()
    return file


def moves(seconds: float = 1.4) -> ContractionProfile:
    """Steps to the poses of the film."""
    times = [0.0, 0.49, 0.5, 0.99, 1.0, seconds]
    return ContractionProfile(times=np.array(times), values=np.repeat(PULLS, 2)[:, None])


@pytest.mark.slow
def test_a_film_gives_markers_in_time(robot: Robot, film: Path, tmp_path: Path) -> None:
    known = LensFile(lens=Lens(CAMERA.focal, CAMERA.center, CAMERA.distortion), size=(960, 720))
    options = FilmOptions(every=0.2, start=BEGIN, photo=PhotoOptions(lens=known))
    found = measure_film(robot, film, moves(), options)
    assert found.warnings == []
    assert found.times == pytest.approx(np.arange(8) * 0.2, abs=0.01)
    table = tmp_path / "seen.csv"
    table.write_bytes(found.text(robot))
    read = read_measurements(table, robot)
    assert read.markers == ("root", "middle", "tip")
    assert read.commands[:, 0] == pytest.approx(np.repeat(PULLS, (3, 2, 3)))
    simulation = Simulation(robot)
    for (pull,), places in zip(read.commands, read.places, strict=True):
        pose = simulation.solve({"up": float(pull)})
        wanted = np.array([pose.markers[name] for name in read.markers])
        assert np.linalg.norm(places - wanted, axis=1).max() < 0.5e-3


@pytest.mark.slow
def test_faults_of_films_are_said_in_one_line(robot: Robot, film: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"moves.mp4, 1.90 s: the camera or the board has moved"):
        measure_film(robot, film, moves(2.0), FilmOptions(every=0.5, start=0.4))
    with pytest.raises(InputError, match="has no frame after 9 s"):
        measure_film(robot, film, moves(), FilmOptions(start=9.0))
    (tmp_path / "none.mp4").write_bytes(b"no film")
    for name, words in (("none.mp4", "cannot be read as a film"), ("gone.mp4", "no such file")):
        with pytest.raises(InputError, match=words):
            measure_film(robot, tmp_path / name, moves())
    cropped = LensFile(lens=Lens(800.0, (400.0, 400.0), (0.0, 0.0)), size=(800, 800))
    with pytest.raises(InputError, match="is of pictures of 800 x 800 pixels, not 960 x 720"):
        measure_film(robot, film, moves(), FilmOptions(photo=PhotoOptions(lens=cropped)))


def test_a_lens_is_kept_and_scaled(tmp_path: Path) -> None:
    """Oracle: the same points in a picture of half the size."""
    known = LensFile(lens=Lens(1150.0, (655.0, 470.0), (0.06, -0.09)), size=(1280, 960))
    file = tmp_path / "a.lens.json"
    file.write_bytes(known.text())
    read = LensFile.read(file)
    assert read == known
    points = np.array([[0.1, 0.05, 1.0], [-0.2, 0.3, 1.1]])
    half = read.scale_to((640, 480)).project(points)
    assert half == pytest.approx((known.lens.project(points) + 0.5) / 2 - 0.5)
    for text in ("{}", "[1]", '{"focal": 1, "center": [1], "distortion": [0, 0], "size": [1, 1]}'):
        file.write_text(text)
        with pytest.raises(InputError, match="is no lens"):
            LensFile.read(file)
