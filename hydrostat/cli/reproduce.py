"""`hydrostat reproduce`: the entry to the studies in `lab/`, which the package does not contain."""

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer
from typer.main import get_command

from hydrostat.errors import InputError

LAB = Path(__file__).resolve().parents[2] / "lab"
"""Folder of the studies, next to the package of a checkout."""


def reproduce(
    arguments: Annotated[list[str] | None, typer.Argument(metavar="...", help="Arguments of the laboratory.")] = None,
) -> None:
    """Reproduce tables and figures of Chang (2018).

    Needs hydrostat-lab, which a checkout contains in lab/. All arguments are passed on: add --help to list them.

    Example: hydrostat reproduce table-5.1 figure-5.14 --out build/thesis
    """
    if find_spec("hydrostat_lab") is None:
        if not (LAB / "hydrostat_lab").is_dir():
            raise InputError("package hydrostat-lab not found. Clone hydrostat and run: pip install --editable lab")
        sys.path.append(str(LAB))
    from hydrostat_lab.reproduce import app

    command = get_command(app)
    with command.make_context("hydrostat reproduce", list(arguments or ())) as context:
        command.invoke(context)


PASS_ON = {"ignore_unknown_options": True, "help_option_names": list[str]()}
"""Settings of the command: it keeps all arguments, also --help, for the laboratory."""
