"""`Reach`: all that a marker can reach, as a cloud that grows while it is found."""

from dataclasses import replace

import numpy as np

from hydrostat.arrays import Points
from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.posing.workspace import COUNT, sweep
from hydrostat.studio.view.things import Cloud

COLOUR = "#1787b8"


class Reach:
    """The cloud of one marker at a time.

    Attributes:
        marker: whose cloud it is; "" for none.
        running: whether it still grows.
    """

    def __init__(self, document: Document, jobs: Jobs) -> None:
        """Clouds of the robot of a document."""
        self._document, self._jobs = document, jobs
        self.marker, self.running = "", False
        self._robot: Robot | None = None
        self._cloud: Cloud | None = None

    def cloud(self, robot: Robot) -> Cloud | None:
        """What has been found so far, if it is of this body."""
        fits = self._robot is not None and self._robot.body.mesh is robot.body.mesh
        return self._cloud if fits else None

    @property
    def count(self) -> int:
        """How many places have been found."""
        return 0 if self._cloud is None else len(self._cloud.points)

    def start(self, marker: str, count: int = COUNT) -> None:
        """Begin to look where a marker can go.

        Raises:
            InputError: no such marker, no cables, or other work is in progress.
        """
        robot = self._document.robot
        if all(own.name != marker for own in robot.markers):
            raise InputError(f'there is no marker "{marker}"; choose one')
        if not robot.cables:
            raise InputError("this robot has no cables yet; find some in Design, or place them in Edit")
        free = replace(robot, cables=tuple(replace(cable, friction=0.0) for cable in robot.cables))
        self._jobs.start(
            f"Reach of {marker}",
            sweep,
            free,
            marker,
            self._document.work.wishes.tension,
            count,
            on_part=lambda points: self._grow(robot, points),
            on_end=self._end,
        )
        self.marker, self.running, self._robot, self._cloud = marker, True, robot, None
        self._document.bell.ring(Topic.THINGS)

    def stop(self) -> None:
        """End with what has been found."""
        if self.running:
            self._jobs.stop()

    def clear(self) -> None:
        """Show no cloud."""
        self.stop()
        self.marker, self._robot, self._cloud = "", None, None
        self._document.bell.ring(Topic.THINGS)

    def _grow(self, robot: Robot, points: Points) -> None:
        if self._robot is not robot:
            return
        known = points if self._cloud is None else np.concatenate([self._cloud.points, points])
        self._cloud = Cloud(name="reach", points=known, colour=COLOUR)
        self._document.bell.ring(Topic.THINGS)

    def _end(self) -> None:
        self.running = False
        self._document.bell.ring(Topic.THINGS)
