"""`hydrostat studio`."""

from pathlib import Path
from typing import Annotated

import typer

from hydrostat.cli.folders import found_folder
from hydrostat.errors import InputError
from hydrostat.version import install_command


def studio(
    robot: Annotated[
        Path | None,
        typer.Argument(metavar="[ROBOT]", help="Robot folder, or gallery:NAME.", show_default="show the gallery"),
    ] = None,
    port: Annotated[int, typer.Option(metavar="PORT", help="TCP port. 0 = any free port.")] = 0,
    host: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Bind address. Remote clients need the printed token.")
    ] = "127.0.0.1",
    model: Annotated[
        Path | None,
        typer.Option(metavar="MODEL", help="Model of ROBOT from `hydrostat learn`, for a fast first answer to drags."),
    ] = None,
    rooms: Annotated[
        bool,
        typer.Option("--rooms", help="Give each browser its own robot, e.g. for a class."),
    ] = False,
    browser: Annotated[bool, typer.Option(help="Open the browser.")] = True,
) -> None:
    """Open the studio: pose, design, drive and export a robot.

    Example: hydrostat studio gallery:starfish

    Example: hydrostat studio gallery:cupping_hand --model build/hand.model

    Example: hydrostat studio gallery:starfish --rooms --host 192.168.1.20
    """
    try:
        from hydrostat.studio import Rooms, serve
    except ModuleNotFoundError as error:
        if error.name != "nicegui":
            raise
        raise InputError(f"studio: package nicegui not found. Install it: {install_command('studio')}") from None
    from hydrostat.studio import Session, state_folder

    if model is not None and (robot is None or rooms):
        raise InputError("--model: needs its ROBOT, and is not available with --rooms.")
    if rooms:
        if robot is not None:
            from hydrostat.robot import load_robot

            robot = found_folder(robot)
            load_robot(robot)  # what is wrong with it is told now, not to each who comes
        served = Rooms(state=state_folder(), first=robot)
    else:
        session = Session(state_folder())
        if robot is not None:
            session.open_folder(robot, model)
        served = Rooms(session)
    words = "Studio: {}   (Ctrl-C to stop)"
    serve(served, host=host, port=port, show=browser, announce=lambda at: print(words.format(at), flush=True))
