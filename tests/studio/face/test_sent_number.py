"""Oracle: the values themselves."""

import pytest

from hydrostat.studio.face.messages import sent_number


@pytest.mark.parametrize(("value", "number"), [(3, 3.0), (-0.5, -0.5), ("22.5", 22.5), ("1e3", 1000.0)])
def test_numbers_are_taken(value: object, number: float) -> None:
    assert sent_number(value) == number


@pytest.mark.parametrize(
    "value", [None, True, "", "-", "left", [1.0], {"time": 1}, float("nan"), float("inf"), "nan", 10**400, 1e10]
)
def test_all_else_is_not(value: object) -> None:
    assert sent_number(value) is None
