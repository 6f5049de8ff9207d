"""Oracles: Pillow and the head of a GLB for what was written, `Simulation.solve` for what is in it."""

from io import BytesIO
from threading import Event

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.control import Key, Timeline
from hydrostat.errors import InputError
from hydrostat.project import Work
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document
from hydrostat.studio.driving.film import FilmKind, Recorder, check_film, film_frames, film_kinds, record_film
from hydrostat.studio.jobs import Jobs

pytestmark = pytest.mark.usefixtures("unchecked")

SHORT = Timeline(keys=(Key(time=0.0, contractions={}), Key(time=0.4, contractions={"left": 0.02})), length=0.4)


@pytest.fixture(scope="module")
def starfish() -> Robot:
    return gallery_robot("starfish")


class Told:
    """What was reported."""

    def __init__(self) -> None:
        self.lines: list[tuple[str, int, int]] = []

    def progress(self, stage: str, done: int, total: int) -> None:
        self.lines.append((stage, done, total))

    def part(self, value: object) -> None:
        raise AssertionError("a film has no parts")

    def finish(self) -> None:
        raise AssertionError("a film is whole or not at all")


def test_frames_are_equilibria_at_equal_times(starfish: Robot) -> None:
    told = Told()
    frames = film_frames(starfish, SHORT, 0.1, told.progress)
    assert len(frames) == 5
    for index, frame in enumerate(frames):
        found = Simulation(starfish).solve({"left": 0.005 * index})
        assert np.abs(frame.nodes - found.nodes).max() < 1e-6
    assert told.lines[-1] == ("solving", 5, 5)


@pytest.mark.slow
def test_a_gif_and_a_glb_are_written(starfish: Robot) -> None:
    from PIL import Image

    told = Told()
    with Image.open(BytesIO(record_film(told, starfish, SHORT, FilmKind.GIF))) as film:
        assert film.format == "GIF"
        assert getattr(film, "n_frames", 1) == 9
    assert record_film(Told(), starfish, SHORT, FilmKind.GLB)[:4] == b"glTF"
    assert {line[0] for line in told.lines} >= {"solving", "drawing"}


def test_what_cannot_be_filmed_is_told_at_once(starfish: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    document = Document(Bell())
    document.open(Work(robot=starfish))
    jobs = Jobs(document.bell)
    with pytest.raises(InputError, match="no keyframes to record"):
        Recorder(document, jobs).start(FilmKind.GIF)
    assert not jobs.is_running
    with pytest.raises(InputError, match=r"61\.0 s long \(maximum 60 s for a video\)"):
        check_film(Timeline(keys=SHORT.keys, length=61.0), FilmKind.GLB)
    monkeypatch.setattr("shutil.which", lambda program: None)
    with pytest.raises(InputError, match="needs the program ffmpeg"):
        check_film(SHORT, FilmKind.MP4)
    assert film_kinds() == [FilmKind.GIF, FilmKind.GLB]
    monkeypatch.setattr("shutil.which", lambda program: f"/usr/bin/{program}")
    assert film_kinds() == [*FilmKind]


@pytest.mark.slow
def test_a_film_is_made_in_another_process(starfish: Robot) -> None:
    document = Document(Bell())
    document.open(Work(robot=starfish, timeline=SHORT))
    jobs, ended = Jobs(document.bell), Event()
    document.bell.listen(lambda topic: ended.set() if not jobs.is_running else None)
    recorder = Recorder(document, jobs)
    recorder.start(FilmKind.GLB)
    assert ended.wait(300)
    assert jobs.state is not None
    assert jobs.state.error == ""
    assert recorder.latest is not None
    assert recorder.latest.name == "starfish.glb"
    assert recorder.latest.content[:4] == b"glTF"
