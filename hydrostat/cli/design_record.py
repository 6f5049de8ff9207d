"""`open_record`, `write_record`: search.json, from which `hydrostat design --resume` continues."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from hydrostat.errors import InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.design import DesignRequest, Network, SearchRecord
    from hydrostat.robot import Robot

_FILE = "search.json"


def open_record(out: Path, robot: "Robot", request: "DesignRequest", *, resume: bool) -> "SearchRecord":
    """Open the record in a folder to resume its search, or a new one (InputError: the record is of another search)."""
    from hydrostat.design import SearchRecord

    if not resume:
        return SearchRecord()
    if not (out / _FILE).exists():
        raise InputError(f"--resume: {out} has no {_FILE}, so no search was stopped there. Start without --resume.")
    record = SearchRecord.read(out / _FILE, robot, request)
    print(f"resuming after {plural(len(record.known), 'step')}", file=sys.stderr, flush=True)
    return record


def write_record(
    record: "SearchRecord", network: "Network", out: Path, robot: "Robot", request: "DesignRequest"
) -> None:
    """Write the steps of a search that was stopped next to its results; remove those of one that is complete."""
    if not network.complete and (record.steps or record.known):
        record.write(out / _FILE, robot, request)
        print(f"To continue the search, run the same command with --resume ({out / _FILE})")
    elif network.complete:
        (out / _FILE).unlink(missing_ok=True)
