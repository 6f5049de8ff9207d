"""Set-up of tests/conftest.py, for the shared code of the studies."""

import sys
from pathlib import Path

_TOP = Path(__file__).parents[2]
sys.path[:0] = [str(_TOP / folder) for folder in ("tests", "lab", "benchmarks", "lab/peers", "lab/peers/solvers")]

from run_setup import pytest_runtest_setup, unchecked  # noqa: E402, F401, I001 - before NumPy is imported

import shape_checks  # noqa: E402

for _package in ("hydrostat", "hydrostat_lab"):
    shape_checks.install(_package)
