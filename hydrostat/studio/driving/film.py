"""`Recorder`: films of the timeline, each made by `record_film` in a process of its own."""

from dataclasses import dataclass
from enum import StrEnum
from math import ceil
from pathlib import Path
from tempfile import TemporaryDirectory

from hydrostat.control import Timeline
from hydrostat.errors import InputError
from hydrostat.plot import Frame, find_ffmpeg, save_gif, save_glb, save_mp4, upright
from hydrostat.progress import Progress
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs, JobState, Report

WIDTH = 640  # width of its pictures [pixels]


class FilmKind(StrEnum):
    """Kind of file that a film is written to."""

    GIF = "gif"
    MP4 = "mp4"
    GLB = "glb"


STEPS = {FilmKind.GIF: 0.05, FilmKind.MP4: 0.04, FilmKind.GLB: 0.05}  # time of a frame [s]; a GIF counts in hundredths


def check_film(timeline: Timeline, kind: FilmKind) -> None:
    """Refuse what cannot be filmed before work begins (InputError: no keyframes, too long, or MP4 without ffmpeg)."""
    if not timeline.keys:
        raise InputError("no keyframes to record. Turn the knobs and press Add")
    longest_film = 60.0  # no film is longer [s]
    if timeline.seconds > longest_film:
        raise InputError(
            f"the timeline is {timeline.seconds:.1f} s long (maximum {longest_film:g} s for a video). Shorten it"
        )
    if kind is FilmKind.MP4:
        find_ffmpeg()


def film_kinds() -> list[FilmKind]:
    """Kinds that can be written on this machine; an MP4 only where ffmpeg is."""
    try:
        find_ffmpeg()
    except InputError:
        return [FilmKind.GIF, FilmKind.GLB]
    return list(FilmKind)


def record_film(report: Report, robot: Robot, timeline: Timeline, kind: FilmKind) -> bytes:
    """The film, as the bytes of a file of some kind; tells how far it is (InputError: as for `check_film`)."""
    check_film(timeline, kind)
    step = STEPS[kind]
    frames = film_frames(robot, timeline, step, report.progress)
    report.progress("drawing", 0, len(frames))
    with TemporaryDirectory(prefix="hydrostat-") as folder:
        path = Path(folder) / f"film.{kind}"
        if kind is FilmKind.GLB:
            save_glb(robot, frames, path, step=step)
        elif kind is FilmKind.GIF:
            save_gif(robot, frames, path, step=step, width=WIDTH, progress=report.progress)
        else:
            save_mp4(robot, frames, path, step=step, width=WIDTH, progress=report.progress)
        return path.read_bytes()


def film_frames(robot: Robot, timeline: Timeline, step: float, progress: Progress) -> list[Frame]:
    """The robot at equal times [s], each frame an equilibrium; one that has none shows the one before."""
    simulation, profile = Simulation(robot), timeline.profile([winch.name for winch in robot.winches])
    count = max(2, ceil(timeline.seconds / step - 1e-9) + 1)
    last, frames = None, []
    for number in range(count):
        pose = simulation.solve(profile.at(min(number * step, timeline.seconds)), start=last, strict=False)
        if pose.result.converged and upright(robot, pose):
            last = pose
        elif last is None:
            raise InputError("no equilibrium found at the start of the timeline. Start it closer to rest")
        frames.append(Frame.of(last))
        progress("solving", number + 1, count)
    return frames


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording:
    """A film to take home."""

    name: str  # of its file
    content: bytes  # of it


class Recorder:
    """Lets a film be made in another process."""

    def __init__(self, document: Document, jobs: Jobs) -> None:
        self.latest: Recording | None = None  # the film that was made last; None before the first
        self._document, self._jobs = document, jobs
        self._title = ""

    @property
    def state(self) -> JobState | None:
        """Progress of the film that was asked for last; None if other work has begun since."""
        state = self._jobs.state
        return state if state is not None and state.title == self._title else None

    def stop(self) -> None:
        """Give up a film that is being made."""
        if self.state is not None and self.state.running:
            self._jobs.stop()

    def start(self, kind: FilmKind) -> None:
        """Begin with a film of the timeline as it is now (InputError: it cannot be filmed, or other work runs)."""
        work = self._document.work
        check_film(work.timeline, kind)
        name = f"{work.robot.name}.{kind}"

        def done(content: bytes) -> None:
            self.latest = Recording(name=name, content=content)
            self._document.bell.ring(Topic.DRIVE)

        self._title = f"Recording {work.robot.name} ({kind})"
        self._jobs.start(self._title, record_film, work.robot, work.timeline, kind, on_done=done)
