"""Array shapes and types of what is public are checked while the tests run; one thread of BLAS; two kits."""

import gc
import shutil
import sys
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

_HERE = Path(__file__).parent
sys.path[:0] = [str(_HERE), str(_HERE / "fabrication"), str(_HERE.parent / "benchmarks"), str(_HERE.parent / "docs")]

from run_setup import pytest_runtest_setup, unchecked  # noqa: E402, F401, I001 - before NumPy is imported

import pytest  # noqa: E402
import shape_checks  # noqa: E402

if TYPE_CHECKING:
    from playwright.sync_api import Browser

    from hydrostat.fabrication import Kit

shape_checks.install("hydrostat")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Flags: one for tests that compare with reference files, one for the hour's work."""
    parser.addoption("--refresh-references", action="store_true", help="write the reference files again")
    parser.addoption("--quick", action="store_true", help="each test with its first case only, and none that is slow")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Look for no garbage while tests are collected, nor later among what they are: a third of the time it takes."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_unconfigure() -> None:
    """Let all be cleared away at the end, so that nobody reports it as leaked."""
    gc.unfreeze()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """With --quick, keep the first case of each test that is not marked as slow."""
    if not config.getoption("--quick"):
        return
    kept: dict[str, pytest.Item] = {}
    for item in items:
        if item.get_closest_marker("slow") is None:
            kept.setdefault(item.nodeid.split("[")[0], item)
    config.hook.pytest_deselected(items=[item for item in items if kept.get(item.nodeid.split("[")[0]) is not item])
    items[:] = kept.values()


def _kit(name: str) -> "Kit":
    from builders import gallery_robot

    from hydrostat.fabrication import build_kit

    return build_kit(gallery_robot(name))


@pytest.fixture(scope="session")
def plush_kit() -> "Kit":
    """The kit of the starfish."""
    return _kit("starfish")


@pytest.fixture(scope="session")
def foam_kit() -> "Kit":
    """The kit of the fish tail."""
    return _kit("fish_tail")


@pytest.fixture(scope="session")
def browser() -> "Iterator[Browser]":
    """Chromium, once for all tests: Playwright runs once in a process. Where there is none they are skipped."""
    names = ("chromium", "chromium-browser", "google-chrome")
    chromium = next((found for name in names if (found := shutil.which(name))), "")
    if not chromium:
        pytest.skip("there is no Chromium; install Debian's package chromium")
    from playwright.sync_api import sync_playwright

    flags = ["--no-sandbox", "--enable-unsafe-swiftshader"]
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium, args=flags)
        yield opened
        opened.close()


@pytest.fixture
def refresh_references(request: pytest.FixtureRequest) -> bool:
    """Whether references are written again."""
    return bool(request.config.getoption("--refresh-references"))
