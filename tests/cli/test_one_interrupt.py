"""One Ctrl-C raises, later ones do not; none does after the search. Oracle: real signals in a process of its own."""

import subprocess
import sys

import pytest

PROGRAM = """
import os, signal
from hydrostat.cli.one_interrupt import one_interrupt

def interrupt():
    os.kill(os.getpid(), signal.SIGINT)

try:
    with one_interrupt() as pass_over:
        try:
            {body}
        except KeyboardInterrupt:
            print("stopped")
        pass_over()
        interrupt()
        print("written")
    interrupt()
except KeyboardInterrupt:
    print("as before")
"""


@pytest.mark.parametrize(
    ("body", "words"),
    [("interrupt()", ["stopped", "written", "as before"]), ("pass", ["written", "as before"])],
)
def test_one_ctrl_c_stops_the_search(body: str, words: list[str]) -> None:
    found = subprocess.run(
        [sys.executable, "-c", PROGRAM.format(body=body)], capture_output=True, text=True, check=True
    )
    assert found.stdout.split("\n")[:-1] == words
    assert ("stopping" in found.stderr) == (words[0] == "stopped")
