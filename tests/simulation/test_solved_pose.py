"""Distance of two poses. Oracle: a right triangle."""

import numpy as np

from hydrostat.simulation import largest_distance


def test_it_is_the_distance_of_one_node() -> None:
    """3, 4 and 5: not the largest component, nor the two nodes together."""
    one = np.zeros((3, 2))
    assert largest_distance(one, one + np.array([[3.0, 4.0], [4.0, 0.0], [0.0, 0.0]])) == 5.0
