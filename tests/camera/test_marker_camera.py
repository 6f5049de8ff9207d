"""A camera that corrects a robot that plays. Oracle: a renderer of its own, and a hidden robot of another material."""

import re
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import routed_strip

pytest.importorskip("cv2", reason="extra photos (OpenCV) is not installed")

from photographs import Camera, Scene, photograph

from hydrostat.camera import MarkerCamera
from hydrostat.camera.marker_view import MarkerView
from hydrostat.cli.main import main
from hydrostat.control import MarkerFeedback, MarkerPath, MarkerSight, Motors, Player, SimulatedLink
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Robot
from hydrostat.simulation import ContractionProfile, Simulation

UPPER = ((0.0083, 0.0137), (0.0587, 0.0161), (0.1129, 0.0147), (0.1833, 0.0143))
CAMERA = Camera.above((0.01, 0.0), 0.3, 5, 40, roll=90, width=640, height=480, focal=575.0, center=(325.0, 236.0))
PROFILE = ContractionProfile(times=np.array([0.0, 0.6, 1.0]), values=np.array([[0.0], [0.008], [0.008]]))


def strip(young: float = 1.0) -> Robot:
    """A flat strip that sags, with one cable; Young's modulus over that of the model."""
    robot = routed_strip({"up": UPPER}, gravity=(0.0, -9.81), travel=0.06, release=0.005)
    material = robot.body.material
    return replace(robot, body=replace(robot.body, material=replace(material, young=young * material.young)))


def render(robot: Robot, pose: object, seed: int = 0) -> np.ndarray:
    """A frame of a robot in a pose."""
    scene = Scene(robot, (0.01, -0.1, 90.0), robot.body.thickness or 0.0)
    return photograph(CAMERA, scene.planes(pose.nodes, pose.markers), seed=seed, over=1)


class RenderedEye:
    """Frames of a hidden robot, rendered and read; each arrives when it is asked for."""

    def __init__(self, motors: Motors, gain: float) -> None:
        self._motors, self._gain, self._now = motors, gain, 0.0
        self._hidden = Simulation(strip(0.6))
        self._pose, self._newest, self._next = self._hidden.rest, None, -np.inf
        frames = [render(self._hidden.robot, self._pose, seed) for seed in range(2)]
        self._view = MarkerView(frames, self._hidden.rest)

    def wait(self, seconds: float) -> None:
        self._now += seconds

    def clock(self) -> float:
        return self._now

    def pose(self) -> object:
        self._pose = self._hidden.solve(self._gain * self._motors.places, start=self._pose)
        return self._pose

    def look(self) -> MarkerSight | None:
        if self._now >= self._next:
            self._next = self._now + 1 / 15
            pixels = render(self._hidden.robot, self.pose(), int(100 * self._now))
            self._newest = MarkerSight(self._now, self._view.find(pixels))
        return self._newest


@pytest.mark.slow
def test_rendered_frames_correct_a_hidden_material() -> None:
    """A softer body on a smaller spool: the tip ends nearer to its simulated place than without the camera."""
    left = {}
    for is_seeing in (False, True):
        motors = Motors(strip().winches, SimulatedLink(np.zeros(1)))
        eye, player = RenderedEye(motors, 0.85), Player()
        player.rounds = 1
        feedback = MarkerFeedback(strip(), MarkerPath.along(strip(), PROFILE), eye, lag=0.02)
        player.run(motors, PROFILE, feedback=feedback if is_seeing else None, clock=eye.clock, wait=eye.wait)
        wanted = Simulation(strip()).solve({"up": 0.008}).markers["tip"]
        left[is_seeing] = float(np.linalg.norm(eye.pose().markers["tip"] - wanted))
    assert left[True] < left[False] / 4
    assert feedback.rate >= 15 - 2


class Frames:
    """Frames from a list, then none."""

    def __init__(self, frames: list[np.ndarray]) -> None:
        self._frames = list(frames)
        self.closed = False

    def read(self) -> np.ndarray | None:
        time.sleep(0.01)
        return self._frames.pop(0) if self._frames else None

    def close(self) -> None:
        self.closed = True


@pytest.mark.slow
def test_a_camera_looks_in_a_thread_and_says_what_is_wrong() -> None:
    robot, pose = strip(), Simulation(strip()).rest
    frame = render(robot, pose)
    camera = MarkerCamera(Frames([frame] * 7), pose, MarkerSight)
    until = time.monotonic() + 20
    while not camera.trouble and time.monotonic() < until:
        time.sleep(0.02)
    found = camera.look()
    assert found is not None
    away = max(np.linalg.norm(found.places[name] - at) for name, at in pose.markers.items())
    assert away < 1e-3  # 0.5 mm a pixel, and one view does not show the focal length
    assert camera.trouble == "the camera gives no more pictures"
    camera.close()
    view = MarkerView([frame], pose)
    with pytest.raises(InputError, match="the camera or the board has moved"):
        view.find(np.roll(frame, 8, axis=1))
    assert view.find(np.full_like(frame, 90)) == {}
    with pytest.raises(InputError, match="0 tags of the board in sight"):
        MarkerView([np.full_like(frame, 90)], pose)
    with pytest.raises(HydrostatError, match="gives no pictures"):
        MarkerCamera(Frames([frame] * 2), pose, MarkerSight)


class StillFrames:
    """A camera that shows one picture for ever, 30 times a second."""

    def __init__(self, frame: np.ndarray) -> None:
        self._frame = frame

    def read(self) -> np.ndarray:
        time.sleep(1 / 30)
        return self._frame

    def close(self) -> None:
        """There is nothing to release."""


@pytest.mark.slow
def test_play_corrects_emulated_motors_by_a_camera(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A picture that never changes. Oracle: it is as far from the simulation as the simulated markers have moved."""
    rest = Simulation(strip()).rest
    moved = Simulation(strip()).solve({"up": 0.006}).markers
    away = 1e3 * np.mean([np.linalg.norm(at - rest.markers[name]) for name, at in moved.items()])
    frame = render(strip(), rest)
    monkeypatch.setattr("hydrostat.robot.load_robot", lambda _: strip(), raising=False)
    monkeypatch.setattr("hydrostat.camera.CameraFrames", lambda _: StillFrames(frame), raising=False)
    table = tmp_path / "moves.csv"
    table.write_text("time_s,up_mm\n0,0\n0.3,6\n1.5,6\n")
    options = ["--motors", "emulated", "--camera", "0"]
    monkeypatch.setattr(sys, "argv", ["hydrostat", "play", str(tmp_path), str(table), *options])
    with pytest.raises(SystemExit) as stop:
        main()
    output = capsys.readouterr()
    assert (stop.value.code or 0, output.err) == (0, "")
    told = re.search(r"emulated: markers (\S+) mm from the simulation in the second half", output.out)
    assert told is not None, output.out
    assert float(told[1]) == pytest.approx(away, abs=1.0)  # one view does not show the focal length
    command = re.search(r"motors holding at up (\S+) mm", output.out)
    assert command is not None, output.out
    assert float(command[1]) > 6.0 + 3.0  # more is taken in, as the tip seems to stay
