"""`Material`: an isotropic material, elastic or viscous, as rubber or as foam."""

import math
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Self

from hydrostat.errors import InputError
from hydrostat.given import check_not_negative, check_number, check_positive

_ALLARD = "J. F. Allard, N. Atalla, Propagation of Sound in Porous Media, 2009, table"
_LCE = "Impact damping and vibration attenuation in nematic liquid crystal elastomers, Nature Communications 12, 2021"
_SILICONE = (
    0.1,
    "assumed, as no source was found: the maximum of natural rubber, 0.02 to 0.1 (from a page without a source)",
)
_CASTABLE = 0.1, "assumed: that of polyurethane foam"
_TPU = 0.1, "assumed, as no source was found"

LOSSES = MappingProxyType(
    {
        "polyester fibre": (
            0.5,
            f"assumed: that of a carpet of 60 kg/m^3 and 20 kPa, 0.5 ({_ALLARD} 11.7); stiff glass wool has 0.1 (11.8)",
        ),
        "flexfoam-it iii": _CASTABLE,
        "flexfoam-it v": (
            0.1,
            "assumed: that of polyurethane foam. The fit to its motion has 6.5 Pa s: 0.1 at 340 Hz, 0.0006 at 2 Hz",
        ),
        "flexfoam-it vii": _CASTABLE,
        "flexfoam-it x": _CASTABLE,
        "polyurethane foam": (
            0.1,
            f"33 kg/m^3 and 130 kPa: 0.1 ({_ALLARD} 11.3). Another foam of 200 kPa: 0.17 at 1 Hz (C. Ge, B. Rice,"
            " Polymer Testing 72, 2018)",
        ),
        "polyethylene foam": (
            0.17,
            "expanded polyethylene: 0.167 in a hobbyist's test (Audio qualia, new damping factors), frequency not"
            " stated",
        ),
        "ecoflex 00-10": _SILICONE,
        "ecoflex 00-30": _SILICONE,
        "ecoflex 00-50": _SILICONE,
        "dragon skin 10": _SILICONE,
        "dragon skin 20": _SILICONE,
        "dragon skin 30": _SILICONE,
        "mold max 30": _SILICONE,
        "pdms": (0.1, f"assumed, as for silicones. At 1 kHz 0.42, from a resonance of quality 2.4 in fig. 4 of {_LCE}"),
        "tpu 85a": _TPU,
        "tpu 85a gyroid 10%": _TPU,
        "tpu 85a gyroid 20%": _TPU,
    }
)

SLIDERS = MappingProxyType(
    {"polyester fibre": ((0.4, 0.02), (0.6, 0.1)), "polyurethane foam": ((0.4, 0.02), (0.5, 0.1))}
)
"""Share of Young's modulus and strain of each slider of a material; docs/materials.md has what they rest on."""


SOFTEST = 100.0  # Young's modulus of a material is at least so much [Pa]: less was meant in another unit
MAX_BRANCHES = 10  # a material has at most this many branches
MAX_TERMS = 6  # a foam law has at most this many terms
MAX_EXPONENT = 50.0  # largest exponent of a term, up or down
FOAM_POISSON_LIMIT = 0.45  # Poisson's ratio of a foam law is at most this: foams change their volume


@dataclass(frozen=True, kw_only=True)
class PronyTerm:
    """Maxwell branch, one term of a Prony series: spring and dashpot in series, parallel to the elastic material.

    After a sudden shear the branch carries modulus * exp(-t / time) of its stress, so the material begins stiffer by
    `modulus` and settles to the elastic material alone.

    Raises InputError: a number that is not finite and above 0.
    """

    modulus: float  # shear modulus of the branch [Pa]
    time: float  # relaxation time, after which its stress has fallen to 1/e [s]

    def __post_init__(self) -> None:
        check_positive("modulus", self.modulus, "Pa")
        check_positive("time", self.time, "s")


