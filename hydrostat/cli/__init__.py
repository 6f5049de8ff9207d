"""Command line: one thin file for each command. The program starts at `start.py`; the door holds what they share."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.cli.folders import require_folder
    from hydrostat.cli.waiting import one_interrupt, report_progress

__all__ = ["one_interrupt", "report_progress", "require_folder"]

open_package(__name__)
