"""A kit in two processes that hash in different ways."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

_PROGRAM = """
import hashlib
from plush_robots import crossed
from hydrostat.fabrication import build_kit

for path, content in sorted(build_kit(crossed()).files.items()):
    print(path, hashlib.sha256(content).hexdigest())
"""


def test_a_kit_is_the_same_bytes_whatever_the_hash_seed():
    """Oracle: two processes whose sets are in different orders, every file of a small kit."""
    folders = (Path(__file__).parent, Path(__file__).parents[1])
    runs = [
        subprocess.Popen(
            [sys.executable, "-c", _PROGRAM],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(map(str, folders))},
            stdout=subprocess.PIPE,
            text=True,
        )
        for seed in ("1", "7")
    ]
    one, two = (run.communicate(timeout=120)[0].splitlines() for run in runs)
    assert [run.returncode for run in runs] == [0, 0]
    assert "pattern/pattern.dxf" in {line.split()[0] for line in one}
    assert [line for line in one if line not in two] == []
    assert len(one) == len(two)
