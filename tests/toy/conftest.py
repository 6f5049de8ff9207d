"""A small toy, and pages that show it."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from hydrostat.arrays import Nodes
from hydrostat.learning import Samples
from hydrostat.robot import Robot, gallery_folder, load_robot
from hydrostat.simulation import Simulation
from hydrostat.toy import LearnedShape, learn_shape, sample_shapes, toy_page
from hydrostat.toy.toy_page import ToyPose

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

HOSTILE = '</script><script>window.hacked=1</script><img src=x onerror="window.hacked=1">@DATA@'
"""A name that would run if it were ever taken as markup."""

Open = Callable[..., "Page"]


@pytest.fixture(scope="session")
def starfish() -> Robot:
    """The starfish of the gallery under a hostile name."""
    robot = load_robot(gallery_folder("starfish"))
    return replace(robot, name=HOSTILE)


@pytest.fixture(scope="session")
def samples(starfish: Robot) -> Samples:
    return sample_shapes(starfish, 64, jobs=1)


@pytest.fixture(scope="session")
def rest(starfish: Robot) -> Nodes:
    return Simulation(starfish).rest.nodes


@pytest.fixture(scope="session")
def shape(samples: Samples, rest: Nodes) -> LearnedShape:
    return learn_shape(samples, rest, steps=400)


@pytest.fixture(scope="session")
def page_text(starfish: Robot, shape: LearnedShape) -> str:
    pose = ToyPose(name="</script><b>wave", contractions=(0.02, 0.0, 0.01))
    moves = [(0.0, np.zeros(3)), (1.0, np.array([0.01, 0.02, 0.0]))]
    return toy_page(starfish, shape, poses=[pose], moves=moves)


@pytest.fixture
def open_page(browser: "Browser", tmp_path_factory: pytest.TempPathFactory) -> Iterator[Open]:
    """Open a text as a page of a phone; what it complains about fails the test."""
    contexts, complaints = [], []

    def open_text(text: str, script: str = "") -> "Page":
        file = tmp_path_factory.mktemp("toy") / "toy.html"
        file.write_text(text, encoding="utf-8")
        context = browser.new_context(viewport={"width": 390, "height": 844})
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.add_init_script(script)
        page.goto(file.as_uri())
        return page

    yield open_text
    for context in contexts:
        context.close()
    assert complaints == []
