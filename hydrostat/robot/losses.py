"""`LOSSES`: loss factor of each named material and its source; `SLIDERS`: hysteresis. What is assumed is called so."""

from types import MappingProxyType

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
