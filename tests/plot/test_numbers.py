"""Errors in words. Oracle: by hand."""

import pytest

from hydrostat.plot.report_tables import millimetres


@pytest.mark.parametrize(
    ("error", "words"),
    [(0.0123456, "12.35"), (1e-4, "0.10"), (9.87e-5, "0.099"), (1.234e-6, "0.0012"), (0.0, "0.00")],
)
def test_millimetres(error: float, words: str) -> None:
    assert millimetres(error) == words
