"""`run_in_own_time`: a command in a time that passes only while it waits.

Emulated motors live by the clock. A busy machine that tells them nothing for long stops them, as it would real ones.
"""

import subprocess
import sys

PROGRAM = "import hydrostat.cli.waiting as w; w.NOTICE_DELAY = 1e6; from hydrostat.cli.main import main; main()"
"""The command line, which never says that it is still at work."""

_OWN_TIME = """
import time
passed = [1000.0]

def tell(which=None):
    passed[0] += 1e-6
    return passed[0]

def sleep(seconds):
    passed[0] += seconds

time.monotonic, time.clock_gettime, time.sleep = tell, tell, sleep
"""


def run_in_own_time(*words: object) -> tuple[int, str, str]:
    """Exit code, output and complaints."""
    command = [sys.executable, "-c", _OWN_TIME + PROGRAM, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    return done.returncode, done.stdout, done.stderr
