"""`Material`, and the table of materials known by name."""

from dataclasses import dataclass
from types import MappingProxyType

from hydrostat.errors import InputError
from hydrostat.robot.checks import check_positive
from hydrostat.units import quote


@dataclass(frozen=True, kw_only=True)
class Material:
    """An isotropic elastic material (R22).

    Attributes:
        young: Young's modulus [Pa].
        poisson: Poisson's ratio.
        density: mass density [kg/m^3].
        name: name in the table, empty for a material given by its numbers.
        source: where the numbers come from.

    Raises:
        InputError: a number out of its range.
    """

    young: float
    poisson: float
    density: float
    name: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        check_positive("young", self.young, "Pa")
        if not 0 <= self.poisson < 0.5:
            raise InputError(
                f"poisson must be at least 0 and below 0.5, not {self.poisson:g}; nearly incompressible is 0.45"
            )
        check_positive("density", self.density, "kg/m^3")

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
