"""`BoardKind`: a small board that turns geared motors with our firmware, and which pin is for what."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class BoardKind:
    """A board that the firmware is for.

    Attributes:
        chip: processor, by its name in compilers.
        motors: number of geared DC motors with encoders that it drives.
        loader: options of avrdude for its bootloader.
        wiring: pins for each motor: PWM and direction to the driver, encoder A and B, the driver's current sense.
    """

    chip: str
    motors: int
    loader: tuple[str, ...]
    wiring: Sequence[tuple[str, str, str, str, str]]


BOARDS = {
    "uno": BoardKind(
        chip="atmega328p",
        motors=2,
        loader=("-c", "arduino", "-b", "115200"),
        wiring=(("6", "4", "A0", "A1", "A4"), ("5", "7", "A2", "A3", "A5")),
    ),
    "mega": BoardKind(
        chip="atmega2560",
        motors=6,
        loader=("-c", "wiring", "-b", "115200", "-D"),
        wiring=(
            ("5", "22", "53", "52", "A0"),
            ("2", "23", "51", "50", "A1"),
            ("3", "24", "A8", "A9", "A2"),
            ("6", "25", "A10", "A11", "A3"),
            ("7", "26", "A12", "A13", "A4"),
            ("8", "27", "A14", "A15", "A5"),
        ),
    ),
}
"""By the names that `board.h` gives them; a test holds the pins equal to those there."""


def board_for(motors: int) -> str:
    """Name of the smallest board that drives a number of motors, else of the largest."""
    return next((name for name, kind in BOARDS.items() if kind.motors >= motors), list(BOARDS)[-1])
