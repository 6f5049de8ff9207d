"""A hand before a camera. Oracles: landmarks made by hand; stand-ins that have the names MediaPipe and OpenCV have."""

import re
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from hydrostat.errors import HydrostatError, InputError
from hydrostat.teleop import open_hand, open_source
from hydrostat.teleop.camera_hand import COUNT, CameraHand, HandLandmarks, bends
from hydrostat.teleop.source import DriveChannels
from hydrostat.version import install_command

PLACES = np.random.default_rng(2).normal(size=(COUNT, 3))


class Film:
    """A camera whose pictures have so many hands each; red, so that a swap of colors shows."""

    def __init__(self, number: int) -> None:
        self.number, self.hands, self.open = number, [1], number < 2

    def isOpened(self) -> bool:  # noqa: N802 (OpenCV's name)
        return self.open

    def set(self, key: str, value: int) -> None:
        assert (key, value) == ("buffer", 1)

    def read(self) -> tuple[bool, np.ndarray | None]:
        if not self.hands:
            return False, None
        picture = np.zeros((4, 6, 3), dtype=np.uint8)
        picture[:] = (self.hands.pop(0), 0, 200)  # blue, green, red, as OpenCV has them
        return True, picture

    def release(self) -> None:
        self.open = False


class Finder:
    """MediaPipe's hand landmarker: finds as many hands as a picture's blue says, and wants times that rise."""

    def __init__(self, options: SimpleNamespace) -> None:
        assert (options.running_mode, options.num_hands) == ("video", 1)
        if Path(options.base_options.model_asset_path).read_bytes() != b"model":
            raise RuntimeError("Unable to open zip archive.\nmore")
        self.last, self.closed = -1, False

    def detect_for_video(self, image: SimpleNamespace, milliseconds: int) -> SimpleNamespace:
        assert isinstance(milliseconds, int)
        assert milliseconds > self.last
        assert image.image_format == "rgb"
        assert image.data[0, 0, 0] == 200
        self.last = milliseconds
        hands = [[SimpleNamespace(x=x, y=y, z=z) for x, y, z in PLACES]] * int(image.data[0, 0, 2])
        return SimpleNamespace(hand_world_landmarks=hands)

    def close(self) -> None:
        self.closed = True


@pytest.fixture
def libraries(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stand-ins for both."""
    cv2, mediapipe = ModuleType("cv2"), ModuleType("mediapipe")
    cv2.__dict__.update(VideoCapture=Film, CAP_PROP_BUFFERSIZE="buffer", COLOR_BGR2RGB="swap")
    cv2.__dict__["cvtColor"] = lambda picture, how: picture[:, :, ::-1] if how == "swap" else None
    mediapipe.__dict__.update(Image=SimpleNamespace, ImageFormat=SimpleNamespace(SRGB="rgb"))
    tasks, python = ModuleType("mediapipe.tasks"), ModuleType("mediapipe.tasks.python")
    python.__dict__["BaseOptions"] = SimpleNamespace
    python.__dict__["vision"] = SimpleNamespace(
        HandLandmarkerOptions=SimpleNamespace,
        RunningMode=SimpleNamespace(VIDEO="video"),
        HandLandmarker=SimpleNamespace(create_from_options=Finder),
    )
    for module in (cv2, mediapipe, tasks, python):
        monkeypatch.setitem(sys.modules, module.__name__, module)


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "hand_landmarker.task"
    path.write_bytes(b"model")
    return path


@pytest.mark.usefixtures("libraries")
def test_pictures_become_bends(model: Path) -> None:
    hand = CameraHand(model, clock=lambda: 7.0)  # a clock that stands: MediaPipe's times rise all the same
    hand._camera.hands = [1, 1, 0, 1]
    for _ in range(2):
        reading = hand.read()
        assert reading.values == pytest.approx(bends(PLACES))
        assert (reading.stamp, len(reading.values)) == (7.0, len(HandLandmarks.names))
    with pytest.raises(HydrostatError, match="no hand is seen"):
        hand.read()
    hand.read()
    with pytest.raises(HydrostatError, match="gives no picture"):
        hand.read()
    finder = hand._finder
    hand.close()
    hand.close()
    assert finder.closed
    assert not hand._camera.open


@pytest.mark.usefixtures("libraries")
def test_words_open_it(model: Path) -> None:
    channels = DriveChannels(
        names=("a",), low=np.zeros(1), high=np.ones(1), rest=np.zeros(1), groups=((0,),)
    )  # a map is asked for before the camera is opened
    with pytest.raises(InputError, match="needs --map FILE"):
        open_source(f"camera:{model}", channels)
    for text, number in ((f"camera:{model}", 0), (f"camera:{model}@1", 1)):
        hand = open_hand(text)
        assert isinstance(hand, CameraHand)
        assert hand._camera.number == number
        hand.close()
    with pytest.raises(HydrostatError, match="camera 7 cannot be opened; another is named after @"):
        open_hand(f"camera:{model}@7")
    with pytest.raises(InputError, match="must end with a number"):
        open_hand(f"camera:{model}@x")
    with pytest.raises(InputError, match=r"needs MediaPipe's model file, camera:hand_landmarker\.task, or a port"):
        open_hand("camera:hand.jpg")
    with pytest.raises(InputError, match=r"elsewhere\.task: file not found"):
        open_hand("camera:elsewhere.task")
    model.write_bytes(b"a picture")
    with pytest.raises(HydrostatError, match=r"does not take .*task \(Unable to open zip archive\.\); is it"):
        open_hand(f"camera:{model}")


def test_without_the_library_it_is_told_in_a_line(model: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mediapipe", None)
    with pytest.raises(
        HydrostatError, match=f"a camera needs mediapipe .*: {re.escape(install_command('camera'))}"
    ) as told:
        open_hand(f"camera:{model}")
    assert "\n" not in str(told.value)
