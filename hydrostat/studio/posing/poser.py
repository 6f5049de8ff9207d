"""`Poser`: the stage "pose"."""

from collections.abc import Sequence

from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.stage import Stage
from hydrostat.studio.view.robot_things import robot_things
from hydrostat.studio.view.shape import Shape, rest_shape
from hydrostat.studio.view.things import Thing


class Poser(Stage):
    """To be written."""

    def __init__(self, document: Document, jobs: Jobs) -> None:
        self._document, self._jobs = document, jobs

    def shape(self) -> Shape:
        """The rest shape."""
        return rest_shape(self._document.robot)

    def things(self) -> Sequence[Thing]:
        """All parts of the robot."""
        return robot_things(self._document.robot)
