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
    from hydrostat.robot import MATERIALS, get_material

    if name is not None:
        _print_one(get_material(name))
        return
    width = max(map(len, MATERIALS))
    print(f"{'':<{width}}  {'kg/m^3':>7}  {'Young':>9}  {'Poisson':>7}  range")
    for material in MATERIALS.values():
        print(
            f"{material.name:<{width}}  {material.density:>7.0f}  {young_text(material):>9}  {material.poisson:>7.2f}"
            f"  {range_text(material)}"
        )
    print('Source of each material: hydrostat materials NAME, e.g. hydrostat materials "ecoflex 00-30"')


def _print_one(material: "Material") -> None:
    from textwrap import fill

    print(material.name)
    print(f"  density          {material.density:.0f} kg/m^3")
    print(f"  Young's modulus  {young_text(material)}")
    print(f"  Poisson's ratio  {material.poisson:.2f}")
    print(f"  range            {range_text(material)}")
    for title, text in (("source", material.source), ("note", material.note)):
        print(fill(text, width=100, initial_indent=f"  {title:<17}", subsequent_indent=" " * 19))


def young_text(material: "Material") -> str:
    """Young's modulus to three digits, such as "30 kPa"."""
    return f"{material.young / 1e6:.3g} MPa" if material.young >= 1e6 else f"{material.young / 1e3:.3g} kPa"


def range_text(material: "Material") -> str:
    """Range in which it may be squeezed and stretched, in percent of its length, such as "-30 to +50 %"."""
    squeeze = "" if material.largest_squeeze is None else f"{-100 * material.largest_squeeze:.0f}"
    stretch = "" if material.largest_stretch is None else f"{100 * (material.largest_stretch - 1):+.0f}"
    return f"{squeeze or '?'} to {stretch or '?'} %"
