"""`hydrostat new`."""

import re
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.robot import Robot


def new(
    name: Annotated[Path, typer.Argument(metavar="NAME", help="Folder to make for the new robot.")],
    source: Annotated[
        str,
        typer.Option(
            "--from", metavar="SOURCE", help="gallery:NAME, or a drawing of a closed outline: SVG, DXF, PNG, JPG."
        ),
    ],
    size: Annotated[str | None, typer.Option(help='Longest side, for example "200 mm".')] = None,
    element_size: Annotated[str | None, typer.Option(help='Length of a mesh edge, for example "12 mm".')] = None,
    thickness: Annotated[str | None, typer.Option(help='Thickness of the body, for example "40 mm".')] = None,
    material: Annotated[str, typer.Option(help="A material of the table.")] = "polyester fibre",
) -> None:
    """Make a robot from the gallery or from a drawing.

    Example: hydrostat new my_starfish --from gallery:starfish
    """
    from hydrostat.geometry.outline_file import OUTLINE_SUFFIXES, read_drawing
    from hydrostat.robot import find_risks, load_robot, save_robot, sketch_robot

    notes: tuple[str, ...] = ()
    if name.exists() and (not name.is_dir() or any(name.iterdir())):
        raise InputError(f"{name}: exists already; choose another name or remove it")
    lengths = {
        key: _length(key, text)
        for key, text in (("size", size), ("element_size", element_size), ("thickness", thickness))
    }
    if source.startswith("gallery:"):
        if any(lengths.values()):
            raise InputError("a gallery robot has its own sizes; edit them in its robot.toml")
        _copy_gallery(source.removeprefix("gallery:"), name)
    else:
        drawing = Path(source)
        if drawing.suffix.lower() not in OUTLINE_SUFFIXES:
            raise InputError(f"{source}: only gallery:NAME and SVG, DXF, PNG and JPG drawings can be read so far")
        if not drawing.is_file():
            raise InputError(f"{source}: there is no such file")
        content, file = drawing.read_bytes(), _file_name(drawing)
        notes = read_drawing(content, name=file, size=lengths["size"]).notes
        robot = sketch_robot(content, file=file, name=name.resolve().name, material=material, **lengths)
        save_robot(robot, name)
    made = load_robot(name)
    _picture(made, name)
    print(f"Made {name}: {len(made.body.mesh.nodes)} nodes, poses: {', '.join(made.poses)}")
    for note in notes:
        print(f"drawing: {note}")
    for risk in find_risks(made):
        print(f"risky: {risk}")
    print(f"Edit {name / 'robot.toml'}; coordinates count from the middle of the drawing, see {name / 'rest.png'}")
    print(f"Next: hydrostat design {quote(str(name))} --out {quote(str(name) + '_design')}")


def _length(key: str, text: str | None) -> float | None:
    from hydrostat.units import LENGTH, parse_quantity

    if text is None:
        return None
    try:
        return parse_quantity(text, LENGTH)
    except InputError as error:
        raise InputError(f"--{key.replace('_', '-')}: {error}") from None


def _copy_gallery(robot: str, folder: Path) -> None:
    from hydrostat.robot import gallery_folder, replace_file

    source = gallery_folder(robot)
    folder.mkdir(parents=True, exist_ok=True)
    for file in sorted(source.iterdir()):
        if file.is_file():
            replace_file(folder / file.name, file.read_bytes())


def _picture(robot: "Robot", folder: Path) -> None:
    from hydrostat.plot import draw_rest, save_png

    save_png(draw_rest(robot), folder / "rest.png")


def _file_name(drawing: Path) -> str:
    return re.sub(r"[^\w.-]", "_", drawing.name)
