"""`open_record`, `write_record`: search.json, from which `hydrostat design --resume` continues."""

import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from hydrostat.errors import InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.design import DesignRequest, Network, SearchRecord
    from hydrostat.robot import Robot

RECORDS = _FILE, _OLD = "search.json", "search.old.json"
"""Files of a search that stand in a result folder before the results."""


def open_record(out: Path, robot: "Robot", request: "DesignRequest", *, resume: bool) -> "SearchRecord":
    """Open the record in a folder to resume its search, or a new one (InputError: the record is of another search).

    The file is written while the search goes on, so that a killed one can be resumed.
    """
    from hydrostat.design import SearchRecord

    if not resume:
        if (out / _FILE).exists():  # a search that was stopped here is not overwritten
            (out / _FILE).replace(out / _OLD)
        return _keep_written(SearchRecord(), out, robot, request)
    if not (out / _FILE).exists():
        raise InputError(f"--resume: {out} has no {_FILE}, so no search was stopped there. Start without --resume.")
    record = SearchRecord.read(out / _FILE, robot, request)
    print(f"resuming after {plural(len(record.known), 'step')}", file=sys.stderr, flush=True)
    return _keep_written(record, out, robot, request)


def _keep_written(record: "SearchRecord", out: Path, robot: "Robot", request: "DesignRequest") -> "SearchRecord":
    """Write a record after its steps, in at most a fiftieth of the time of the search."""
    wait, share = 1.0, 50  # least time between two files [s]; the same in times that a file took
    due = time.perf_counter() + wait

    def write() -> None:
        nonlocal due
        began = time.perf_counter()
        if began < due:
            return
        with suppress(InputError, OSError):  # a full disk ends no search
            out.mkdir(parents=True, exist_ok=True)
            record.write(out / _FILE, robot, request)
        due = began + max(wait, share * (time.perf_counter() - began))

    record.on_step = write
    return record


def tell_record(out: Path) -> str:
    """Words on the record of a search that found no network."""
    return f"to continue, add --resume ({out / _FILE})" if (out / _FILE).exists() else "no files written"


def write_record(
    record: "SearchRecord", network: "Network", out: Path, robot: "Robot", request: "DesignRequest"
) -> None:
    """Write the steps of a search that was stopped next to its results; remove those of one that is complete."""
    if not network.complete and (record.steps or record.known):
        record.write(out / _FILE, robot, request)
        print(f"To continue the search, run the same command with --resume ({out / _FILE})")
    elif network.complete:
        (out / _FILE).unlink(missing_ok=True)
