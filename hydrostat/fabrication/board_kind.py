"""`BoardKind`: boards that drive geared DC motors, or Feetech servos, by our firmware."""

from collections.abc import Sequence
from dataclasses import dataclass

from hydrostat.errors import InputError
from hydrostat.given import list_choices


@dataclass(frozen=True, kw_only=True)
class BoardKind:
    """A board that the firmware is for.

    Attributes:
        title: name by which it is bought.
        chip: processor, by its name in compilers.
        motors: number of geared DC motors with encoders that it drives.
        servos: number of Feetech servos on one line that it drives.
        loader: options of avrdude for its bootloader; empty where the Arduino IDE builds and flashes a sketch.
        wiring: pins for each motor: PWM and direction to the driver, encoder A and B, the driver's current sense.
        supply: pin that a divider of 47 kOhm over 10 kOhm leads the supply of the motors to.
        button: pin of the button that starts moves that play alone; it closes to GND.
        room: bytes of its program memory that such moves may take, beside program and bootloader.
        servo_pins: pins to TX and RX of a bus adapter; empty where it drives no servos.
        light: pin of the light that is on while the button works; empty where the light is on the board.
    """

    title: str
    chip: str
    motors: int
    servos: int = 0
    loader: tuple[str, ...]
    wiring: Sequence[tuple[str, str, str, str, str]]
    supply: str
    button: str
    room: int
    servo_pins: tuple[str, ...] = ()
    light: str = ""

    @property
    def button_name(self) -> str:
        """Name of the button and its place."""
        return f"between pin {self.button} and GND" if self.loader else f"BOOT (pin {self.button})"


BOARDS = {
    "uno": BoardKind(
        title="Arduino Uno",
        chip="atmega328p",
        motors=2,
        loader=("-c", "arduino", "-b", "115200"),
        wiring=(("6", "4", "A0", "A1", "A4"), ("5", "7", "8", "9", "A5")),
        supply="A3",
        button="2",
        room=23_000,
    ),
    "mega": BoardKind(
        title="Arduino Mega",
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
        supply="A7",
        button="12",
        room=32_000,
    ),
    "esp32s3": BoardKind(
        title="ESP32-S3-DevKitC-1",
        chip="esp32s3",
        motors=4,
        servos=16,
        loader=(),
        wiring=(
            ("15", "16", "39", "40", "1"),
            ("17", "18", "41", "42", "2"),
            ("11", "12", "9", "10", "4"),
            ("13", "14", "21", "47", "5"),
        ),
        supply="6",
        button="0",
        room=120_000,
        servo_pins=("17", "18"),
        light="7",
    ),
}
"""By the names that `avr.h` and `esp32s3.h` give them; a test holds the pins equal to those there."""


def board_for(motors: int) -> str:
    """Name of the smallest Arduino that drives a number of motors, else of the largest."""
    return next((name for name, kind in BOARDS.items() if kind.loader and kind.motors >= motors), "mega")


def check_board(board: str) -> BoardKind:
    """A board by its name (InputError: no such one)."""
    if board not in BOARDS:
        raise InputError(f"--board {board}: unknown board. {list_choices('boards', list(BOARDS), board)}")
    return BOARDS[board]
