"""`CorrectedLink`: motors that are commanded by contractions of a model that measurements have corrected."""

from dataclasses import replace
from pathlib import Path

from hydrostat.arrays import Vector
from hydrostat.control.link import Link
from hydrostat.identification import ContractionMap
from hydrostat.robot import Robot
from hydrostat.simulation import ProfileTable


def correct_table(table: ProfileTable, folder: Path, robot: Robot) -> ProfileTable:
    """Return the table of motor commands for a table of contractions, by the folder's correction.json, if any."""
    correction = ContractionMap.read(folder, robot)
    if correction is None:
        return table
    return replace(table, profile=replace(table.profile, values=correction.command(table.profile.values)))


class CorrectedLink(Link):
    """Link whose contractions are those of the model; the motors get those that a `ContractionMap` returns."""

    def __init__(self, link: Link, correction: ContractionMap) -> None:
        """Wrap a link."""
        self._link, self._correction = link, correction
        self.near = 2 * link.near

    @property
    def currents(self) -> Vector | None:
        """Latest motor currents, as in `Link` [A]."""
        return self._link.currents

    def send(self, contractions: Vector, now: float, *, speed: float) -> None:
        """Let the motors go to contractions of the model [m]; errors as in `Link`."""
        self._link.send(self._correction.command(contractions), now, speed=speed)

    def read(self, now: float) -> Vector:
        """Contractions of the model at the last reading [m]; errors as in `Link`."""
        return self._correction.effective(self._link.read(now))

    def stop(self) -> None:
        """Let the motors stay where they are."""
        self._link.stop()

    def close(self) -> None:
        """Stop the motors, and let them go."""
        self._link.close()
