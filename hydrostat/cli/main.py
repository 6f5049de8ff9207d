"""The `hydrostat` command."""

import gc
import logging
import os
import sys
import warnings
from collections.abc import Callable
from copy import copy
from functools import wraps
from typing import Any

import typer

from hydrostat.cli.animate import animate
from hydrostat.cli.branches import branches
from hydrostat.cli.calibrate import calibrate
from hydrostat.cli.check import check
from hydrostat.cli.compare import compare
from hydrostat.cli.design import design
from hydrostat.cli.drive import drive
from hydrostat.cli.export import export
from hydrostat.cli.fabricate import fabricate
from hydrostat.cli.firmware import firmware
from hydrostat.cli.grasp import grasp
from hydrostat.cli.identify import identify
from hydrostat.cli.learn import learn
from hydrostat.cli.materials import materials
from hydrostat.cli.measure import measure
from hydrostat.cli.mimic import mimic
from hydrostat.cli.new import new
from hydrostat.cli.option_errors import describe_usage_error
from hydrostat.cli.play import play
from hydrostat.cli.pose import pose
from hydrostat.cli.reproduce import PASS_ON, reproduce
from hydrostat.cli.sample import sample
from hydrostat.cli.scale import scale
from hydrostat.cli.share import share
from hydrostat.cli.simulate import simulate
from hydrostat.cli.studio import studio
from hydrostat.cli.train import train
from hydrostat.cli.trajectory import trajectory
from hydrostat.cli.waiting import heed_interrupts, outlive_readers
from hydrostat.errors import HydrostatError, HydrostatWarning, InputError, in_words

app = typer.Typer(
    name="hydrostat",
    help="Design, simulate and build tendon-driven (cable-driven) soft robots.",
    epilog="Start with: hydrostat new my_starfish --from gallery:starfish",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


class _InterruptError(Exception):
    """Ctrl-C, which typer would turn into an exit code of its own."""


_TURN_MOTORS = (calibrate, play, drive, mimic)
"""Commands that end where nobody reads any more what they print; others go on, and end as they would have."""


def _interruptible(command: Callable[..., None]) -> Callable[..., None]:
    """The command; Ctrl-C in it reaches `main`."""

    @wraps(command)
    def run(*arguments: Any, **options: Any) -> None:
        if command not in _TURN_MOTORS:
            outlive_readers()
        try:
            command(*arguments, **options)
        except KeyboardInterrupt:
            raise _InterruptError from None

    return run


for command in (
    new,
    scale,
    check,
    simulate,
    branches,
    pose,
    trajectory,
    firmware,
    calibrate,
    play,
    drive,
    mimic,
    animate,
    share,
    export,
    design,
    fabricate,
    measure,
    compare,
    identify,
    grasp,
    sample,
    learn,
    train,
    reproduce,
    studio,
    materials,
):
    app.command(context_settings=PASS_ON if command is reproduce else None)(_interruptible(command))


@app.callback(invoke_without_command=True)
def version(show: bool = typer.Option(False, "--version", help="Print the version and exit.")) -> None:
    """Design, simulate and build tendon-driven (cable-driven) soft robots."""
    if show:
        from hydrostat.version import __version__

        print(f"hydrostat {__version__}")
        raise typer.Exit


def main() -> None:
    """Run a command. Exit codes: 0 done, 1 ran and did not succeed, 2 the input is wrong, 130 stopped by Ctrl-C."""
    heed_interrupts()
    gc.set_threshold(50_000, *gc.get_threshold()[1:])  # looking for garbage is a tenth of a short command
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # such as that a home cannot be written to
    warnings.simplefilter("ignore", HydrostatWarning)  # commands print the warnings of a pose
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the dense matrices are small: threads only wait
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # it would look for them in all installed packages
    setattr(typer.BadParameter.__base__, "show", _print_usage_error)  # noqa: B010 - usage errors in one line, too
    try:
        _run()
    except InputError as error:
        _stop(f"error: {in_words(str(error))}", 2)
    except HydrostatError as error:
        _stop(f"error: {in_words(str(error))}", 1)
    except BrokenPipeError:
        _close_quietly()
    except OSError as error:
        _stop(f"error: {error.filename or 'output'}: {error.strerror or error}", 2)
    except (KeyboardInterrupt, _InterruptError):
        _stop("interrupted; files written so far are complete", 130)


def _print_usage_error(error: Any, *_: object) -> None:
    words = describe_usage_error(error)
    words += "" if words.endswith("?") else "."
    print(f"hydrostat: error: {words} See {error.ctx.command_path if error.ctx else 'hydrostat'} -h.", file=sys.stderr)


def _run() -> None:
    """Run the app; what it printed is out when it ends, so that a full disk or a closed pipe is noticed here."""
    try:
        _only(sys.argv[1:2])(prog_name="hydrostat")
    except SystemExit as stop:
        sys.stdout.flush()
        if isinstance(getattr(stop.__context__, "__cause__", None), KeyboardInterrupt):  # while typer read the options
            raise KeyboardInterrupt from None
        raise


def _only(words: list[str]) -> typer.Typer:
    """The app with the named command alone: the options of the others need not be read. All of it for other words."""
    named = [each for each in app.registered_commands if each.callback and [each.callback.__name__] == words]
    chosen = copy(app)
    chosen.registered_commands = named or app.registered_commands
    return chosen


def _close_quietly() -> None:
    """End as a program does whose reader has gone, such as `head`: without a word."""
    _discard_output()
    raise SystemExit(1)


def _discard_output() -> None:
    """Send what is still to be printed nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _stop(message: str, code: int) -> None:
    line = " ".join(message.split())
    print(f"hydrostat: {line}", file=sys.stderr)
    try:
        sys.stdout.flush()
    except OSError:  # else Python tries again when it exits, and ends with 120
        _discard_output()
    raise SystemExit(code)
