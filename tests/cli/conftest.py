"""Running the command as a user does, in this process."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from hydrostat.cli.main import main
from hydrostat.robot import gallery_folder

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def _quiet_while_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    """No word of what takes long, which a busy machine would put among what is asked for; test_waiting.py has it."""
    monkeypatch.setattr("hydrostat.cli.waiting.NOTICE_DELAY", 1e6)


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Exit code, output and errors of `hydrostat` with some arguments."""

    def call(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["hydrostat", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            main()
        output = capsys.readouterr()
        return int(stop.value.code or 0), output.out, output.err

    return call


@pytest.fixture
def starfish() -> Path:
    return gallery_folder("starfish")
