"""Arguments that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

from hydrostat.errors import InputError

RobotFolder = Annotated[Path, typer.Argument(metavar="ROBOT", help="Folder of a robot, or its robot.toml.")]


def require_folder(out: Path) -> None:
    """Before long work begins: the results can go there.

    Raises:
        InputError: something that is no folder is in the way.
    """
    for folder in (out, *out.parents):
        if folder.exists() and not folder.is_dir():
            raise InputError(f"--out {out}: {'' if folder == out else f'{folder} '}is a file; name a folder")


OutFolder = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the results; made if need be.")]
