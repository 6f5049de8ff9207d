"""`MATERIALS`, the table of named materials, each with its source, and `FOAMS`, those with a foam law.

Rubbers are given by their 100 % modulus, as data sheets are: Young's modulus is such that a Neo-Hookean material has
that stress at twice its length. Foams are given by what is known of them, which is little. docs/materials.md is printed
from this table.
"""

# Of the thesis (docs/thesis.md): R22, E9, M1, N5, N6, E30, R52

from dataclasses import replace
from types import MappingProxyType

from hydrostat.closed_set import parse_choice
from hydrostat.errors import InputError
from hydrostat.given import check_type
from hydrostat.robot.element_kind import MaterialLaw
from hydrostat.robot.material import LOSSES, FoamTerm, Material
from hydrostat.units import quote

PSI = 6894.757  # pascals in a pound per square inch: data sheets give stresses in these
POUND_PER_CUBIC_FOOT = 16.01846  # [kg/m^3]: castable foams are named after their density in these

RUBBER_POISSON = 0.49
"""Poisson's ratio of rubbers: their volume hardly changes (0.4999); nearer to 0.5 only solving costs more."""

FOAM_POISSON = 0.3
FOAM_SQUEEZE = 0.6

_BULLETIN = "density, stress at 100 % and break: technical bulletin of the manufacturer (Smooth-On)"
_MARECHAL = "L. Marechal et al., Toward a common framework and database of materials, Soft Robotics 8(3), 2021"
_HAHN = "D. Hahn, P. Banzet, J. M. Bern, S. Coros, Real2Sim, ACM Trans. Graphics 38(6), 2019"
_GIBSON = "L. J. Gibson, M. F. Ashby, Cellular Solids, Cambridge, 1997"


def young_of_rubber(stress: float) -> float:
    """Young's modulus 3 mu [Pa] of a Neo-Hookean rubber whose stress at twice its length is mu (2 - 1/4) [Pa]."""
    return 3 * stress / (2 - 1 / 4)


def _silicone(name: str, *, gravity: float, modulus: float, breaks: float, measured: float) -> Material:
    """Castable silicone: specific gravity, 100 % modulus [psi], elongation at break [%], a second opinion [kPa]."""
    stress = modulus * PSI
    return Material(
        name=name,
        young=round(young_of_rubber(stress), -3),
        poisson=RUBBER_POISSON,
        density=1e3 * gravity,
        largest_stretch=2.0,
        largest_squeeze=0.5,
        source=f"{_BULLETIN}, {modulus:g} psi and {breaks:g} %; Poisson's ratio assumed",
        note=(
            f"The stress at twice the length is {stress / 1e3:.0f} kPa in the bulletin and {measured:.0f} kPa in the"
            f" tensile test published with {_MARECHAL}. That test takes strain from the motion of the grips, which"
            f" overestimates it; its Young's modulus is {young_of_rubber(1e3 * measured) / 1e3:.0f} kPa. The material"
            f" stiffens beyond twice its length, and is softer after the first pull (Mullins effect)."
        ),
    )


def _castable_foam(numeral: str, pounds: int, source: str, young: float, note: str) -> Material:
    """Castable foam of the FlexFoam-iT! series, named after its density in pounds per cubic foot."""
    return Material(
        name=f"flexfoam-it {numeral}",
        young=young,
        poisson=FOAM_POISSON,
        density=round(pounds * POUND_PER_CUBIC_FOOT),
        largest_stretch=1.5,
        largest_squeeze=FOAM_SQUEEZE,
        source=f"density from its name, {pounds} lb/ft^3; {source}; Poisson's ratio and range assumed",
        note=note,
    )