@dataclass(frozen=True, kw_only=True)
class PrandtlElement:
    """Prandtl element of rate-free hysteresis: spring and slider in series, parallel to the elastic material.

    It adds its modulus to the material's until its strain is reached, and then a stress of young x strain that stays
    and that turns round with the motion after twice the strain. Several in parallel are Iwan's model.

    Raises InputError: a number that is not finite and above 0, or a strain above 1.
    """

    young: float  # Young's modulus of the spring [Pa]; Poisson's ratio is 0
    strain: float  # Green's strain at which it slips, 0.05 is 5 %

    def __post_init__(self) -> None:
        check_positive("young", self.young, "Pa")
        check_positive("strain", self.strain, "")
        if self.strain > 1:
            raise InputError(f"strain must be at most 1, not {self.strain:g}; 0.05 is 5 %")


@dataclass(frozen=True, kw_only=True)
class FoamTerm:
    """Term of a foam law (Ogden and Storakers, "hyperfoam").

    An exponent above 2 makes a plateau in compression and stiffens in tension; one below 0 stiffens in compression.

    Raises InputError: a share that is not above 0, or an exponent of 0 or out of its range.
    """

    share: float  # share of the shear modulus; those of all terms add up to 1
    exponent: float  # power of the principal stretches

    def __post_init__(self) -> None:
        check_positive("share", self.share, "")
        check_number("exponent", self.exponent, "")
        if not 0 < abs(self.exponent) <= MAX_EXPONENT:
            raise InputError(
                f"exponent must be from {-MAX_EXPONENT:g} to {MAX_EXPONENT:g} and not 0, not {self.exponent:g}; 8 is "
                "soft foam"
            )


