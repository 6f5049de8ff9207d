"""`Material`, and the table of materials known by name."""

from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Self

from hydrostat.errors import InputError
from hydrostat.robot.checks import check_not_negative, check_positive
from hydrostat.robot.relaxation import MOST_BRANCHES, Relaxation
from hydrostat.units import quote


@dataclass(frozen=True, kw_only=True)
class Material:
    """An isotropic material: elastic (R22), and optionally viscous.

    Attributes:
        young: Young's modulus [Pa].
        poisson: Poisson's ratio.
        density: mass density [kg/m^3].
        viscosity: shear viscosity of a dashpot beside the elastic material (Kelvin-Voigt) [Pa s].
        relaxation: Maxwell branches beside the elastic material, together a Prony series.
        name: name in the table, empty for a material given by its numbers.
        source: where the numbers come from.

    Raises:
        InputError: a number out of its range.
    """

    young: float
    poisson: float
    density: float
    viscosity: float = 0.0
    relaxation: tuple[Relaxation, ...] = ()
    name: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        check_positive("young", self.young, "Pa")
        if not 0 <= self.poisson < 0.5:
            raise InputError(
                f"poisson must be at least 0 and below 0.5, not {self.poisson:g}; nearly incompressible is 0.45"
            )
        check_positive("density", self.density, "kg/m^3")
        check_not_negative("viscosity", self.viscosity, "Pa s")
        if len(self.relaxation) > MOST_BRANCHES:
            raise InputError(f"relaxation must have at most {MOST_BRANCHES} branches, not {len(self.relaxation)}")

    @property
    def elastic(self) -> Self:
        """The same material without its viscosity and relaxation: what it settles to."""
        return replace(self, viscosity=0.0, relaxation=())

    @property
    def lame(self) -> tuple[float, float]:
        """Lame's parameters mu and lambda [Pa] (R22, E9)."""
        mu = self.young / (2 * (1 + self.poisson))
        return mu, self.young * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))


_TABLE = (
    Material(
        name="polyester fibre",
        young=30e3,
        poisson=0.3,
        density=40,
        source="assumed: loosely stuffed toy filling in a felt skin; the thesis gives no value (M1)",
    ),
    Material(
        name="flexfoam-it x",
        young=60e3,
        poisson=0.3,
        density=160,
        source="density from the thesis's table (N5); modulus and Poisson's ratio assumed, none is published (E30)",
    ),
)

MATERIALS = MappingProxyType({material.name: material for material in _TABLE})
"""Materials by name."""


def find_material(name: str) -> Material:
    """Material of the table.

    Raises:
        InputError: no material has this name.
    """
    material = MATERIALS.get(name.lower())
    if material is None:
        raise InputError(
            f"unknown material {quote(name)}; known are: {', '.join(MATERIALS)}; or give its young, poisson and density"
        )
    return material
