"""Random contractions on every example: all converge. Oracle: residual, J and numbers judged afresh (benchmarks)."""

from pathlib import Path

import pytest
from robustness import example_folders, sweep  # pyright: ignore[reportMissingImports]


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize("folder", example_folders(), ids=lambda folder: folder.name)
def test_every_random_contraction_of_every_example_converges(folder: Path) -> None:
    found = sweep(folder, 50, seed=1)
    assert found.failures == []
    assert max(found.iterations) < 80
