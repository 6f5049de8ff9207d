"""`Material`: what a body is made of; `Relaxation`: one branch of its fading memory."""

import math
from dataclasses import dataclass, replace
from typing import Self

from hydrostat.errors import InputError
from hydrostat.robot.checks import check_not_negative, check_positive

MOST_BRANCHES = 10  # a material has at most this many branches


@dataclass(frozen=True, kw_only=True)
class Relaxation:
    """A Maxwell branch, one term of a Prony series: a spring behind a dashpot, beside the elastic material.

    After a sudden shear the branch carries modulus * exp(-t / time) of its stress, so the material begins stiffer by
    `modulus` and settles to the elastic material alone.

    Attributes:
        modulus: shear modulus of the branch [Pa].
        time: after which its stress has fallen to 1/e [s].

    Raises:
        InputError: a number that is not finite and above 0.
    """

    modulus: float
    time: float

    def __post_init__(self) -> None:
        check_positive("modulus", self.modulus, "Pa")
        check_positive("time", self.time, "s")


@dataclass(frozen=True, kw_only=True)
class Material:
    """An isotropic material: elastic (R22), and optionally viscous.

    Attributes:
        young: Young's modulus [Pa].
        poisson: Poisson's ratio.
        density: mass density [kg/m^3].
        viscosity: shear viscosity of a dashpot beside the elastic material (Kelvin-Voigt) [Pa s].
        relaxation: Maxwell branches beside the elastic material, together a Prony series.
        largest_stretch: longest length over rest length for which the numbers are believed; None: unknown.
        largest_squeeze: share of its length by which it can be squeezed before the numbers are of no use, for a foam
            because its walls touch; None: unknown.
        name: name in the table, empty for a material given by its numbers.
        source: where the numbers come from.
        note: what they do not say, and who disagrees.

    Raises:
        InputError: a number out of its range.
    """

    young: float
    poisson: float
    density: float
    viscosity: float = 0.0
    relaxation: tuple[Relaxation, ...] = ()
    largest_stretch: float | None = None
    largest_squeeze: float | None = None
    name: str = ""
    source: str = ""
    note: str = ""

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
        if self.largest_stretch is not None and not 1 < self.largest_stretch < math.inf:
            raise InputError(f"largest_stretch must be above 1 (twice the length is 2), not {self.largest_stretch:g}")
        if self.largest_squeeze is not None and not 0 < self.largest_squeeze < 1:
            raise InputError(f"largest_squeeze must be above 0 and below 1, not {self.largest_squeeze:g}")

    @property
    def elastic(self) -> Self:
        """The same material without its viscosity and relaxation: what it settles to."""
        return replace(self, viscosity=0.0, relaxation=())

    @property
    def lame(self) -> tuple[float, float]:
        """Lame's parameters mu and lambda [Pa] (R22, E9)."""
        mu = self.young / (2 * (1 + self.poisson))
        return mu, self.young * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))
