"""The set-up of tests/conftest.py, for the shared code of the studies: shapes are checked, one thread of BLAS."""

import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

if "HYDROSTAT_CACHE" not in os.environ:  # meshed bodies, kept for this run and shared by its workers
    _CACHE = tempfile.TemporaryDirectory(prefix="hydrostat-tests-")
    os.environ["HYDROSTAT_CACHE"] = _CACHE.name

_TOP = Path(__file__).parents[2]
sys.path[:0] = [str(_TOP / "tests"), str(_TOP / "lab")]

import pytest  # noqa: E402
import shape_checks  # noqa: E402
from jaxtyping import config  # noqa: E402

for _package in ("hydrostat", "hydrostat_lab"):
    shape_checks.install(_package)


def pytest_runtest_setup() -> None:
    """Check the first calls of each function in each test."""
    shape_checks.begin_test()


@pytest.fixture
def unchecked() -> Iterator[None]:
    """No shape checks in this test: for many solves, whose shapes other tests check."""
    config.update("jaxtyping_disable", True)
    yield
    config.update("jaxtyping_disable", False)
