"""`restart_motors`: motors that switched themselves off by overload or heat, cooled and made ready again."""

import time
from collections.abc import Callable, Sequence

from hydrostat.control.bus import Bus, Reading, steady
from hydrostat.errors import HydrostatError

COOL_TEMPERATURE, MAX_WAIT, POLL_INTERVAL = 50.0, 900.0, 5.0
"""A motor is cool below this temperature [degree C]; longest time to wait for it, and time between two looks [s]."""


def fault_words(name: str, reading: Reading, index: int) -> str:
    """Sentences on the fault of a motor, by the name of its winch: which, and how to free it."""
    words = f"the motor of {name} reports: {reading.faults[index]}"
    if "voltage" in words:
        words += f" ({reading.volts[index]:.1f} V measured). Charge its battery, or check its supply and leads"
    if _is_off(reading, index):
        words += ". Free its cable, then run hydrostat calibrate --restart, which waits until the motor is cool"
    return words


def restart_motors(
    bus: Bus,
    names: Sequence[str],
    say: Callable[[str], None],
    forget: Callable[[Sequence[int]], None],
    *,
    clock: Callable[[], float] = steady,
    wait: Callable[[float], None] = time.sleep,
) -> tuple[str, ...]:
    """Wait until motors with an overload or heat fault are cool, then restart them; return the names of their winches.

    Nothing turns: identify and arm the motors afterwards. `say` gets their temperatures. `forget` gets the motor
    indices before any restart: a restarted motor may lose its count of turns, so its old zero is void.

    Raises:
        HydrostatError: a motor stays warm for too long, or keeps its fault.
    """
    began = clock()
    while True:
        reading = bus.read()
        off = [index for index in range(len(names)) if _is_off(reading, index)]
        warmest = max(off, key=lambda index: float(reading.temperatures[index]), default=-1)
        if warmest < 0 or reading.temperatures[warmest] < COOL_TEMPERATURE:
            break
        words = f"{names[warmest]}: its motor is {reading.temperatures[warmest]:.0f} °C warm"
        if clock() - began > MAX_WAIT:
            raise HydrostatError(f"{words} after {MAX_WAIT / 60:.0f} min. Switch the power off and find what heats it")
        say(f"{words}. Waiting until it is below {COOL_TEMPERATURE:.0f} °C")
        wait(POLL_INTERVAL)
    if off:
        forget(off)
    for index in off:
        bus.restart(index)
    reading = bus.read()
    for index in off:
        if _is_off(reading, index):
            raise HydrostatError(f"{fault_words(names[index], reading, index)}. If that does not help, cut its power")
    return tuple(names[index] for index in off)


def _is_off(reading: Reading, index: int) -> bool:
    """Return True if a motor is off by overload or heat."""
    return any(word in reading.faults[index] for word in ("overload", "hot", "current too large"))
