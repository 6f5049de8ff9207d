"""`hydrostat export`."""

from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.animate import find_stops
from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder, result_folder
from hydrostat.cli.require_cables import require_cables
from hydrostat.cli.waiting import prepare_physics, progress_bar, read_robot
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.export import MjcfTuning
    from hydrostat.progress import Progress
    from hydrostat.robot import Robot


def export(
    robot: RobotFolder,
    out: OutFolder,
    mjcf: Annotated[bool, typer.Option("--mjcf", help="Write robot.xml, a model for MuJoCo 4.")] = False,
    usd: Annotated[bool, typer.Option("--usd", help="Write robot.usda, a film of the robot as a USD scene.")] = False,
    trials: Annotated[
        int,
        typer.Option(metavar="N", min=0, max=1000, help="Number of random poses that test the MuJoCo model. 0 = none."),
    ] = 5,
    fit_poses: Annotated[
        int,
        typer.Option(
            metavar="N",
            min=0,
            max=1000,
            help="Number of poses that the MuJoCo model is fitted to, 3 or more. 0 = no fit.",
        ),
    ] = 0,
) -> None:
    """Write a robot for other simulators and renderers.

    The MuJoCo model holds the body as deformable elements and the cables as tendons. Its first lines state its error
    against hydrostat. --fit-poses fits a few numbers to poses of hydrostat. The USD scene shows the film of `animate`.
    Measuring and fitting need the extra export (MuJoCo).

    Example: hydrostat export gallery:starfish --mjcf --out build/starfish
    """
    if not mjcf and not usd:
        raise InputError("export needs --mjcf or --usd, or both")
    if 0 < fit_poses < 3:
        raise InputError(f"--fit-poses {fit_poses}: too few poses. Allowed: 0, or 3 to 1000. Write --fit-poses 20.")
    if fit_poses and not (mjcf and trials):
        raise InputError("--fit-poses needs --mjcf and --trials, which find the share of the travel to fit")
    require_folder(out)
    loaded = read_robot(robot)
    require_cables(loaded, robot, "exported models")
    texts = {}
    if mjcf:
        texts["robot.xml"] = _mjcf(loaded, trials, fit_poses)
    if usd:
        texts["robot.usda"] = _usd(loaded)
    with result_folder(out) as folder:
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
    print("Wrote " + ", ".join(str(out / name) for name in texts))


def _mjcf(robot: "Robot", trials: int, fit: int) -> str:
    """Model with its error, which is also printed."""
    from importlib.util import find_spec

    from hydrostat.export import find_omissions, mjcf_text
    from hydrostat.version import __version__, install_command

    mjcf_text(robot)  # rejects robots before poses are measured
    share, lines, tuning = 1.0, ["error not measured"], None
    if find_spec("mujoco") is None and not fit:
        lines[0] += f": {install_command('export')}"
    elif trials:
        share, lines, tuning = _measure(robot, trials, fit)
    omitted = ", ".join(find_omissions(robot))
    if omitted:
        lines.append(f"left out: {omitted}")
    if omitted and tuning:
        lines.append(
            "warning: the fitted numbers also compensate for what is left out. They are not those of a material"
        )
    for line in lines:
        print(f"MuJoCo model: {line}")
    controls = "controls: contraction of the winch of each cable [m]"
    winches = [
        f"winch {winch.name}: {', '.join(cable.name for cable in robot.cables if cable.winch == winch.name)}"
        for winch in robot.winches
    ]
    return mjcf_text(
        robot, remarks=[f"hydrostat {__version__}", *lines, controls, *winches], range_share=share, tuning=tuning
    )


def _measure(robot: "Robot", trials: int, fit: int) -> tuple[float, list[str], "MjcfTuning | None"]:
    """Share of the travel, lines with errors, and fitted numbers if they are used."""
    from hydrostat.export import measure_mjcf

    with progress_bar() as progress:
        found = measure_mjcf(robot, trials, progress=progress)
        if not fit:
            return found.range_share, [found.describe()], None
        if found.share is None:
            reason = f"no trial settled at {100 * found.range_share:g} % of the travel"
            return found.range_share, [found.describe(), f"not fitted: {reason}"], None
        lines, tuning = _fit(robot, trials, fit, found.share, progress)
    return found.share, [f"settled, unfitted: {found.describe()}", *lines], tuning


def _fit(
    robot: "Robot", trials: int, fit: int, share: float, progress: "Progress"
) -> tuple[list[str], "MjcfTuning | None"]:
    """Lines with errors of the fit, and its numbers if they are used."""
    from hydrostat.export import fit_mjcf, measure_mjcf

    try:
        fitted = fit_mjcf(robot, fit, share=share, progress=progress)
    except InputError as error:  # the measured model is still worth writing
        return [f"warning: not fitted: {error}"], None
    lines = fitted.describe()
    if not fitted.is_worth_it:
        return lines, None
    settled = measure_mjcf(robot, trials, tuning=fitted.tuning, shares=(share,), progress=progress)
    if settled.share is None:
        reason = f"the fitted model did not settle at {100 * share:g} % of the travel"
        return [*lines, f"warning: unfitted numbers kept: {reason}"], None
    return [*lines, f"settled, fitted: {settled.describe()}", fitted.tuning.describe(robot)], fitted.tuning


def _usd(robot: "Robot") -> str:
    from hydrostat.export import usd_text
    from hydrostat.plot import Film

    simulation = prepare_physics(robot)
    with progress_bar() as progress:
        stops = find_stops(simulation, list(robot.poses), progress)
        seconds = min(2.0 * (len(stops) + 1), 12.0)
        film = Film.of_stops(simulation, stops, seconds=seconds, progress=progress)
    return usd_text(robot, [frame.nodes for frame in film.frames], step=film.step)