def _lattice(solid: Material, share: float) -> Material:
    """Printed gyroid that fills a share of its volume: stiffness falls with the square of density (open cells)."""
    return Material(
        name=f"{solid.name} gyroid {100 * share:.0f}%",
        young=solid.young * share**2,
        poisson=FOAM_POISSON,
        density=solid.density * share,
        largest_stretch=1.3,
        largest_squeeze=0.5,
        source=f"scaled from {solid.name}: E = E_solid (relative density)^2, {_GIBSON}; Poisson's ratio, range assumed",
        note=(
            "Not a measurement. The law holds for cells whose walls bend. Sheets that also stretch are up to several"
            " times stiffer, thin walls that buckle are softer, and printed lines make a body stiffer along one axis."
            " D. W. Holmes et al., Additive Manufacturing 50, 102555, 2022, measured such gyroids as a replacement for"
            " padding foams. For another infill, use young = E_solid x share^2 and density = density_solid x share."
        ),
    )


_TPU = Material(
    name="tpu 85a",
    young=12e6,
    poisson=0.48,
    density=1190,
    largest_stretch=1.6,
    largest_squeeze=0.5,
    source="tensile modulus and density: data sheet of NinjaFlex, 85 Shore A (NinjaTek, 2016); Poisson's ratio assumed",
    note="Solid. It yields at 65 % and breaks at 660 %. Printed bodies are softer across their layers.",
)

