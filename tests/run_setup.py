"""Set-up that the tests of the package and of the studies share: one thread of BLAS, a cache, checks of shapes."""

import os
import tempfile
from collections.abc import Iterator

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

if "HYDROSTAT_CACHE" not in os.environ:  # meshed bodies, kept for this run and shared by its workers
    _CACHE = tempfile.TemporaryDirectory(prefix="hydrostat-tests-")
    os.environ["HYDROSTAT_CACHE"] = _CACHE.name

import pytest  # noqa: E402
import shape_checks  # noqa: E402
from jaxtyping import config  # noqa: E402


def pytest_runtest_setup() -> None:
    """Check the first calls of each function in each test."""
    shape_checks.begin_test()


@pytest.fixture
def unchecked() -> Iterator[None]:
    """Switch shape checks off: for many solves, whose shapes other tests check."""
    config.update("jaxtyping_disable", True)
    yield
    config.update("jaxtyping_disable", False)
