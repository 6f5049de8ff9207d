"""`LoadDrive`: a control that scales loads, such as a thumb that presses or the pump of several chambers."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from hydrostat.errors import InputError
from hydrostat.given import check_name, check_number, list_choices
from hydrostat.robot.load import MAX_SHARE, Load


@dataclass(frozen=True, kw_only=True)
class LoadDrive:
    """Control that scales the loads that name it; its value is the share that acts, 0 at rest.

    Attributes:
        name: name, unique among drives and winches.
        min: least share, at most 0.
        max: largest share, at least 0.

    Raises:
        InputError: limits that do not include 0, or a share beyond 100.
    """

    name: str
    min: float
    max: float
    turns: ClassVar[bool] = False
    unit: ClassVar[str] = "share"

    def __post_init__(self) -> None:
        check_name(self.name)
        for key, sign in (("min", -1), ("max", 1)):
            check_number(key, value := getattr(self, key), "")
            if not 0 <= sign * value <= MAX_SHARE:
                low, high = sorted((0.0, sign * MAX_SHARE))
                raise InputError(f"{key} must be a share of the loads from {low:g} to {high:g}, not {value:g}")

    @property
    def limits(self) -> tuple[float, float]:
        """Least and largest share."""
        return self.min, self.max

    @property
    def column(self) -> tuple[str, float]:
        """Column header in tables, and the factor from SI."""
        return f"{self.name}_share", 1.0

    def format_value(self, value: float) -> str:
        """Return a value as text."""
        return f"{value:.4g}"

    def parse(self, text: str) -> float:
        """Return the share from a text such as "0.5" (InputError: not a share)."""
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(f'this drive scales loads. Write a share without unit, such as 0.5, not "{text}"')
        return value

    def with_transform(self, move: Callable[..., Any], scale: Callable[..., Any]) -> "LoadDrive":
        """Return the same drive: loads are not scaled with a body."""
        return self


def check_load_drives(drives: Sequence[LoadDrive], loads: Sequence[Load]) -> None:
    """Reject loads of an unknown drive, and drives that scale no load (InputError)."""
    names = [drive.name for drive in drives]
    for index, load in enumerate(loads):
        if load.drive is not None and load.drive not in names:
            known = list_choices("drives of loads", names, load.drive)
            raise InputError(f'load[{index}].drive: unknown drive "{load.drive}". {known}')
    for name in names:
        if name not in {load.drive for load in loads}:
            raise InputError(f'drive "{name}" scales no load. Add drive = "{name}" to a [[load]].')
