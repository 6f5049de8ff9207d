"""The starfish, opened."""

import pytest

from hydrostat.robot import Robot, gallery_folder, load_robot
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document
from hydrostat.studio.records.work import Work


@pytest.fixture(scope="session")
def starfish() -> Robot:
    return load_robot(gallery_folder("starfish"))


@pytest.fixture
def document(starfish: Robot) -> Document:
    made = Document(Bell())
    made.open(Work(robot=starfish))
    return made
