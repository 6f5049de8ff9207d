"""The starfish, opened."""

import pytest
from builders import gallery_robot

from hydrostat.project import Work
from hydrostat.robot import Robot
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document


@pytest.fixture(scope="session")
def starfish() -> Robot:
    return gallery_robot("starfish")


@pytest.fixture
def document(starfish: Robot) -> Document:
    made = Document(Bell())
    made.open(Work(robot=starfish))
    return made
