"""One plush and one foam kit, made once for all tests of kits."""

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from hydrostat.fabrication import Kit


def _kit(name: str) -> "Kit":
    import hydrostat as hs
    from hydrostat.fabrication import build_kit
    from hydrostat.robot.gallery import gallery_folder

    return build_kit(hs.load_robot(gallery_folder(name)))


@pytest.fixture(scope="session")
def plush_kit() -> "Kit":
    """The kit of the starfish."""
    return _kit("starfish")


@pytest.fixture(scope="session")
def foam_kit() -> "Kit":
    """The kit of the fish tail."""
    return _kit("fish_tail")


@pytest.fixture
def refresh_references(request: pytest.FixtureRequest) -> bool:
    """Whether references are written anew."""
    return bool(request.config.getoption("--refresh-references"))
