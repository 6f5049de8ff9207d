"""`hydrostat measure`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import RobotFolder, require_files, require_folder, require_writable
from hydrostat.cli.options import parse_optional
from hydrostat.cli.waiting import read_robot, report_progress
from hydrostat.errors import InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.camera import PhotoMeasurements, PhotoOptions
    from hydrostat.robot import Robot

TagSide = Annotated[str, typer.Option("--tag", metavar="LENGTH", help="Side of the black square of the markers' tags.")]
TagHeight = Annotated[
    str | None,
    typer.Option(
        metavar="LENGTH",
        help="Height of the tags above the board, for flat robots.",
        show_default="thickness of the body",
    ),
]
KnownLens = Annotated[
    Path | None,
    typer.Option(
        "--lens",
        metavar="FILE.json",
        help="Lens of the camera, which `hydrostat measure` wrote next to its table.",
        show_default="found from these pictures",
    ),
]


def measure(
    robot: RobotFolder,
    photos: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="PHOTOS", help='Photographs, named like "left=12mm,right=0mm.jpg", or one film.', show_default=False
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="TABLE.csv", help="Table to write, for `hydrostat identify`.")
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.csv",
            help="Contractions: columns photo, left_mm, tip_load_g; for a film its moves: time_s, left_mm.",
        ),
    ] = None,
    every: Annotated[str, typer.Option(metavar="TIME", help="Time between two measured frames of a film.")] = "200ms",
    start: Annotated[
        str, typer.Option(metavar="TIME", help="Time in a film at which the robot starts to move.")
    ] = "0s",
    tag: TagSide = "15mm",
    height: TagHeight = None,
    lens: KnownLens = None,
    check: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Also draw the simulated robot into each photograph.")
    ] = None,
    sheet: Annotated[
        Path | None, typer.Option("--print", metavar="FILE.pdf", help="Write the board and tags to print.")
    ] = None,
    paper: Annotated[str, typer.Option(metavar="a4|letter|a3", help="Paper size of the printed pages.")] = "a4",
) -> None:
    """Measure marker positions in photographs or in a film.

    Print the board and the tags with --print. Lay the robot on the board, or in front of it, and photograph each pose
    with one camera. File names hold contractions and hung masses: left=12mm,tip=100g.jpg, or rest.jpg for none. For a
    film, use a fixed camera and slow moves, and list the moves in --table.

    Example: hydrostat measure my_starfish photos/*.jpg --out measured.csv
    """
    if sheet is None and out is None:
        raise InputError("give --out TABLE.csv to measure photographs, or --print FILE.pdf to print tags")
    if sheet is not None and sheet.suffix.lower() != ".pdf":
        raise InputError(f"--print {sheet}: must end in .pdf")
    for file in (each for each in (sheet, out) if each is not None):
        require_writable(file.parent, str(file))
    if check is not None:
        require_folder(check, option="--check")
    require_files(photos or [])
    loaded = read_robot(robot)
    options = photo_options(tag, height, lens)
    if sheet is not None:
        _print_tags(loaded, sheet, paper, options.side)
    if out is None:
        return
    from hydrostat.camera import FILMS

    films = [file for file in photos or [] if file.suffix.lower() in FILMS]
    if films:
        if len(photos or []) > 1:
            raise InputError(f"{films[0]}: measure one film at a time, without photographs")
        if table is None or check is not None:
            raise InputError(f"{films[0]}: a film needs --table with the moves that were played, and has no --check")
        _measure_film(loaded, films[0], table, out, (every, start, options))
    else:
        _measure_photos(loaded, photos or [], table, out, (options, check))
    print(f"Wrote {out}. Next: hydrostat identify {robot} {out} --out build/fitted")


def _print_tags(robot: "Robot", sheet: Path, paper: str, side: float) -> None:
    """Write the pages, and name tags that hang over the body's edge."""
    from hydrostat.camera import find_overhangs, tags_pdf
    from hydrostat.closed_set import parse_choice
    from hydrostat.fabrication import Paper
    from hydrostat.files import replace_file

    replace_file(sheet, tags_pdf(robot, parse_choice(Paper, paper, what="--paper"), side))
    print(f"Wrote {sheet}. Print it at 100 % (actual size).")
    if over := find_overhangs(robot, side):
        print(
            f"note: tags of {1e3 * side:g} mm hang over the body's edge at {', '.join(over)}. Print them on card, or "
            "smaller by --tag."
        )


def _measure_photos(
    robot: "Robot", files: list[Path], table: Path | None, out: Path, how: "tuple[PhotoOptions, Path | None]"
) -> None:
    """Measure photographs; write the table, the lens and the pictures of --check."""
    from hydrostat.camera import Photo, measure_photos, table_text
    from hydrostat.files import replace_file

    options, check = how
    found = measure_photos(robot, Photo.read_all(files, robot, table), options)
    replace_file(out, table_text(robot, found))
    print_photos(found)
    if found.measurements.in_order:
        print("note: the names have the steps of a motion. Add --in-order to hydrostat identify.")
    if check is not None:
        draw_photos(found, check)
    enough = 3
    if len(found.photos) >= enough:
        lens = replace_file(out.with_suffix(".lens.json"), found.camera.text())
        print(f"Wrote {lens}. Give it by --lens for single photographs and films of this camera.")


def _measure_film(robot: "Robot", film: Path, table: Path, out: Path, how: "tuple[str, str, PhotoOptions]") -> None:
    """Measure a film and write its table."""
    import numpy as np

    from hydrostat.camera import FilmOptions, measure_film
    from hydrostat.cli.options import positive
    from hydrostat.files import replace_file
    from hydrostat.simulation import ProfileTable
    from hydrostat.units import TIME

    every, start, photo = how
    options = FilmOptions(
        every=positive("--every", every, TIME), start=positive("--start", start, TIME, zero=True), photo=photo
    )
    found = measure_film(robot, film, ProfileTable.open(table, robot).profile, options, report_progress())
    replace_file(out, found.text(robot))
    seen = found.measurements
    counts = np.isfinite(seen.places).any(axis=2).sum(axis=0)
    rows = plural(len(found.times), "frame")
    print(f"{rows}: " + ", ".join(f"{name} in {n}" for name, n in zip(seen.markers, counts.tolist(), strict=True)))
    for text in found.warnings:
        print(f"warning: {text}")


def photo_options(tag: str, height: str | None, lens: Path | None = None) -> "PhotoOptions":
    """Options of a measurement from --tag, --height and --lens."""
    from hydrostat.camera import LensFile, PhotoOptions
    from hydrostat.cli.options import positive
    from hydrostat.units import LENGTH

    return PhotoOptions(
        side=positive("--tag", tag, LENGTH),
        height=parse_optional("--height", height, LENGTH, zero=True),
        lens=None if lens is None else LensFile.read(lens),
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
