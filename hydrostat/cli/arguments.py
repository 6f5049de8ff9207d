"""Arguments that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

RobotFolder = Annotated[Path, typer.Argument(metavar="ROBOT", help="Folder of a robot, or its robot.toml.")]
OutFolder = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the results; made if need be.")]
