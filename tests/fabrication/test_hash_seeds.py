"""A kit in two processes that hash in different ways."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import pytest
from plush_robots import crossed

from hydrostat.fabrication import build_kit

pytestmark = pytest.mark.slow

_PROGRAM = "from test_hash_seeds import list_hashes; print(*list_hashes(), sep='\\n')"


def list_hashes() -> list[str]:
    """Each file of a small kit with its hash."""
    files = sorted(build_kit(crossed()).files.items())
    return [f"{path} {hashlib.sha256(content).hexdigest()}" for path, content in files]


def test_a_kit_is_the_same_bytes_whatever_the_hash_seed():
    """Oracle: a process whose sets are in another order than here, every file of a small kit."""
    seed = "7" if os.environ.get("PYTHONHASHSEED") == "1" else "1"
    folders = (Path(__file__).parent, Path(__file__).parents[1])
    environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(map(str, folders))}
    other = subprocess.run(
        [sys.executable, "-c", _PROGRAM], env=environment, stdout=subprocess.PIPE, text=True, check=True
    )
    here = list_hashes()
    assert "pattern/pattern.dxf" in {line.split()[0] for line in here}
    assert other.stdout.splitlines() == here
