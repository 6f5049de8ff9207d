"""`Gamepad`: a robot driven by the sticks of a gamepad."""

import os
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from hydrostat.errors import HydrostatError, InputError
from hydrostat.teleop.source import DriveChannels, DriveSource, DriveWish
from hydrostat.version import install_command

HELP = "cross: choose   stick: out, in   A: hold   B: rest   start: end"


class Gamepad(DriveSource):
    """A gamepad, with the names of its buttons as SDL knows them.

    The cross or the shoulder buttons choose a winch or marker; the left stick takes in (up) and lets out. Of a marker
    the left stick moves x and the last coordinate, the right stick up and down moves y. A holds, B rests, start ends.
    """

    def __init__(
        self, channels: DriveChannels, number: int = 0, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """The gamepad of a number (HydrostatError: there is none, or no pygame)."""
        os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
        os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
        os.environ.setdefault("SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS", "1")
        try:
            import pygame
            from pygame._sdl2 import controller
        except ModuleNotFoundError:
            raise InputError(f"gamepads need pygame-ce; install it: {install_command('teleop')}") from None
        pygame.display.init()
        controller.init()
        if number >= controller.get_count() or not controller.is_controller(number):
            raise HydrostatError(f"gamepad {number} is not there; plug it in, or switch it on")
        self._pygame: Any = pygame
        self._pad = controller.Controller(number)
        self._channels, self._clock, self._looked = channels, clock, clock()
        self._chosen, self._hold, self._down = 0, False, set[int]()

    def read(self) -> DriveWish:
        """Return the steps that the sticks gave the chosen channels since the previous read."""
        game, pad = self._pygame, self._pad
        game.event.pump()
        if not pad.attached():
            raise HydrostatError("gamepad disconnected; motors holding")
        now = self._clock()
        longest = 0.1  # Maximum time step counted between two readings of the sticks [s]
        passed, self._looked = min(now - self._looked, longest), now
        on, back = (
            (game.CONTROLLER_BUTTON_DPAD_RIGHT, game.CONTROLLER_BUTTON_RIGHTSHOULDER),
            (
                game.CONTROLLER_BUTTON_DPAD_LEFT,
                game.CONTROLLER_BUTTON_LEFTSHOULDER,
            ),
        )
        asked = (game.CONTROLLER_BUTTON_A, game.CONTROLLER_BUTTON_B, game.CONTROLLER_BUTTON_START)
        down = {button for button in (*on, *back, *asked) if pad.get_button(button)}
        pressed, self._down = down - self._down, down
        self._chosen += len(pressed & set(on)) - len(pressed & set(back))
        self._chosen %= len(self._channels.groups)
        self._hold ^= asked[0] in pressed
        rest = dict(zip(self._channels.names, self._channels.rest.tolist(), strict=True)) if asked[1] in pressed else {}
        return DriveWish(
            stamp=now,
            steps={} if rest else self._steps(passed),
            places=rest,
            hold=self._hold,
            over=asked[2] in pressed,
            words=f"{self._channels.title(self._chosen)}; {HELP}",
        )

    def close(self) -> None:
        """Let it go."""
        with suppress(Exception):
            self._pad.quit()

    def _steps(self, passed: float) -> dict[str, float]:
        game, group = self._pygame, self._channels.groups[self._chosen]
        up = -self._stick(game.CONTROLLER_AXIS_LEFTY)
        if len(group) == 1:
            speeds = {group[0]: up}
        else:
            speeds = {group[0]: self._stick(game.CONTROLLER_AXIS_LEFTX), group[-1]: up}
            speeds |= {group[1]: -self._stick(game.CONTROLLER_AXIS_RIGHTY)} if len(group) > 2 else {}
        fast = 0.04  # Speed of a channel at full deflection [m/s]
        return {self._channels.names[index]: fast * passed * speed for index, speed in speeds.items() if speed}

    def _stick(self, axis: int) -> float:
        """Deflection from -1 to 1, 0 about its middle."""
        value = max(-1.0, self._pad.get_axis(axis) / 32767)
        dead = 0.12  # Share of the way of a stick that is taken for its middle
        return 0.0 if abs(value) < dead else (abs(value) - dead) / (1 - dead) * (1 if value > 0 else -1)
