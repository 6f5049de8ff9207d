"""`write_report`: the whole story of a design on one page that needs no other file and no network."""

from collections.abc import Mapping
from pathlib import Path

from hydrostat.design.network import Network
from hydrostat.errors import InputError
from hydrostat.plot.html import Html, safe, tag
from hydrostat.plot.report_hero import hero
from hydrostat.plot.report_stages import stages
from hydrostat.plot.report_style import STYLE
from hydrostat.plot.report_tables import footer


def write_report(
    network: Network, path: str | Path, *, title: str | None = None, facts: Mapping[str, object] | None = None
) -> Path:
    """Write the report of a design as one HTML file, whole or not at all; returns its path.

    Args:
        network: the design.
        path: of the file.
        title: headline; the robot's name if left out.
        facts: more lines for the end of the page, such as options and seed, in their order.

    Raises:
        InputError: a network of which no pose was tried.
    """
    from hydrostat.robot.write import replace_file

    return replace_file(Path(path), report_text(network, title=title, facts=facts).encode(errors="replace"))


def report_text(network: Network, *, title: str | None = None, facts: Mapping[str, object] | None = None) -> str:
    """The report as text; see `write_report`."""
    if not network.reached:
        raise InputError("a report needs at least one pose that the network was tried on; this one has none")
    name = title or network.robot.name
    head = tag(
        "head",
        Html('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'),
        Html('<meta name="color-scheme" content="light dark">'),
        tag("title", f"{name} \N{MIDDLE DOT} hydrostat"),
        tag("style", Html(STYLE)),
    )
    main = tag("main", hero(network, name), *stages(network), footer(network, facts or {}))
    return f'<!doctype html>\n<html lang="en">{head}<body>{safe(main)}</body></html>\n'
