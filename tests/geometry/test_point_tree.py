"""The tree of points against SciPy's public class."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from hydrostat.geometry import thickness
from hydrostat.geometry.thickness import build_point_tree


@pytest.mark.parametrize("alone", [True, False], ids=["compiled class", "by SciPy"])
def test_neighbors_and_pairs_are_those_of_scipy(alone: bool, monkeypatch: pytest.MonkeyPatch):
    if not alone:
        monkeypatch.setattr(thickness, "load_compiled", lambda name: None)
    one, other = np.random.default_rng(1).random((2, 200, 3))
    found, expected = (
        make(one).sparse_distance_matrix(make(other), 0.2, output_type="ndarray") for make in (build_point_tree, KDTree)
    )
    np.testing.assert_array_equal(found, expected)
    for part, known in zip(build_point_tree(one).query(other, k=5), KDTree(one).query(other, k=5), strict=True):
        np.testing.assert_array_equal(part, known)
