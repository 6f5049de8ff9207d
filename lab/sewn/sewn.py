"""Which drawings become plush that can be sewn, blown up to bodies of several sizes: patches, give, time, reasons.

python lab/sewn/sewn.py [--size 200,60 --size 300,90] [NAME ...]
"""

import argparse
import time

from drawings import SHARP, SMOOTH, drawing
from machine import machine  # first: it sets one thread

from hydrostat.errors import InputError
from hydrostat.fabrication import PatternOptions, Sewing, skin_of_surface
from hydrostat.geometry import inflate, read_drawing


def judge(name: str, size: float, height: float) -> tuple[str, bool | None]:
    """What is said of a drawing [m], and whether it can be sewn; None where it cannot be blown up so far."""
    outline = read_drawing(drawing(name), name=f"{name}.svg", size=size).outline
    try:
        surface = inflate(outline, height, spacing=outline.size / 80)
    except InputError as error:
        return str(error), None
    begun = time.process_time()
    sewing = Sewing.of_mesh(skin_of_surface(surface), PatternOptions())
    seconds = time.process_time() - begun
    return f"{sewing.patches} | {sewing.give:.1%} | {seconds:.1f} | {'; '.join(sewing.problems)}", not sewing.problems


def main() -> None:
    """Print a table for each size."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("names", nargs="*")
    options.add_argument("--size", action="append", help="longest side and thickness [mm], such as 200,60")
    given = options.parse_args()
    if unknown := set(given.names) - {*SMOOTH, *SHARP}:
        options.error(f"unknown drawing {min(unknown)!r}. Available: {', '.join([*SMOOTH, *SHARP])}.")
    print(machine())
    for pair in given.size or ["200,60", "300,90", "200,40"]:
        size, height = (1e-3 * float(part) for part in pair.split(","))
        print(
            f"\n| {1e3 * size:g} mm, {1e3 * height:g} mm thick | patches | give | s | reasons |\n|---|---|---|---|---|"
        )
        sewn = []
        for name in given.names or [*SMOOTH, *SHARP]:
            told, can = judge(name, size, height)
            print(f"| {name} | {told} |", flush=True)
            sewn += [] if can is None else [can]
        print(f"\n{sum(sewn)} of {len(sewn)} can be sewn")


if __name__ == "__main__":
    main()
