"""Material tables of TOML files: values of a table as a `Material`, and a `Material` as values of a table."""

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.robot.element_kind import MaterialLaw
from hydrostat.robot.material import FoamTerm, Material, PrandtlElement, PronyTerm

_Record = TypeVar("_Record")


def given_keys(entry: Any, *keys: str) -> dict[str, Any]:
    """Keys that stand in the file; the others keep the record's own defaults."""
    return {key: getattr(entry, key) for key in keys if getattr(entry, key) is not None}


def material_of(entry: Any) -> Material:
    """Return a material by its values (InputError: a value out of its range, or a foam law without terms)."""
    given = inelastic_values(entry)
    if entry.law is MaterialLaw.FOAM and "foam" not in given:
        raise InputError("terms are missing; a foam law needs them: terms = [{ share = 1, exponent = 8 }]")
    if entry.young_interval is not None:
        given["young_interval"] = tuple(entry.young_interval)
    return Material(young=entry.young, poisson=float(entry.poisson), density=entry.density, **given)


def inelastic_values(entry: Any) -> dict[str, Any]:
    """Fields of `Material` for viscosity, relaxation, hysteresis and foam terms, as far as a table has them."""
    given = given_keys(entry, "viscosity")
    for key, make in (
        ("relaxation", lambda branch: PronyTerm(modulus=branch.modulus, time=branch.time)),
        ("hysteresis", lambda slider: PrandtlElement(young=slider.young, strain=float(slider.strain))),
        ("terms", lambda term: FoamTerm(share=float(term.share), exponent=float(term.exponent))),
    ):
        if getattr(entry, key) is not None:
            given["foam" if key == "terms" else key] = _records(key, getattr(entry, key), make)
    if "foam" in given and entry.law is not MaterialLaw.FOAM:
        raise InputError('terms are those of a foam law; write law = "foam" with them, or remove them')
    return given


def _records(key: str, entries: Iterable[Any], make: Callable[[Any], _Record]) -> tuple[_Record, ...]:
    found = []
    for index, entry in enumerate(entries):
        try:
            found.append(make(entry))
        except InputError as error:
            raise InputError(f"{key}[{index}].{error}") from None
    return tuple(found)


def material_values(material: Material, *, name: str = "", known: Material | None = None) -> dict[str, Any]:
    """Keys and values of a material in a TOML file: its name if given, else its numbers, then the rest.

    `known` is the material of the same name with a foam law; terms are left out where it has the same.
    """
    values: dict[str, Any] = {"name": name}
    if not name:
        values = {"young": units.format_quantity(material.young, units.PRESSURE)}
        if material.young_interval is not None:
            values["young_interval"] = [units.format_quantity(end, units.PRESSURE) for end in material.young_interval]
        values |= {"poisson": material.poisson, "density": units.format_quantity(material.density, units.DENSITY)}
    if material.foam:
        values["law"] = str(MaterialLaw.FOAM)
        if material.elastic != known:
            values["terms"] = _tables({"share": term.share, "exponent": term.exponent} for term in material.foam)
    if material.viscosity:
        values["viscosity"] = units.format_quantity(material.viscosity, units.VISCOSITY)
    if material.relaxation:
        values["relaxation"] = _tables(
            {
                "modulus": units.format_quantity(branch.modulus, units.PRESSURE),
                "time": units.format_quantity(branch.time, units.TIME),
            }
            for branch in material.relaxation
        )
    if material.hysteresis:
        values["hysteresis"] = _tables(
            {"young": units.format_quantity(slider.young, units.PRESSURE), "strain": slider.strain}
            for slider in material.hysteresis
        )
    return values


def _tables(entries: Iterable[dict[str, Any]]) -> Any:
    """Array of inline tables."""
    import tomlkit

    array = tomlkit.array()
    for entry in entries:
        table = tomlkit.inline_table()
        table.update(entry)
        array.append(table)
    return array
