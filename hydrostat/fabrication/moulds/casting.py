"""`Casting`: how much of what is poured, and how long it takes."""

from dataclasses import dataclass

from hydrostat.fabrication.kit_options import BLOCKS, CASTABLE, MATERIAL_FIX, block_problem
from hydrostat.robot import MATERIALS, Material

SILICONE_PRICE = 40.0  # price of a kilogram of Mold Max 30 [USD]: not measured, check yours
_PLATINUM = ("ecoflex", "dragon skin")  # silicones that are cured by platinum

THESIS = "Chang (2018)"  # R52, N2, N5


@dataclass(frozen=True, kw_only=True)
class Mix:
    """Two parts that are mixed and poured; masses with what is spare."""

    material: str  # name of the material
    volume: float  # to fill [mm^3], without what is spare
    density: float  # once cured [g/mm^3]
    part_a: float  # mass of the first part [g]
    part_b: float  # mass of the second part [g]
    ratio: str  # mix ratio of the parts, in words, with its source

    @property
    def mass(self) -> float:
        """Mass of both parts [g]."""
        return self.part_a + self.part_b


@dataclass(frozen=True, kw_only=True)
class Casting:
    """All that is poured."""

    body: Mix  # casting material of the body
    expansion: float  # volume of the foam over that of the liquid; 1 for what does not rise
    silicone: tuple[Mix, ...]  # silicone of the first and the second pour; empty for printed halves
    silicone_cost: float  # rough price of both pours [USD]
    times: tuple[tuple[str, str], ...]  # waiting times, as (process, time), with sources
    release: str  # release agent
    notes: tuple[str, ...]  # sources of the figures, and unknowns


def make_casting(material: Material, fill: float, *, pours: tuple[float, ...]) -> tuple[Casting, tuple[str, ...]]:
    """Amounts and times, and why the body that is cast would not be the one that was simulated.

    `fill` is the volume of cavity, sprue and vents, `pours` are those of silicone, none for printed halves [mm^3].
    """
    cast, _ = _castable(material)
    foams = _is_foam(cast)
    body = _mix(cast.name, fill, cast.density, 0.5, _ratio_in_words(cast))
    silicone = tuple(
        _mix(
            "mold max 30",
            pour,
            MATERIALS["mold max 30"].density,
            100 / 110,
            "100 parts A to 10 parts B by mass (maker's data sheet, as quoted by Fab Academy Amsterdam, 2018)",
        )
        for pour in pours
    )
    liquid_foam = 1.1e3  # density of mixed polyurethane before it rises [kg/m^3]: assumed
    casting = Casting(
        body=body,
        expansion=liquid_foam / cast.density if foams else 1.0,
        silicone=silicone,
        silicone_cost=SILICONE_PRICE * sum(mix.mass for mix in silicone) / 1e3,
        times=_times(cast, silicone=bool(pours)),
        release=_release(foams),
        notes=_casting_notes(foams, silicone=bool(pours)),
    )
    return casting, casting_problems(material, silicone=bool(pours))


def casting_problems(material: Material, *, silicone: bool) -> tuple[str, ...]:
    """Return a problem if a material is not cast, and one if it does not cure in a mold of silicone."""
    cast, problems = _castable(material)
    return (*problems, *_inhibition_problem(cast, silicone=silicone))


def cures_in_silicone(material: str) -> bool:
    """Return True if a material cures in a mold of Mold Max 30, which is cured by tin."""
    return not material.startswith(_PLATINUM)


def _inhibition_problem(material: Material, *, silicone: bool) -> tuple[str, ...]:
    """Return a problem if the mold keeps the body from curing; else nothing."""
    if not silicone or cures_in_silicone(material.name):
        return ()
    return (
        f"{material.name} is cured by platinum and does not cure against Mold Max 30, which is cured by tin (its maker "
        "Smooth-On, FAQ 129: neither cures against the other). Print the mold (--mould printed)",
    )


def _castable(material: Material) -> tuple[Material, tuple[str, ...]]:
    """Return the casting material and problems: the body's own if it comes as two parts, else the default foam."""
    if material.name.startswith(CASTABLE):
        return material, ()
    foam = MATERIALS["flexfoam-it x"]
    if material.name in BLOCKS:
        return foam, (block_problem(material.name),)
    name = f'"{material.name}"' if material.name else "the body's material, given by its numbers,"
    problem = (
        f"{name} ({material.density:.0f} kg/m^3) is not cast from two parts. This mold is sized for {foam.name} "
        f"({foam.density:.0f} kg/m^3), so the robot would differ from the simulated one. {MATERIAL_FIX} "
        f"what you pour, such as {foam.name}, and simulate again, or choose plush if the body is flat"
    )
    return foam, (problem,)


def _is_foam(material: Material) -> bool:
    return material.name.startswith("flexfoam-it")


def _mix(name: str, volume: float, density: float, share: float, ratio: str) -> Mix:
    """Amounts with what is spare; density in kg/m^3, share of part A by mass."""
    grams = 1e-6 * density
    spare = 0.10  # mixed more than is needed: some stays in the cup and in the sprue
    mass = (1 + spare) * grams * volume
    return Mix(material=name, volume=volume, density=grams, part_a=share * mass, part_b=(1 - share) * mass, ratio=ratio)


def _ratio_in_words(material: Material) -> str:
    if _is_foam(material):
        return "equal parts are assumed, as no source was found: use the ratio printed on your cans"
    return "equal parts A and B: use the ratio printed on your cans"


def _times(material: Material, *, silicone: bool) -> tuple[tuple[str, str], ...]:
    cures = {
        "flexfoam-it x": f"2 h at 25 C ({THESIS})",
        "ecoflex 00-30": f"4 h at 25 C in the mold; out of it, as PLA softens near 60 C, 2 h at 80 C and 1 h at 100 C "
        f"({THESIS})",
    }
    body = (f"{material.name} cures", cures.get(material.name, "as your cans say; no source was found"))
    if not silicone:
        return (body,)
    mould = (
        ("mold max 30 cures, each of two pours", f"24 h at room temperature, or 6 h at 60 C ({THESIS})"),
        ("instead of a printed positive: alginate around a model", f"less than 5 min ({THESIS})"),
        ("and plaster of Paris poured into it", f"several hours ({THESIS})"),
    )
    return (*mould, body)


def _release(foams: bool) -> str:
    if foams:
        return (
            "wax or a spray for polyurethane on all that the foam touches, sprue and vents too: foam sticks to bare "
            "plastic (the maker waxes lid and holes: Smooth-On's gallery, cinder blocks of FlexFoam-iT! X)"
        )
    return "a thin coat of release spray; silicone does not stick to plastic, but grips the layers of a print"


def _casting_notes(foams: bool, *, silicone: bool) -> tuple[str, ...]:
    notes = []
    if foams:
        notes.append(
            "Expansion is the density of the liquid, assumed 1100 kg/m^3, over that of the foam; in a closed mold "
            "foam comes out denser. Open holes let the pressure of the rising foam out (Smooth-On's gallery: "
            "FlexFoam-iT! X cast in Mold Max 30)."
        )
        notes.append(
            "Pot life of the foam: no source was found; pour immediately, and read your cans before you begin."
        )
    if silicone:
        notes.append(
            f"Silicone at {SILICONE_PRICE:g} USD a kilogram: measured on none, check yours; {THESIS} paid about "
            "100 USD for a mold."
        )
    return tuple(notes)