_TABLE = (
    Material(
        name="polyester fibre",
        young=30e3,
        poisson=0.3,
        density=40,
        largest_stretch=1.5,
        largest_squeeze=FOAM_SQUEEZE,
        source="assumed: loosely stuffed toy filling in a felt skin; Chang (2018) gives no value",
        note=(
            "No measured modulus of a stuffed body was found. Loose filling has no fixed modulus: its thickness under a"
            " pressure p falls as a power of p, so it stiffens from almost nothing as it is stuffed tighter. A soft"
            " cushion has 30 kPa; a tightly stuffed toy may have several times that. Poses reached by cables hardly"
            " depend on this modulus; tensions are proportional to it."
        ),
    ),
    _castable_foam(
        "iii",
        3,
        f"modulus assumed, scaled with the square of density from flexfoam-it v ({_GIBSON})",
        110e3,
        "Not measured. Foams are stiff for the first 5 to 10 % of compression and then yield; see flexfoam-it v.",
    ),
    Material(
        name="flexfoam-it v",
        young=306e3,
        poisson=0.10,
        density=80,
        largest_stretch=1.5,
        largest_squeeze=FOAM_SQUEEZE,
        source=(
            "density from its name, 5 lb/ft^3; lambda 34.5 kPa and mu 139.1 kPa (with 6.5 Pa s), fitted to the motion"
            f" of a sample, as noted in a public program taken to be that of {_HAHN}; range assumed"
        ),
        note=(
            "Fitted to fast and small motion. Under slow and large compression the foam is softer, because its walls"
            " buckle. No source for another modulus of this series was found."
        ),
    ),
    _castable_foam(
        "vii",
        7,
        f"modulus assumed, scaled with the square of density from flexfoam-it v ({_GIBSON})",
        600e3,
        "Not measured. Foams are stiff for the first 5 to 10 % of compression and then yield; see flexfoam-it v.",
    ),
    Material(
        name="flexfoam-it x",
        young=60e3,
        poisson=0.3,
        density=160,
        largest_stretch=1.5,
        largest_squeeze=FOAM_SQUEEZE,
        source="density from the table of Chang (2018); all else assumed, because no modulus is published",
        note=(
            "60 kPa is a guess, kept so that saved robots keep their tensions. It is probably too low: scaled with the"
            " square of density, flexfoam-it v would have 1.2 MPa at this density, and the other foam of Chang (2018),"
            " 240 kg/m^3 with 77 psi = 0.531 MPa, would have 0.24 MPa. The 0.531 MPa is not this foam's: the density"
            " differs, and Chang compares that foam with coffee of 445 kg/m^3 as one of similar density. Measure a"
            " sample before you trust a tension."
        ),
    ),
    Material(
        name="polyurethane foam",
        young=40e3,
        poisson=FOAM_POISSON,
        density=30,
        largest_stretch=1.5,
        largest_squeeze=FOAM_SQUEEZE,
        source=(
            "assumed, between the value from small, fast vibration (33 kg/m^3, 130 kPa, Poisson's ratio 0.3: J. F."
            " Allard, N. Atalla, Propagation of Sound in Porous Media, 2009, table 11.3) and that from the hardness of"
            " a cushion (3 to 4 kPa at 40 % compression, so 8 to 10 kPa)"
        ),
        note=(
            "Used in upholstery and mattresses. Firmness does not follow density: at 30 kg/m^3 it varies threefold. The"
            " foam is stiff for the first 5 to 10 %, yields at nearly constant stress up to 60 %, then stiffens again."
            " The measured Poisson's ratio falls from 0.5 at 5 % to -0.05 at 66 % compression (R. D. Widdle et al.,"
            " Int. J. Eng. Science 46, 2008)."
        ),
    ),
    Material(
        name="polyethylene foam",
        young=160e3,
        poisson=FOAM_POISSON,
        density=33,
        largest_stretch=1.5,
        largest_squeeze=FOAM_SQUEEZE,
        source="Plastazote LD33, data sheet (Zotefoams): 40 kPa at 25 % compression, breaks at 135 %; all else assumed",
        note="Closed cells: the secant modulus is 160 kPa at 25 %, 230 kPa at 50 %. "
        "Long compression leaves a permanent set.",
    ),
    _silicone("ecoflex 00-10", gravity=1.04, modulus=8, breaks=800, measured=14.8),
    _silicone("ecoflex 00-30", gravity=1.07, modulus=10, breaks=900, measured=29.7),
    _silicone("ecoflex 00-50", gravity=1.07, modulus=12, breaks=980, measured=41.0),
    _silicone("dragon skin 10", gravity=1.07, modulus=22, breaks=1000, measured=113.0),
    _silicone("dragon skin 20", gravity=1.08, modulus=49, breaks=620, measured=318.4),
    _silicone("dragon skin 30", gravity=1.08, modulus=86, breaks=364, measured=437.1),
    Material(
        name="mold max 30",
        young=1.14e6,
        poisson=RUBBER_POISSON,
        density=1180,
        largest_stretch=1.5,
        largest_squeeze=0.5,
        source=(
            "hardness 30 Shore A and density: technical bulletin of the manufacturer (Smooth-On); Young's modulus"
            " from the hardness (A. N. Gent, Rubber Chem. Technol. 31, 1958); Poisson's ratio and range assumed"
        ),
        note="Chang (2018) casts molds from it, not robots. A hardness determines the modulus to within 20 % at best.",
    ),
    Material(
        name="pdms",
        young=1.32e6,
        poisson=RUBBER_POISSON,
        density=1030,
        largest_stretch=1.4,
        largest_squeeze=0.4,
        source=(
            "Sylgard 184, 10:1, cured at 25 C: I. D. Johnston et al., J. Micromech. Microeng. 24, 035017, 2014;"
            " density from the table of Chang (2018) and the manufacturer (Dow); Poisson's ratio and range assumed"
        ),
        note=(
            "The modulus depends on the cure: 1.32 MPa at 25 C to 2.97 MPa at 200 C (Johnston 2014); in compression"
            " 20 MPa / ratio, so 2 MPa at 10:1 (Z. Wang, A. A. Volinsky, N. D. Gallant, J. Appl. Polym. Sci. 131,"
            " 41050, 2014). Nine kinds of test give values over two decades (H. Varner, T. Cohen, Soft Matter, 2024)."
            " The material breaks at 100 to 140 %."
        ),
    ),
    _TPU,
    _lattice(_TPU, 0.1),
    _lattice(_TPU, 0.2),
)

