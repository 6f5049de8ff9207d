"""A studio as a program of its own, and a browser. Where there is no Chromium these tests are skipped."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from hydrostat.robot import gallery_folder

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

RUN = "from hydrostat.cli.main import main; main()"

TIMEOUT = 300_000
"""The most that a test waits for anything [ms]: the machine may be busy, and compile."""

Open = Callable[..., "Page"]


@contextmanager
def running(*arguments: str, state: Path, cache: Path) -> Iterator[str]:
    """A studio that runs; its address."""
    command = [sys.executable, "-c", RUN, "studio", *arguments, "--no-browser"]
    environment = {**os.environ, "XDG_STATE_HOME": str(state), "XDG_CACHE_HOME": str(cache)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment, cwd=state) as process:
        assert process.stdout is not None
        line = process.stdout.readline()
        assert "http://" in line, line
        try:
            yield next(word for word in line.split() if word.startswith("http://"))
        finally:
            process.terminate()
            process.wait(timeout=300)


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where programs keep what can be made again: empty at first, and warm for all but the first studio."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="session")
def rooms(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> Iterator[str]:
    """Address of one studio for many tests: whoever opens it has a room with a starfish."""
    starfish = str(gallery_folder("starfish"))
    with running(starfish, "--rooms", state=tmp_path_factory.mktemp("rooms"), cache=cache) as address:
        yield address


@pytest.fixture
def studio(tmp_path: Path, cache: Path) -> Callable[..., Any]:
    """Start a studio with some arguments and without a past, as a context that gives its address."""
    return lambda *arguments: running(*arguments, state=tmp_path, cache=cache)


@pytest.fixture
def window(browser: "Browser") -> Iterator[Open]:
    """Open a window on an address, with all that it complained about in `complaints`."""
    contexts, broken = [], list[str]()

    def open_window(address: str, *, tour: bool = False) -> "Page":
        context = browser.new_context(viewport={"width": 1280, "height": 800}, accept_downloads=True)
        contexts.append(context)
        if not tour:
            context.add_init_script("localStorage.setItem('hydrostat-tour', '1')")
        page = context.new_page()
        page.set_default_timeout(TIMEOUT)
        page.on("pageerror", lambda error: broken.append(str(error)))
        page.goto(address)
        return page

    yield open_window
    for context in contexts:
        context.close()
    assert not [error for error in broken if "$refs" in error]  # scripts that run before the page is there
