"""`Recorder`: films of the timeline, made while one goes on."""

from dataclasses import dataclass

from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.driving.record_work import FilmKind, check_film, record_film
from hydrostat.studio.jobs import Jobs, JobState


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording:
    """A film to take home.

    Attributes:
        name: of its file.
        content: of it.
    """

    name: str
    content: bytes


class Recorder:
    """Lets a film be made in another process.

    Attributes:
        latest: the film that was made last; None before the first.
    """

    def __init__(self, document: Document, jobs: Jobs) -> None:
        self.latest: Recording | None = None
        self._document, self._jobs = document, jobs
        self._title = ""

    @property
    def state(self) -> JobState | None:
        """How far the film is that was asked for last; None if other work has begun since."""
        state = self._jobs.state
        return state if state is not None and state.title == self._title else None

    def stop(self) -> None:
        """Give up a film that is being made."""
        if self.state is not None and self.state.running:
            self._jobs.stop()

    def start(self, kind: FilmKind) -> None:
        """Begin with a film of the timeline as it is now.

        Raises:
            InputError: it cannot be filmed, or other work is in progress.
        """
        work = self._document.work
        check_film(work.timeline, kind)
        name = f"{work.robot.name}.{kind}"

        def done(content: bytes) -> None:
            self.latest = Recording(name=name, content=content)
            self._document.bell.ring(Topic.DRIVE)

        self._title = f"Filming {work.robot.name} ({kind})"
        self._jobs.start(self._title, record_film, work.robot, work.timeline, kind, on_done=done)
