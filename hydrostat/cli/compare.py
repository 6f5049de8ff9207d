"""`hydrostat compare`."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import OutFolder, RobotFolder, require_files, require_folder
from hydrostat.cli.measure import KnownLens, TagHeight, TagSide, draw_photos, photo_options, print_photos
from hydrostat.cli.options import AddedLoads, Contract, contractions, loads
from hydrostat.cli.waiting import read_robot

if TYPE_CHECKING:
    from hydrostat.camera import Photo
    from hydrostat.robot import Robot


def compare(
    robot: RobotFolder,
    photo: Annotated[Path, typer.Argument(metavar="PHOTO", help="Photograph of the robot on its board.")],
    out: OutFolder,
    contract: Contract = None,
    load: AddedLoads = None,
    rest: Annotated[
        Path | None,
        typer.Option(
            metavar="PHOTO",
            help="Photograph without contraction, to locate the board.",
            show_default="locate the board by the pose itself",
        ),
    ] = None,
    tag: TagSide = "15mm",
    height: TagHeight = None,
    lens: KnownLens = None,
) -> None:
    """Compare a photograph with the simulated pose.

    Prints the distance of each marker from the simulated one, and writes the photograph with the simulated outline and
    markers drawn in. The pose comes from a name such as left=12mm,tip=50g.jpg; --contract replaces its contractions,
    --load its masses. Print tags and board with `hydrostat measure --print`. With --rest, the distances include a shift
    or turn of the body.

    Example: hydrostat compare my_starfish photo.jpg --contract left=12mm --out build/compared
    """
    from hydrostat.camera import Photo, measure_photos

    require_files([photo] if rest is None else [photo, rest])
    require_folder(out)
    loaded = read_robot(robot)
    photos = [read_pose(loaded, photo, contract, load)]
    if rest is not None:
        photos.append(Photo(file=rest, contractions={}, masses={}))
    found = measure_photos(loaded, photos, photo_options(tag, height, lens))
    print_photos(found)
    draw_photos(found, out)


def read_pose(
    robot: "Robot", file: Path, contract: Sequence[str] | None = None, load: Sequence[str] | None = None
) -> "Photo":
    """Return a photograph with the pose in its name; options replace the contractions and the masses in it."""
    from hydrostat.camera import Photo
    from hydrostat.errors import InputError

    photo = Photo(file=file, contractions={}, masses={})
    if "=" in file.stem and not (contract and load):
        try:
            photo = Photo.read_all([file], robot)[0]
        except InputError:  # no pose: the options tell it
            if not (contract or load):
                raise
    if contract:
        photo = replace(photo, contractions=contractions(robot, contract))
    if load:
        photo = replace(photo, masses={}, loads=loads(robot, load).loads[len(robot.loads) :])
    return photo
