"""`hydrostat materials`."""

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from hydrostat.robot import Material


def materials(
    name: Annotated[str | None, typer.Argument(metavar="NAME", help="Material name, to print its source.")] = None,
) -> None:
    """List all materials, or print the data and source of one.

    Example: hydrostat materials "ecoflex 00-30"
    """
    from hydrostat.robot import FOAMS, MATERIALS, get_material, own_materials

    own = own_materials()
    if name is not None:
        found = own[name.lower()] if name.lower() in {*own} - {*MATERIALS} else get_material(name)
        _print_one(found)
        if found.name in FOAMS:
            _print_foam(FOAMS[found.name])
        return
    width = max(map(len, [*MATERIALS, *own]))
    print(f"{'':<{width}}  {'kg/m^3':>7}  {'Young':>9}  {'Poisson':>7}  {'loss':>4}  range")
    for hidden in [own.pop(name).name for name in {*own} & {*MATERIALS}]:
        print(f'warning: your material "{hidden}" is not used: the table has one of this name. Rename yours.')
    for material in (*MATERIALS.values(), *own.values()):
        loss = "" if material.loss_factor is None else f"{material.loss_factor:g}"
        end = material.range_text if material.young_interval is None else _interval_text(material)
        print(
            f"{material.name:<{width}}  {material.density:>7.0f}  {material.young_text:>9}  {material.poisson:>7.2f}"
            f"  {loss:>4}  {end}"
        )
    print('Source of each material: hydrostat materials NAME, e.g. hydrostat materials "ecoflex 00-30"')


def _print_one(material: "Material") -> None:
    print(material.name)
    print(f"  density          {material.density:.0f} kg/m^3")
    interval = "" if material.young_interval is None else f" ({_interval_text(material)})"
    print(f"  Young's modulus  {material.young_text}{interval}")
    print(f"  Poisson's ratio  {material.poisson:.2f}")
    if material.loss_factor is not None:  # a material of the table
        print(f"  range            {material.range_text}")
        print(f"  loss factor      {material.loss_factor:g}")
    texts = (("source", material.source), ("loss source", material.loss_source), ("note", material.note))
    _print_texts(*((title, text) for title, text in texts if text))


def _interval_text(material: "Material") -> str:
    """Interval of a measured Young's modulus, such as "95 %: 20.8 kPa to 23.9 kPa"."""
    low, high = (material.with_young(end).young_text for end in material.young_interval or ())
    return f"95 %: {low} to {high}"


def _print_foam(material: "Material") -> None:
    print(f'with law = "foam": {{ name = "{material.name}", law = "foam" }}')
    print(f"  Young's modulus  {material.young_text}")
    print(f"  Poisson's ratio  {material.poisson:.2f}")
    print(f"  exponents        {', '.join(f'{term.exponent:g} ({100 * term.share:.3g} %)' for term in material.foam)}")
    _print_texts(("source", material.source))


def _print_texts(*texts: tuple[str, str]) -> None:
    from textwrap import fill

    for title, text in texts:
        print(fill(text, width=100, initial_indent=f"  {title:<17}", subsequent_indent=" " * 19))
