"""The firmware with emulated motors, by simavr, or an ESP32's sketch by a stand-in: a serial port in memory."""

import ctypes
import shutil
import subprocess
import tempfile
import zlib
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from builders import strip_robot

from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedScs, EmulatedSts
from hydrostat.control.firmware_build import BOARDS, build_firmware
from hydrostat.control.firmware_bus import line_of
from hydrostat.robot import Robot

SOURCE = Path(__file__).with_name("winch_bench.c")
FIRMWARE = Path(__file__).parents[2] / "hydrostat" / "control" / "firmware"
HEADER = Path("/usr/include/simavr/sim_avr.h")


class Plant(ctypes.Structure):
    """A winch with its motor; see `winch_bench.c`. Places are counts of the encoder."""

    _fields_ = (
        *[(name, ctypes.c_int) for name in ("duty", "control", "bit", "port", "direction", "adc")],
        ("encoder", ctypes.c_char),
        *[(name, ctypes.c_int) for name in ("channel", "block")],
        *[
            (name, ctypes.c_double)
            for name in ("angle", "speed", "current", "stiffness", "slack", "wire", "fastest", "least", "most")
        ],
        ("cut", ctypes.c_int),
    )


@cache
def folder() -> Path:
    """Where this run of the tests builds."""
    if not (shutil.which("avr-gcc") and shutil.which("gcc") and HEADER.exists()):
        pytest.skip("avr-gcc, gcc or libsimavr-dev is not installed")
    made = Path(tempfile.mkdtemp(prefix="winches"))
    options = ["-O2", "-shared", "-fPIC", "-o", str(made / "bench.so"), str(SOURCE)]
    subprocess.run(["gcc", *options, "-lsimavr", "-lm"], check=True)
    return made


@cache
def stand_in() -> Path:
    """The bench of an ESP32-S3."""
    bench = Path(tempfile.mkdtemp(prefix="winches")) / "esp32.so"
    compile_for_host(SOURCE.with_name("esp32_bench.cpp"), bench)
    return bench


def compile_for_host(source: Path, library: Path) -> None:
    """Compile C++ against the stand-in of Espressif's package."""
    if not shutil.which("g++"):
        pytest.skip("g++ is not installed")
    flags = ["-std=gnu++17", "-O1", "-shared", "-fPIC", "-fno-gnu-unique", "-Wall", "-Wextra", "-Werror"]
    include = ["-I", str(SOURCE.with_name("esp32"))]
    subprocess.run(["g++", *flags, *include, "-o", str(library), str(source), "-ldl"], check=True)


@cache
def program(chip: str, settings: str) -> Path:
    """The firmware with settings, built as `hydrostat firmware` builds it: what is flashed, with its symbols."""
    board = next(name for name, kind in BOARDS.items() if kind.chip == chip)
    home = stand_in().parent if chip == "esp32s3" else folder()
    image = build_firmware(settings, board, home / f"{chip}-{zlib.crc32(settings.encode()):x}")
    if chip != "esp32s3":
        return image.with_suffix(".elf")
    compile_for_host(image.with_suffix(".cpp"), image.with_suffix(".so"))
    return image.with_suffix(".so")