MATERIALS = MappingProxyType(
    {
        material.name: replace(material, loss_factor=LOSSES[material.name][0], loss_source=LOSSES[material.name][1])
        for material in _TABLE
    }
)  # materials by name

_CUSHION = (FoamTerm(share=0.995, exponent=8.0), FoamTerm(share=0.005, exponent=-4.0))


def _foam(name: str, terms: tuple[FoamTerm, ...], source: str, *, poisson: float = 0.0, young: float = 0.0) -> Material:
    """Return the material of a name with a foam law, of its own Young's modulus if given [Pa]."""
    known = MATERIALS[name]
    return replace(known, young=young or known.young, poisson=poisson, foam=terms, source=source, note="")


_FOAM_TABLE = (
    _foam(
        "polyester fibre",
        (FoamTerm(share=2 / 3, exponent=-2.0), FoamTerm(share=1 / 3, exponent=1.0)),
        "Young's modulus assumed as above; with these terms the pressure of loose fibers grows as 1 / s^3 - 1 with"
        " their thickness s, as C. M. van Wyk found for wool (J. Textile Inst. 37, T285, 1946); Poisson's ratio"
        " assumed",
    ),
    _foam(
        "polyurethane foam",
        _CUSHION,
        "3.5 kPa at 40 % compression, from the hardness of a cushion; exponent 8 assumed, so Young's modulus is 16 kPa."
        " The 40 kPa above would need exponent 19, which is seven times too stiff at 20 % stretch. The term of exponent"
        " -4, assumed, makes the foam stiff again beyond 60 %, where the walls touch. Poisson's ratio assumed, because"
        " it falls to 0 under compression (R. D. Widdle et al., 2008)",
        young=16e3,
    ),
    _foam(
        "polyethylene foam",
        (FoamTerm(share=1.0, exponent=1.256),),
        "fitted to both stresses of the data sheet of Plastazote LD33: 40 kPa at 25 % compression, 115 kPa at 50 %;"
        " Poisson's ratio assumed",
        young=124e3,
    ),
    *(
        _foam(
            f"flexfoam-it {numeral}",
            _CUSHION,
            "Young's modulus as above; exponents those of polyurethane foam, Poisson's ratio that of flexfoam-it v; no"
            " compression curve was found",
            poisson=0.10,
        )
        for numeral in ("iii", "v", "vii", "x")
    ),
)

FOAMS = MappingProxyType({material.name: material for material in _FOAM_TABLE})  # materials with a foam law by name


def get_material(name: str, law: MaterialLaw | str | None = None) -> Material:
    """Return a material from the table or the user's file; names are case-insensitive (InputError: unknown name).

    A material from the user's file comes without its name, because a robot stores its values for use on any computer.

    Args:
        name: name of the material.
        law: "foam" for its foam law, "neo-hookean" by default.

    Raises:
        InputError: an unknown material or law.
    """
    check_type(name, str, 'a material is found by its name, such as "flexfoam-it x"')
    material = MATERIALS.get(name.lower())
    if material is None:
        from difflib import get_close_matches

        from hydrostat.robot.own_materials import own_file, own_materials

        own = own_materials()
        if name.lower() in own and law is None:
            return replace(own[name.lower()], name="", source="")
        near = get_close_matches(name.lower(), [*MATERIALS, *own], n=1)
        hint = f'did you mean "{near[0]}"? ' if near else ""
        raise InputError(
            f"unknown material {quote(name)}; {hint}`hydrostat materials` lists all {len(MATERIALS) + len(own)}, "
            f"your own of {own_file()} included; or give its young, poisson and density"
        )
    if law is None or parse_choice(MaterialLaw, law, what="law") is MaterialLaw.NEO_HOOKEAN:
        return material
    if material.name not in FOAMS:
        raise InputError(
            f"{quote(material.name)} has no foam law; those with one: {', '.join(FOAMS)}. Or give its terms."
        )
    return FOAMS[material.name]
