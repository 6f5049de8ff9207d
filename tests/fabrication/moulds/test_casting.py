"""Amounts: oracles are products of volume and density."""

import pytest

from hydrostat.fabrication.moulds.casting import make_casting
from hydrostat.robot import MATERIALS, Material

LITRE = 1e6


def test_foam_weighs_its_density_and_a_tenth_more() -> None:
    casting, problems = make_casting(MATERIALS["flexfoam-it x"], LITRE, pours=())
    assert problems == ()
    assert casting.body.mass == pytest.approx(160 * 1.1)
    assert casting.body.part_a == pytest.approx(casting.body.part_b)
    assert casting.expansion == pytest.approx(1100 / 160)
    assert casting.silicone == ()
    assert casting.silicone_cost == 0
    assert "2 h at 25 C" in casting.times[0][1]


def test_silicone_for_two_pours() -> None:
    casting, _ = make_casting(MATERIALS["flexfoam-it x"], LITRE, pours=(LITRE, 0.5 * LITRE))
    first, second = casting.silicone
    assert first.mass == pytest.approx(1180 * 1.1)
    assert second.mass == pytest.approx(first.mass / 2)
    assert first.part_a == pytest.approx(10 * first.part_b)
    assert "check yours" in " ".join(casting.notes)
    times = " ".join(" ".join(line) for line in casting.times)
    assert "24 h" in times
    assert "6 h at 60 C" in times


def test_rubber_does_not_rise() -> None:
    casting, problems = make_casting(MATERIALS["ecoflex 00-30"], LITRE, pours=())
    assert casting.expansion == 1
    assert casting.body.mass == pytest.approx(1070 * 1.1)
    assert problems == ()


@pytest.mark.parametrize(
    "material", [MATERIALS["polyester fibre"], Material(young=1e4, poisson=0.3, density=50)], ids=["fibre", "numbers"]
)
def test_what_is_not_poured_is_a_problem(material: Material) -> None:
    casting, (problem,) = make_casting(material, LITRE, pours=())
    assert casting.body.material == "flexfoam-it x"
    assert "simulate again" in problem
    assert f"{material.density:.0f} kg/m^3" in problem


def test_platinum_silicone_does_not_cure_in_a_mould_that_tin_cured():
    """Oracle: Smooth-On, FAQ 129."""
    cast, foam = MATERIALS["ecoflex 00-30"], MATERIALS["flexfoam-it x"]
    assert "does not cure against Mold Max 30" in make_casting(cast, 1e5, pours=(1e5, 1e5))[1][0]
    assert make_casting(cast, 1e5, pours=())[1] == ()
    assert make_casting(foam, 1e5, pours=(1e5, 1e5))[1] == ()
