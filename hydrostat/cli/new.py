"""`hydrostat new`."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from shlex import quote
from shutil import rmtree
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrostat.cli.bounded import run_bounded
from hydrostat.cli.check import print_sewing
from hydrostat.cli.copy_gallery import copy_gallery
from hydrostat.cli.option_errors import naming_fields
from hydrostat.cli.options import parse_optional, positive
from hydrostat.cli.remedies import kit_warnings
from hydrostat.cli.waiting import patiently
from hydrostat.errors import InputError, SeveralPartsError
from hydrostat.units import plural, printable

if TYPE_CHECKING:
    from hydrostat.geometry import Inner
    from hydrostat.ik import BegunRobot, NewRobotWish
    from hydrostat.robot import Robot

SECONDS, SECONDS_A_NODE = 10.0, 0.02
"""Processor time that a file may take to be read, healed and meshed [s], and so much more for each node asked for."""


def new(
    name: Annotated[Path, typer.Argument(metavar="NAME", help="New robot folder.")],
    source: Annotated[
        str,
        typer.Option(
            "--from",
            metavar="SOURCE",
            help="Source: gallery:NAME, drawing (SVG, DXF, PNG, JPG), scan or CAD model (STL, OBJ, PLY, OFF, 3MF, "
            "STEP), or tetrahedral mesh (VTK, VTU, MSH).",
        ),
    ],
    size: Annotated[str | None, typer.Option(help="Length of the longest side, e.g. 190mm.")] = None,
    element_size: Annotated[str | None, typer.Option(help="Length of mesh edges, e.g. 12mm.")] = None,
    nodes: Annotated[
        int | None, typer.Option(help="Approximate number of mesh nodes, instead of --element-size.")
    ] = None,
    thickness: Annotated[str | None, typer.Option(help="Thickness of a flat body, e.g. 40mm.")] = None,
    inflate: Annotated[
        str | None, typer.Option(help="Inflate a 2D drawing to a 3D body of this thickness, e.g. 60mm.")
    ] = None,
    material: Annotated[str | None, typer.Option(help="Material name. List them with `hydrostat materials`.")] = None,
    inner: Annotated[
        str | None,
        typer.Option(help="Inner shapes of a drawing: holes, or drawn (features on the body, such as eyes)."),
    ] = None,
    part: Annotated[
        int | None,
        typer.Option(metavar="N", help="Shape of a drawing, or body of a STEP file, to use; 1 is the largest."),
    ] = None,
    cables_on_skin: Annotated[
        bool, typer.Option("--cables-on-skin", help="Move the cables of a 3D gallery robot to its skin, as on a glove.")
    ] = False,
    timeout: Annotated[
        str | None, typer.Option(metavar="TIME", help="Time limit for reading, healing and meshing the file.")
    ] = None,
) -> None:
    """Make a robot from the gallery, a drawing, a scan or a mesh.

    Repairs holes, self-intersections, flipped triangles and specks in scans and CAD models, reports the repairs, and
    draws them in healing.png.

    Example: hydrostat new my_hand --from scan.stl --size "190 mm" --nodes 900
    """
    from hydrostat.ik import NewRobotWish
    from hydrostat.units import TIME

    if nodes is not None and element_size is not None:
        raise InputError("--nodes and --element-size: mutually exclusive. Give one of them.")
    wish = NewRobotWish(
        name=_robot_name(name),
        size=_length("size", size),
        element_size=_length("element_size", element_size),
        nodes=nodes,
        thickness=_length("thickness", thickness),
        inflate=_length("inflate", inflate),
        material=material,
        inner=_inner(inner),
        drawing_part=part,
    )
    seconds = parse_optional("--timeout", timeout, TIME) or SECONDS + SECONDS_A_NODE * (nodes or 0)
    with _made_whole(name) as folder:
        with naming_fields(*_WISHES), _with_part_picture(name):
            lines = _begin(source, folder, wish, seconds, on_skin=cables_on_skin)
        with patiently("reading the robot back and drawing it ..."):
            made = _draw(folder)
    told = [line.replace(str(folder), str(name)) for line in (*lines, *_other_count(len(made.body.mesh.nodes), nodes))]
    _print_made(made, name, told, chosen=bool(nodes or element_size), source=source)


def _other_count(count: int, wanted: int | None) -> list[str]:
    """Note on a number of nodes that is not the one that was asked for."""
    if wanted is None or abs(count / wanted - 1) <= 0.1:
        return []
    return [f"note: {count} nodes instead of {wanted}: thin parts need finer elements"]


_WISHES = ("part", "size", "element_size", "nodes", "thickness", "inflate", "material", "inner")
"""Fields of a `NewRobotWish` that are options of the same name."""


@contextmanager
def _with_part_picture(name: Path) -> Iterator[None]:
    """Name a picture of the parts in errors that ask for one, and the option in errors that name its key."""
    try:
        yield
    except SeveralPartsError as error:
        raise InputError(f"{error}. See {_draw_parts(error.parts, name)}") from None
    except InputError as error:
        if not str(error).startswith("drawing_part"):
            raise
        raise InputError(str(error).removeprefix("drawing_")) from None


def _draw_parts(parts: Any, name: Path) -> Path:
    """Picture of the parts of a drawing with their numbers, beside the folder that was not made."""
    from hydrostat.plot import draw_parts, save_png

    path = name.with_name(f"{name.name}_parts.png")
    save_png(draw_parts(parts), path)
    return path


def _inner(given: str | None) -> "Inner | None":
    from hydrostat.closed_set import parse_choice
    from hydrostat.geometry import Inner

    return None if given is None else parse_choice(Inner, given, what="--inner")


def _robot_name(folder: Path) -> str:
    """Name of a robot after its folder (InputError: it is there already, or no robot may be called so)."""
    from hydrostat.given import check_name

    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"{folder} already exists. Choose another name or delete the folder.")
    return check_name(folder.resolve().name)


def _length(key: str, text: str | None) -> float | None:
    from hydrostat.units import LENGTH

    if text is None:
        return None
    option = f"--{key.replace('_', '-')}"
    value = positive(option, text, LENGTH)
    longest = 20.0  # no length that is asked for is longer [m]
    if value > longest:
        raise InputError(f"{option} {text}: must be above 0 and at most {longest:g} m")
    return value


@contextmanager
def _made_whole(name: Path) -> Iterator[Path]:
    """A folder to fill beside where it will stand; it gets its name when all is well, else it is gone."""
    from hydrostat.files import clear_unfinished, temporary_path

    made = [parent for parent in name.resolve().parents if not parent.exists()]
    try:
        name.resolve().parent.mkdir(parents=True, exist_ok=True)
        clear_unfinished(name.resolve().parent)
        folder = temporary_path(name.resolve())
        rmtree(folder, ignore_errors=True)
        folder.mkdir()
    except OSError as error:
        raise InputError(f"{name}: cannot create the folder ({error.strerror}). Choose another name.") from None
    try:
        yield folder
        try:
            if name.is_dir():
                name.rmdir()
            folder.rename(name)
        except OSError as error:
            raise InputError(
                f"{name}: cannot create the folder ({error.strerror}). Another process may have created it."
            ) from None
        made = []
    except InputError as error:
        raise InputError(str(error).replace(str(folder), str(name))) from None
    finally:
        rmtree(folder, ignore_errors=True)
        for parent in made:
            with suppress(OSError):
                parent.rmdir()


def _begin(source: str, folder: Path, wish: "NewRobotWish", seconds: float, *, on_skin: bool) -> list[str]:
    """Make the robot; returns what there is to tell."""
    from hydrostat.robot import is_of_gallery

    if is_of_gallery(source):
        return copy_gallery(source, folder, wish, on_skin=on_skin)
    if on_skin:
        raise InputError("--cables-on-skin: only for robots of the gallery. Give --from gallery:NAME")
    from hydrostat.files import replace_file
    from hydrostat.robot import save_robot

    wish = _asked_about_holes(source, wish, seconds)

    def run(sketch: Callable[[], "BegunRobot"]) -> "BegunRobot":
        return run_bounded(sketch, file=source, words="healing and meshing the body ...", seconds=seconds)

    begun = wish.begin(source, run=run)
    robot = _with_room(begun.robot)
    save_robot(robot, folder, text=_commented_text(robot, Path(source).name))
    lines, sketch = list(begun.notes), begun.sketch
    if sketch is not None and not sketch.healing.clean:
        from hydrostat.plot import draw_healing, save_png

        told = sketch.healing.lines()
        replace_file(folder / "healing.txt", ("\n".join(told) + "\n").encode())
        figure = draw_healing(sketch.before, sketch.healing.surface, notes=told, places=sketch.healing.places)
        save_png(figure, folder / "healing.png")
        lines.append(f"surface: see {folder / 'healing.png'}. The source file is unchanged")
    return lines


def _with_room(robot: "Robot") -> "Robot":
    """The robot with its winch where a motor fits, and then a pose that its cable reaches from there."""
    from hydrostat.design import place_first_winch
    from hydrostat.ik import with_first_pose

    placed = place_first_winch(robot)
    return robot if placed is robot else with_first_pose(placed)


def _asked_about_holes(source: str, wish: "NewRobotWish", seconds: float) -> "NewRobotWish":
    """The wish with what a person at the terminal says of closed shapes in a drawing, if there are any to ask about."""
    from hydrostat.files import read_stranger
    from hydrostat.geometry import OUTLINE_SUFFIXES, Inner, read_drawing

    path = Path(source)
    if wish.inner is not None or path.suffix.lower() not in OUTLINE_SUFFIXES or not path.is_file():
        return wish
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        return wish

    def count() -> int:
        drawn = read_drawing(
            read_stranger(path), name=path.name, size=wish.size, inner=Inner.DRAWN, part=wish.drawing_part
        )
        return sum(bool((line[0] == line[-1]).all()) for line in drawn.marks)

    shapes = run_bounded(count, file=source, words="reading the drawing ...", seconds=seconds)
    if not shapes:
        return wish
    what = f"The drawing has {plural(shapes, 'closed shape')} inside the body."
    drawn = typer.confirm(f"{what} Keep them as features such as eyes (y), or cut them as holes (n)?", default=True)
    return replace(wish, inner=Inner.DRAWN if drawn else Inner.HOLES)


def _draw(folder: Path) -> "Robot":
    """Read the robot back, as any command will, and draw it."""
    from hydrostat.cli.options import load_matplotlib

    load_matplotlib()
    from hydrostat.plot import draw_rest, save_png
    from hydrostat.robot import load_robot

    made = load_robot(folder)
    save_png(draw_rest(made), folder / "rest.png")
    return made


def _print_made(made: "Robot", name: Path, lines: list[str], *, chosen: bool, source: str) -> None:
    """Say what there is now, and what to do next."""
    from hydrostat.errors import NO_KIT, in_words
    from hydrostat.robot import find_risks, is_of_gallery

    from_gallery = is_of_gallery(source)

    mesh, flat = made.body.mesh, made.body.mesh.dim == 2
    print(f"Created {name}: {1e3 * mesh.size:.0f} mm, {mesh.describe()}, poses: {', '.join(made.poses)}")
    coarse = not flat and not chosen  # fewer elements than would be exact, so that all is quick at first
    for risk in (*find_risks(made), *(() if from_gallery else _pinned_drawings(made))):
        mild = coarse and "elements across" in risk
        words = in_words(risk)
        lines.append(f"note: coarse mesh for speed: {words.removeprefix('body: ')}" if mild else f"warning: {words}")
    large, small, thin = 0.8, 0.02, 0.001  # bodies beyond these may be in a wrong unit [m]
    if mesh.size < small:
        lines.append(
            f"warning: the body is {1e3 * mesh.size:.2g} mm long, shorter than any motor. Give e.g. --size 150mm"
        )
    if made.body.thickness is not None and made.body.thickness < thin:
        thickness = f"{1e3 * made.body.thickness:.2g} mm"
        lines.append(f"warning: the body is {thickness} thick, thinner than felt. Give e.g. --thickness 40mm")
    if mesh.size > large:
        lines.append(f"note: the body is {mesh.size:.2g} m long. For a smaller one, give --size in mm, e.g. 150mm")
    for line in lines:
        print(line)
    sewing = (NO_KIT + reason for reason in print_sewing(made.body))
    for reason in (*sewing, *(() if from_gallery else kit_warnings(made))):
        print(f"warning: {in_words(reason)}")
    scaled = made.body.size is not None
    origin = (
        "from the center of the drawing" if flat else "in the scaled body" if scaled else "as in the file of the body"
    )
    print(f"Edit {name / 'robot.toml'}. Coordinates: {origin}, see {name / 'rest.png'}")
    folder = quote(str(name))
    if flat:
        poses = f"write your poses into robot.toml or drag them in hydrostat studio {folder}, then: "
        design = f"hydrostat design {folder} --out {quote(str(name) + '_design')}"
        print(f"Next: {'' if from_gallery else poses}{design}")
    elif made.winches:
        pull = f"{made.winches[0].name}={250 * made.winches[0].travel:.0f}mm"
        print(f"Next: hydrostat simulate {folder} --contract {quote(pull)} --out {quote(f'build/{made.name}')}")


def _pinned_drawings(robot: "Robot") -> Iterator[str]:
    """Sentences on pins over drawn shapes; imported here, as a copy of the gallery needs no designs."""
    from hydrostat.design import find_pinned_drawings

    return find_pinned_drawings(robot)


def _commented_text(robot: "Robot", source: str) -> str:
    """Text of robot.toml with a comment before the first table of each kind.

    Args:
        robot: newly created robot.
        source: name of the file that it was created from.
    """
    from hydrostat.robot import robot_text

    flat = robot.body.mesh.dim == 2
    origin = "the middle of the drawing, x to the right, y up" if flat else "where the file of the body has it"
    where = "[0, 0]" if flat else "[0, 0, 0]"
    head = (
        f"# {robot.name}, made from {printable(source)}. Change anything.\n"
        f"# Lengths are in {robot.length_unit}; {where} is {origin}. rest.png shows them.\n"
        "# `hydrostat check` reports errors and warnings. docs/robot_toml.md of hydrostat lists all keys.\n"
    )
    notes = {
        "[body]": "# The body. A smaller element_size is finer but slower; `hydrostat materials` lists materials.",
        'plane = "stress"': '# Plane stress: thicker where it is squeezed. "strain": as thick everywhere as at rest.',
        "[[pin]]": "# The pin holds all nodes within `radius` of `at`, or in its `box`.",
        "[[winch]]": "# A winch takes in up to `travel` of its cables' length, and lets out up to `release`.",
        "[[cable]]": "# A cable runs from its winch, the first point, to its stopper, the last.",
        "[[marker]]": "# Markers are the points that you follow. Add one where the robot should reach something.",
        "[[pose]]": (
            "# A pose sets targets for markers. `hydrostat design` finds cables for it.\n"
            "# A marker without a target may move freely. To keep one in place, name its position at rest."
        ),
    }
    lines, told = [], set()
    for line in robot_text(robot).splitlines():
        if line in notes and line not in told:
            told.add(line)
            if line == "[[marker]]" and "[[winch]]" not in told:
                lines += [*_no_winch(robot), ""]
            lines += notes[line].splitlines()
        lines.append(line)
    return head + "\n".join(lines) + "\n"


def _no_winch(robot: "Robot") -> list[str]:
    """Comment on the missing winches, with a first one that can be built if there is room for it."""
    from hydrostat.design import draw_first_cable
    from hydrostat.robot import robot_text

    head = "# There are no winches yet: `hydrostat design` finds them, and their cables, for the poses below."
    first = draw_first_cable(robot)
    if first is None:
        return [head]
    text = robot_text(first)
    tables = text[text.index("[[winch]]") : text.index("[[marker]]")].strip()
    return [f"{head} By hand:", *(f"# {line}".rstrip() for line in tables.splitlines())]
