"""`hydrostat studio`."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import found_folder
from hydrostat.errors import InputError
from hydrostat.version import install_command

if TYPE_CHECKING:
    from hydrostat.studio import Session


NewCode = Annotated[
    bool, typer.Option("--new-code", help="Make a new class code. Old links and codes then no longer work.")
]


def studio(
    robot: Annotated[
        Path | None,
        typer.Argument(metavar="[ROBOT]", help="Robot folder, gallery:NAME, or link.", show_default="show the gallery"),
    ] = None,
    port: Annotated[int, typer.Option(metavar="PORT", min=0, max=65535, help="TCP port. 0 = any free port.")] = 0,
    host: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Bind address. Remote clients need the printed token.",
            show_default="127.0.0.1; with --class this computer's address in its network",
        ),
    ] = None,
    model: Annotated[
        Path | None,
        typer.Option(
            metavar="MODEL", help="Model of ROBOT from `hydrostat learn`, for a fast first pose while you drag."
        ),
    ] = None,
    rooms: Annotated[
        bool,
        typer.Option("--rooms", help="Give each browser its own robot, e.g. for a class."),
    ] = False,
    classroom: Annotated[
        bool,
        typer.Option("--class", help="Give each browser of the network its own robot; print the link and its QR code."),
    ] = False,
    new_code: NewCode = False,
    browser: Annotated[bool, typer.Option(help="Open the browser.")] = True,
) -> None:
    """Open the studio: pose, design, drive and export a robot.

    Example: hydrostat studio gallery:starfish

    Example: hydrostat studio gallery:cupping_hand --model build/hand.model

    Example: hydrostat studio gallery:starfish --class
    """
    try:
        from hydrostat.studio import Rooms, find_network_address, serve
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package == "hydrostat":
            raise
        raise InputError(f"studio: package {package} not found. Install it: {install_command('studio')}") from None
    from hydrostat.studio import LINK_MARK, Classroom, Session, state_folder

    rooms = rooms or classroom
    if model is not None and (robot is None or rooms or LINK_MARK in str(robot)):
        raise InputError("--model: needs the folder of its ROBOT, and is not available with --rooms or --class.")
    if rooms and LINK_MARK in str(robot):
        raise InputError("--rooms, --class: not available with a link. Open it alone and save its robot first.")
    _forget_code(new_code, classroom)
    host = host or (find_network_address() if classroom else "127.0.0.1")
    session = None if rooms else Session(state_folder())
    if session is None:
        served = Rooms(state=state_folder(), first=robot and found_folder(robot))
    else:
        served = Rooms(session)
        if robot is not None:
            _open(session, robot, model)
    try:
        teacher = Classroom(served) if classroom else None
        serve(served, host=host, port=port, show=browser, classroom=teacher, announce=partial(_announce, classroom))
    except KeyboardInterrupt:
        problem = session and session.starter.autosave.problem
        print(f"Studio ended. {problem}." if problem else ENDED)
        raise typer.Exit(130) from None


def _forget_code(new_code: bool, classroom: bool) -> None:
    """Remove the code of the last lesson if a new one is asked for (InputError: not a class)."""
    from hydrostat.studio import forget_code, state_folder

    if not new_code:
        return
    if not classroom:
        raise InputError("--new-code: only a class has a code. Add --class.")
    forget_code(state_folder())


def _open(session: "Session", robot: Path, model: Path | None) -> None:
    """Show a robot of a folder, with its model, or of a link."""
    from hydrostat.studio import LINK_MARK

    if LINK_MARK in str(robot):
        session.starter.open_link(str(robot))
        session.go("pose")
    else:
        session.open_folder(robot, model)


ENDED = "Studio ended. It keeps unsaved work for its next start."


def _announce(classroom: bool, address: str) -> None:
    """Print an address; that of pupils with its QR code."""
    if "/class/" in address:
        print(f"Teacher: {address}   (keep this link to yourself)", flush=True)
        return
    print(f"{'Pupils' if classroom else 'Studio'}: {address}   (Ctrl-C to stop)", flush=True)
    if classroom:
        from hydrostat.studio import Links, write_qr_text

        if Links(address, "").are_local:
            print("note: opens on this computer only. Leave out --host for a class.", flush=True)
        else:
            print(write_qr_text(address), flush=True)
            _print_keeping()


def _print_keeping() -> None:
    """Print the age of the class code, and the folder of the robots and nicknames."""
    from hydrostat.studio import find_code_date, state_folder

    made = find_code_date(state_folder())
    if made is None:
        print("warning: the class code cannot be kept. The next lesson will have another one.", flush=True)
    else:
        print(f"Code: made on {made}, the same for all classes for 90 days. --new-code makes a new one.", flush=True)
    print(f"Robots and nicknames: {state_folder() / 'rooms'}", flush=True)
