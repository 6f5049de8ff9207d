"""A studio as a program of its own, for requests as strangers would send them."""

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from toy_server import Server

TOY = Path(__file__).parent / "toy_studio.py"


@pytest.fixture(scope="session")
def serving() -> Iterator[Callable[..., Server]]:
    """Starts studios that listen at an address."""
    with ExitStack() as stack:

        def start(*arguments: str) -> Server:
            command = [sys.executable, str(TOY), *arguments]
            process = stack.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
            stack.callback(process.terminate)
            assert process.stdout is not None
            return Server(process.stdout.readline().strip(), process.pid)

        yield start


@pytest.fixture(scope="session")
def server(serving: Callable[..., Server]) -> Server:
    """A studio for this machine only."""
    return serving("127.0.0.1")