@dataclass(frozen=True, kw_only=True)
class Material:
    """Isotropic material: elastic, and optionally viscous.

    Under uniaxial stretch, foam has the stress sum of 2 mu share / alpha (s^(alpha - 1) - s^(-1 - alpha nu)).

    Attributes:
        young: Young's modulus [Pa].
        poisson: Poisson's ratio.
        density: mass density [kg/m^3].
        young_interval: 95 % interval of a measured Young's modulus [Pa]; None if not measured.
        viscosity: shear viscosity of a dashpot parallel to the elastic material (Kelvin-Voigt) [Pa s].
        relaxation: Maxwell branches parallel to the elastic material, together a Prony series.
        hysteresis: Prandtl elements parallel to the elastic material, together an Iwan model.
        foam: terms of the foam law; empty for a Neo-Hookean material.
        largest_stretch: maximum stretch (length / rest length) for which the values are valid; None if unknown.
        largest_squeeze: maximum compression, as a share of the length, for which the values are valid; for a foam,
            until its cell walls touch; None if unknown.
        loss_factor: tangent of the phase angle between stress and strain in slow vibration; None if unknown.
        name: name in the material table; empty for a material given by its values.
        source: source of the values.
        loss_source: source of the loss factor.
        note: limits of the values, and conflicting sources.

    Raises:
        InputError: a value out of range.
    """

    young: float
    poisson: float
    density: float
    young_interval: tuple[float, float] | None = None
    viscosity: float = 0.0
    relaxation: tuple[PronyTerm, ...] = ()
    hysteresis: tuple[PrandtlElement, ...] = ()
    foam: tuple[FoamTerm, ...] = ()
    largest_stretch: float | None = None
    largest_squeeze: float | None = None
    loss_factor: float | None = None
    name: str = ""
    source: str = ""
    loss_source: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        check_positive("young", self.young, "Pa")
        check_number("poisson", self.poisson, "")
        if not 0 <= self.poisson < 0.5:
            raise InputError(
                f"poisson must be at least 0 and below 0.5, not {self.poisson:g}; nearly incompressible is 0.49"
            )
        check_positive("density", self.density, "kg/m^3")
        check_not_negative("viscosity", self.viscosity, "Pa s")
        if self.loss_factor is not None:
            check_not_negative("loss_factor", self.loss_factor, "")
        if len(self.relaxation) > MAX_BRANCHES:
            raise InputError(f"relaxation must have at most {MAX_BRANCHES} branches, not {len(self.relaxation)}")
        if len(self.hysteresis) > MAX_BRANCHES:
            raise InputError(f"hysteresis must have at most {MAX_BRANCHES} elements, not {len(self.hysteresis)}")
        if self.foam:
            self._check_foam()
        if self.largest_stretch is not None and not 1 < self.largest_stretch < math.inf:
            raise InputError(f"largest_stretch must be above 1 (twice the length is 2), not {self.largest_stretch:g}")
        if self.largest_squeeze is not None and not 0 < self.largest_squeeze < 1:
            raise InputError(f"largest_squeeze must be above 0 and below 1, not {self.largest_squeeze:g}")
        if self.young < SOFTEST:
            raise InputError(
                f"young = {self.young:g} Pa is too small (minimum {SOFTEST:g} Pa). Units are Pa: for 30 kPa write 30e3."
            )

        if self.young_interval is not None:
            low, high = self.young_interval
            if not 0 < low <= self.young <= high < math.inf:
                raise InputError(f"young_interval must hold young ({self.young:g} Pa), not {low:g} to {high:g} Pa")

    def _check_foam(self) -> None:
        total = sum(term.share for term in self.foam)
        if len(self.foam) > MAX_TERMS:
            raise InputError(f"terms: a foam law has at most {MAX_TERMS}, not {len(self.foam)}")
        if abs(total - 1) > 1e-6:
            raise InputError(f"terms: their shares add up to {total:g}, not to 1; divide each by {total:g}")
        if self.poisson > FOAM_POISSON_LIMIT:
            raise InputError(f"poisson = {self.poisson:g} is too large for a foam law (maximum {FOAM_POISSON_LIMIT:g})")

    @property
    def elastic(self) -> Self:
        """Return the same material without viscosity, relaxation and hysteresis: its long-term behavior."""
        return replace(self, viscosity=0.0, relaxation=(), hysteresis=())

    def with_damping(self, frequency: float) -> Self:
        """Return the material with the viscosity that gives its loss factor in shear at a frequency [Hz].

        A mode of that frequency then has a damping ratio of about half the loss factor; other modes in proportion.

        Raises InputError: no loss factor, or a frequency that is not above 0.
        """
        check_positive("frequency", frequency, "Hz")
        if self.loss_factor is None:
            raise InputError("the material has no loss factor. Use a material of the table, or write a viscosity.")
        return replace(self, viscosity=self.loss_factor * self.lame[0] / (2 * math.pi * frequency))

    def with_hysteresis(self) -> Self:
        """Return the material with the hysteresis elements that the table has for its name.

        Raises InputError: the table has none.
        """
        if self.name not in SLIDERS:
            known = ", ".join(SLIDERS)
            raise InputError(
                f"no hysteresis is known of {self.name or 'this material'}. Write sliders. Known: {known}."
            )
        sliders = tuple(PrandtlElement(young=share * self.young, strain=strain) for share, strain in SLIDERS[self.name])
        return replace(self, hysteresis=sliders)

    @property
    def lame(self) -> tuple[float, float]:
        """Lame's parameters mu and lambda [Pa]."""
        mu = self.young / (2 * (1 + self.poisson))
        return mu, self.young * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))

    def with_young(self, young: float) -> Self:
        """Return the material with another Young's modulus [Pa], without its interval."""
        return replace(self, young=young, young_interval=None)

    @property
    def young_deviation(self) -> float | None:
        """Standard deviation of the logarithm of Young's modulus, from its interval; None if not measured."""
        if self.young_interval is None:
            return None
        low, high = self.young_interval
        return math.log(high / low) / (2 * 1.96)

    @property
    def young_text(self) -> str:
        """Young's modulus to three digits, such as "30 kPa"."""
        return f"{self.young / 1e6:.3g} MPa" if self.young >= 1e6 else f"{self.young / 1e3:.3g} kPa"

    @property
    def range_text(self) -> str:
        """Valid range of length changes in percent: compression and extension, such as "-30 to +50 %"."""
        squeeze = "" if self.largest_squeeze is None else f"{-100 * self.largest_squeeze:.0f}"
        stretch = "" if self.largest_stretch is None else f"{100 * (self.largest_stretch - 1):+.0f}"
        return f"{squeeze or '?'} to {stretch or '?'} %"