class Board:
    """A board that is switched on; as a serial port it has pyserial's methods."""

    def __init__(self, chip: str = "atmega328p", *, full: bool = False, settings: str = "") -> None:
        """Start the firmware on a chip: of two winches for trying, of all that a Mega bears, or with settings."""
        file = SOURCE.with_name("full_settings.h") if full else FIRMWARE / "settings.h"
        settings = settings or file.read_text()
        is_host = chip == "esp32s3"
        self._bench = ctypes.CDLL(
            str(stand_in() if is_host else folder() / "bench.so"), mode=ctypes.RTLD_GLOBAL if is_host else 0
        )
        self._bench.bench_plant.restype = ctypes.POINTER(Plant)
        self._bench.bench_supply.argtypes = [ctypes.c_double]
        self._bench.bench_press.argtypes = [ctypes.c_char, ctypes.c_int, ctypes.c_int]
        self._bench.bench_seconds.restype = self._bench.bench_pulse.restype = ctypes.c_double
        if is_host:
            for plant, wires in enumerate(BOARDS[chip].wiring[:2]):
                self._bench.bench_wire(plant, *map(int, wires))
        assert self._bench.bench_start(str(program(chip, settings)).encode(), chip.encode(), int(full)) == 0
        self.winches = [self._bench.bench_plant(index).contents for index in range(2)]
        self.timeout: float | None = 0.02
        self._button = {"atmega328p": (b"D", 2), "atmega2560": (b"B", 6)}.get(chip, (b"-", 0))
        self._got = b""
        self.number = 0
        self.run(0.01)

    def run(self, seconds: float) -> None:
        """Let so much of its time pass."""
        assert self._bench.bench_run(round(1e6 * seconds)) == 0
        into = ctypes.create_string_buffer(1 << 16)
        count = self._bench.bench_heard(into, len(into))
        self._got += into.raw[:count]

    def clock(self) -> float:
        """Its time [s]."""
        return self._bench.bench_seconds()

    def write(self, data: bytes) -> int:
        """Send bytes to it."""
        self._bench.bench_send(data, len(data))
        return len(data)

    def read(self, size: int) -> bytes:
        """Bytes from it."""
        until = self.clock() + (self.timeout or 0.0)
        while len(self._got) < size and self.clock() < until:
            self.run(0.5e-3)
        found, self._got = self._got[:size], self._got[size:]
        return found

    @property
    def in_waiting(self) -> int:
        """Bytes that are here."""
        return len(self._got)

    def pulse(self) -> float:
        """The last pulse of the first servo [s]."""
        return self._bench.bench_pulse()

    def press(self, seconds: float = 0.1) -> None:
        """Press its button for so long, and let it go for 0.05 s."""
        for down, time in ((1, seconds), (0, 0.05)):
            self._bench.bench_press(*self._button, down)
            self.run(time)

    def feed(self, volts: float) -> None:
        """Set the supply of its motors, at its divider [V]."""
        self._bench.bench_supply(volts)

    def is_lit(self) -> bool:
        """Whether its light is on."""
        return bool(self._bench.bench_light())

    def close(self) -> None:
        """Let it go."""

    def hang(self) -> None:
        """Let its program hang."""
        self._bench.bench_hang()

    def ask(self, words: str, *, number: int | None = None) -> str:
        """What it answers to a line, without number and checksum."""
        self.number = (self.number + 1) % 256 if number is None else number
        return self.ask_bytes(line_of(f"{self.number} {words}"))

    def ask_bytes(self, data: bytes) -> str:
        """What it answers to bytes."""
        self._got = b""
        self.write(data)
        self.run(40e-6 * len(data) + 10e-3)
        text, self._got = self._got.decode(), b""
        assert all(line_of(each.partition("*")[0]).decode() == each for each in text.splitlines(keepends=True)), text
        return " ".join(each.partition("*")[0].partition(" ")[2] for each in text.splitlines())

    def keep(self, seconds: float, words: str = "R") -> str:
        """Talk to it for so long, 25 times a second."""
        said = ""
        for _ in range(round(25 * seconds)):
            said = self.ask(words)
            self.run(0.03)
        return said


class ServoBoard(Board):
    """An ESP32-S3 with emulated Feetech servos on its line.

    Attributes:
        chain: the servos.
        line: all bytes that the board sent to them.
        echoes: True if the adapter gives back each byte that it sends.
    """

    def __init__(self, servos: Sequence[EmulatedSts | EmulatedScs], settings: str, *, echoes: bool = False) -> None:
        """Start the sketch."""
        self.chain, self.line, self.echoes = EmulatedFeetechChain(servos), b"", echoes
        super().__init__("esp32s3", settings=settings)

    def run(self, seconds: float) -> None:
        """Let so much time pass, for the board and its servos."""
        into, step = ctypes.create_string_buffer(1 << 12), self.chain.STEP
        for _ in range(max(1, round(seconds / step))):
            super().run(step)
            count = self._bench.bench_told(into, len(into))
            if sent := into.raw[:count]:
                self.line += sent
                self.chain.write(sent)
            if waiting := self.chain.in_waiting:
                answer = (sent if self.echoes else b"") + self.chain.read(waiting)  # which lasts a step
                self._bench.bench_answer(answer, len(answer))
            else:
                self.chain.wait(step)


def two_winch_strip() -> Robot:
    """Two winches that take in 30 mm, on spools of 5 mm."""
    strip = strip_robot(columns=4, rows=1)
    winches = tuple(replace(each, travel=0.03, release=0.0, spool_radius=0.005) for each in strip.winches[:2])
    names = {winch.name for winch in winches}
    return replace(strip, winches=winches, cables=tuple(each for each in strip.cables if each.winch in names))
