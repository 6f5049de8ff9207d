"""`KitMade`: a kit as the studio shows it and hands it over."""

from dataclasses import dataclass

from hydrostat.fabrication import Check, KitOptions
from hydrostat.studio.exporting.download import Download


@dataclass(frozen=True, kw_only=True)
class KitMade:
    """A kit, or why there is none.

    Attributes:
        options: that it was made with.
        refused: why the robot cannot be built well; then there is nothing but these.
        zip: all files; None if it was refused.
        count: of the files.
        summary: what is in it, a line each.
        warnings: what to mind.
        problems: why it cannot be built well, where it was made all the same.
        checks: whether the files are true to the robot that was simulated.
        pages: of the assembly sheet, as PNG.
        pattern: of a plush robot, as SVG.
    """

    options: KitOptions
    refused: tuple[str, ...] = ()
    zip: Download | None = None
    count: int = 0
    summary: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    problems: tuple[str, ...] = ()
    checks: tuple[Check, ...] = ()
    pages: tuple[bytes, ...] = ()
    pattern: bytes | None = None

    @property
    def told(self) -> str:
        """How many checks hold, such as "8 of 8 checks hold"."""
        held = sum(check.passed for check in self.checks)
        return f"{held} of {len(self.checks)} checks hold"
