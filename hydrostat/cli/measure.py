"""`hydrostat measure`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import RobotFolder, require_folder, require_writable
from hydrostat.cli.options import parse_optional
from hydrostat.cli.waiting import read_robot
from hydrostat.errors import InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.camera import PhotoMeasurements, PhotoOptions

TagSide = Annotated[str, typer.Option("--tag", metavar="LENGTH", help="Side of the black square of the markers' tags.")]
TagHeight = Annotated[
    str | None,
    typer.Option(
        metavar="LENGTH",
        help="Height of the tags above the board, for flat robots.",
        show_default="thickness of the body",
    ),
]


def measure(
    robot: RobotFolder,
    photos: Annotated[
        list[Path] | None,
        typer.Argument(metavar="PHOTOS", help='Photographs, named like "left=12mm,right=0mm.jpg".', show_default=False),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="TABLE.csv", help="Table to write, for `hydrostat identify`.")
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option(metavar="FILE.csv", help="Contractions of the photographs: columns photo, left_mm, tip_load_g."),
    ] = None,
    tag: TagSide = "15mm",
    height: TagHeight = None,
    check: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Also draw the simulated robot into each photograph.")
    ] = None,
    sheet: Annotated[
        Path | None, typer.Option("--print", metavar="FILE.pdf", help="Write the board and tags to print.")
    ] = None,
    paper: Annotated[str, typer.Option(metavar="a4|letter", help="Paper size of the printed pages.")] = "a4",
) -> None:
    """Measure marker positions in photographs.

    Print the board and the tags with --print. Lay the robot on the board, or before it, and photograph each pose with
    one camera. File names hold contractions and hung masses: left=12mm,tip=100g.jpg, or rest.jpg for none.

    Example: hydrostat measure my_starfish photos/*.jpg --out measured.csv
    """
    if sheet is None and out is None:
        raise InputError("give --out TABLE.csv to measure photographs, or --print FILE.pdf to print tags")
    for file in (each for each in (sheet, out) if each is not None):
        require_writable(file.parent, str(file))
    if check is not None:
        require_folder(check)
    loaded = read_robot(robot)
    options = photo_options(tag, height)
    if sheet is not None:
        from hydrostat.camera import tags_pdf
        from hydrostat.closed_set import parse_choice
        from hydrostat.fabrication import Paper
        from hydrostat.files import replace_file

        replace_file(sheet, tags_pdf(loaded, parse_choice(Paper, paper, what="--paper"), options.side))
        print(f"Wrote {sheet}. Print it at 100 % (actual size).")
    if out is None:
        return
    from hydrostat.camera import Photo, measure_photos, table_text
    from hydrostat.files import replace_file

    given = Photo.read_all(photos or [], loaded, table)
    found = measure_photos(loaded, given, options)
    replace_file(out, table_text(loaded, found))
    print_photos(found)
    if check is not None:
        draw_photos(found, check)
    print(f"Wrote {out}. Next: hydrostat identify {robot} {out} --out build/fitted")


def photo_options(tag: str, height: str | None) -> "PhotoOptions":
    """Options of a measurement from --tag and --height."""
    from hydrostat.camera import PhotoOptions
    from hydrostat.cli.options import positive
    from hydrostat.units import LENGTH

    return PhotoOptions(
        side=positive("--tag", tag, LENGTH), height=parse_optional("--height", height, LENGTH, zero=True)
    )


def print_photos(found: "PhotoMeasurements") -> None:
    """Print the error of each photograph's markers against the simulation, and warnings."""
    for measured in found.photos:
        errors = ", ".join(f"{name} {1e3 * error:.1f}" for name, error in measured.errors.items())
        print(f"  {measured.photo.name}: {errors or 'not simulated'}{' mm' if errors else ''}")
    print(
        f"{plural(len(found.photos), 'photo')}, board within {found.error:.2f} pixels of {1e3 * found.scale:.2f} mm. "
        "Figures are distances from the simulated markers."
    )
    for text in found.warnings:
        print(f"warning: {text}")


def draw_photos(found: "PhotoMeasurements", out: Path) -> None:
    """Write each photograph with the simulated robot drawn in."""
    from hydrostat.cli.options import load_matplotlib

    load_matplotlib()
    from hydrostat.plot import draw_photo_overlay, save_png

    out.mkdir(parents=True, exist_ok=True)
    for index, measured in enumerate(found.photos):
        file = out / f"{measured.photo.file.stem}.png"
        save_png(draw_photo_overlay(found, index), file, dpi=100)
        print(f"Wrote {file}")
