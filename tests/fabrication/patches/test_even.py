"""Evening out: slopes by finite differences, surfaces that lie flat, and Milnor's bound for caps of a sphere."""

import numpy as np
import pytest
from patch_bodies import cap, half_cone

from hydrostat.fabrication.patches.cutting import HELD, PatchEnergy, relax_patch
from hydrostat.fabrication.patches.flatten import distortion, flatten


def test_slopes_are_those_of_finite_differences():
    patch = flatten(cap(1.0, rings=4, columns=12))
    energy, rng = PatchEnergy(patch, 0.1), np.random.default_rng(0)
    places = patch.flat.ravel() + 0.05 * rng.normal(size=patch.flat.size)
    way = rng.normal(size=places.size)
    rise = (energy(places + 1e-5 * way)[0] - energy(places - 1e-5 * way)[0]) / 2e-5
    assert energy(places)[1] @ way == pytest.approx(rise, rel=1e-6)


def test_what_lies_flat_stays_so():
    """To what cloth feels: the sixth power hardly does below that."""
    assert distortion(relax_patch(flatten(half_cone()))).gives.max() < 0.02


def test_the_worst_of_a_cap_gives_less_and_no_less_than_milnor_allows():
    """No map of a cap has a lower ratio of largest to least stretch than angle / sin angle (Milnor 1969)."""
    plain = flatten(cap(1.2, rings=8, columns=24))
    even = relax_patch(plain)
    assert distortion(even).give(0.95) < 0.95 * distortion(plain).give(0.95)
    bent = distortion(even)
    assert bent.longest.max() / bent.shortest.min() > 0.97 * 1.2 / np.sin(1.2)
    assert even.flat_areas.min() > 0


def test_a_held_rim_keeps_its_length() -> None:
    """By definition: no edge is off by as much as two units; so seams of any two such patches can be eased in."""
    patch = relax_patch(flatten(cap(1.0, rings=6, columns=24)), ease=HELD)
    around, flat = patch.disc.vertices[patch.disc.rim], patch.flat[patch.disc.rim]
    lengths, kept = (np.linalg.norm(np.roll(line, -1, axis=0) - line, axis=1) for line in (around, flat))
    assert np.abs(np.log(kept / lengths)).max() < 2 * HELD
