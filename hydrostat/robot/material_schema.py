"""Tables of materials in TOML files."""

from typing import Annotated

from pydantic import BeforeValidator, Discriminator, Field, Tag

from hydrostat.robot.element_kind import MaterialLaw
from hydrostat.robot.material import MAX_BRANCHES, MAX_TERMS
from hydrostat.toml_schema import Density, Name, NamedViscosity, Number, Pressure, Text, Time, TomlTable, Viscosity


class RelaxationTable(TomlTable):
    """Maxwell branch."""

    modulus: Pressure
    time: Time


Branches = Annotated[list[RelaxationTable], Field(max_length=MAX_BRANCHES)]


class SliderTable(TomlTable):
    """Prandtl element."""

    young: Pressure
    strain: Number


Sliders = Annotated[list[SliderTable], Field(max_length=MAX_BRANCHES)]


class FoamTermTable(TomlTable):
    """Term of a foam law."""

    share: Number
    exponent: Number


Terms = Annotated[list[FoamTermTable], Field(min_length=1, max_length=MAX_TERMS)]


def _named_sliders(value: object) -> object:
    """Sliders, or "material" for those of the table."""
    return None if value == "material" else value


class NamedMaterialTable(TomlTable):
    """Material by name, with its law and viscosity."""

    name: Text
    law: MaterialLaw | None = None
    terms: Terms | None = None
    viscosity: NamedViscosity | None = None
    relaxation: Branches | None = None
    hysteresis: Annotated[Sliders | None, BeforeValidator(_named_sliders)] = None


class MaterialTable(TomlTable):
    """Material by its numbers."""

    young: Pressure
    young_interval: Annotated[list[Pressure], Field(min_length=2, max_length=2)] | None = None
    poisson: Number
    density: Density
    law: MaterialLaw | None = None
    terms: Terms | None = None
    viscosity: Viscosity | None = None
    relaxation: Branches | None = None
    hysteresis: Sliders | None = None


class OwnMaterialTable(MaterialTable):
    """[[material]] of a user's own file."""

    name: Name
    source: Text | None = None


class OwnMaterialsTable(TomlTable):
    """Materials of a user's own."""

    material: Annotated[list[OwnMaterialTable], Field(default_factory=list, max_length=1000)]


def _material_tag(value: object) -> str:
    if not isinstance(value, dict):
        return "<name>"
    return "<named>" if "name" in value else "<numbers>"


AnyMaterial = Annotated[
    Annotated[Text, Tag("<name>")]
    | Annotated[NamedMaterialTable, Tag("<named>")]
    | Annotated[MaterialTable, Tag("<numbers>")],
    Discriminator(_material_tag),
]
