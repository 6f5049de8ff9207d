"""Numbers by name. Oracles: the plain array, the order of the robot's winches."""

import pickle

import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.named_vector import NamedVector

NAMED = NamedVector(np.array([1.0, 2.5, -3.0]), ["left", "right", "feet"])


def test_it_is_read_by_name_and_by_number() -> None:
    assert NAMED["right"] == NAMED[1] == 2.5
    assert isinstance(NAMED["right"], float)
    assert NAMED.to_dict() == {"left": 1.0, "right": 2.5, "feet": -3.0}
    with pytest.raises(InputError, match='unknown name "tail"'):
        _ = NAMED["tail"]


def test_parts_and_results_are_plain_arrays() -> None:
    """A name must never be kept by a number that has moved."""
    for plain in (2 * NAMED, NAMED[::-1], NAMED[NAMED > 0], np.abs(NAMED), NAMED - NAMED):
        assert type(plain) is np.ndarray
    assert isinstance(NAMED.max(), float)
    assert NAMED @ NAMED == 1.0 + 6.25 + 9.0
    with pytest.raises(InputError, match="none"):
        _ = NAMED.copy()["left"]


def test_it_is_pickled_with_its_names() -> None:
    assert pickle.loads(pickle.dumps(NAMED))["feet"] == -3.0
