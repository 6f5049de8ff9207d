"""`Step`: one thing to do, and how long it takes."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Step:
    """One thing to do.

    Attributes:
        title: what.
        minutes: about how long it keeps a person busy.
        wait: how long to wait after it, in words; empty for not at all.
        text: how, in short sentences.
    """

    title: str
    minutes: float
    text: str
    wait: str = ""

    @property
    def time(self) -> str:
        """About how long it takes, in words."""
        busy = minutes_text(self.minutes)
        return f"{busy}, then {self.wait}" if self.wait else busy


def minutes_text(minutes: float) -> str:
    """A time in minutes up to an hour and a half, to full five; then in half hours; in full ones from ten on."""
    if minutes <= 90:
        return f"{max(5 * round(minutes / 5), 5)} min"
    hours = round(minutes / 30) / 2 if minutes < 600 else round(minutes / 60)
    return f"{hours:g} h"


def count_text(count: int, thing: str, many: str = "") -> str:
    """A number of things, such as "1 winch", "3 cables"."""
    return f"{count} {thing if count == 1 else many or thing + 's'}"
