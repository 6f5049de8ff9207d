"""`HydrostatRobot`: the winches of a soft robot as a robot of LeRobot; actions and observations are millimeters."""

import threading
import time
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from lerobot.robots import Robot, RobotConfig

from hydrostat.control import Motors, SimulatedLink, arm_motors, check_port
from hydrostat.errors import HydrostatError
from hydrostat.robot import load_robot
from hydrostat.simulation import Simulation
from hydrostat.teleop import WinchMapper

PATIENCE = 0.2
"""Motors stand when no action was sent for so long [s], as a link that is told nothing; the next action goes on."""


@RobotConfig.register_subclass("hydrostat")
@dataclass(kw_only=True)
class HydrostatRobotConfig(RobotConfig):
    """Which robot, and on which motors.

    Attributes:
        robot: its folder, or gallery:NAME.
        port: of its motors, such as dynamixel:/dev/ttyUSB0, or emulated; empty for simulated ones.
    """

    robot: str
    port: str = ""


class HydrostatRobot(Robot):
    """Winches that go where actions say, within their limits; a thread of its own tells motors that somebody is there.

    Observations are what winches have taken in, and what their motors draw where they measure it.
    """

    config_class = HydrostatRobotConfig
    name = "hydrostat"

    def __init__(self, config: HydrostatRobotConfig) -> None:
        """The robot of a config (InputError: there is none)."""
        super().__init__(config)
        self.config = config
        if config.port:
            check_port(config.port)
        self._robot = load_robot(config.robot)
        self._names = [winch.name.replace(" ", "_") for winch in self._robot.winches]
        self._motors: Motors | None = None
        self._lock, self._over = threading.Lock(), threading.Event()
        self._error, self._asked = "", -np.inf

    @cached_property
    def action_features(self) -> dict[str, type]:
        """What each winch shall take in [mm]."""
        return {f"{name}.pos": float for name in self._names}

    @cached_property
    def observation_features(self) -> dict[str, type]:
        """What each winch has taken in [mm], and what its motor draws [A]."""
        return self.action_features | ({f"{name}.current": float for name in self._names} if self.config.port else {})

    @property
    def is_connected(self) -> bool:
        """Whether motors are armed."""
        return self._motors is not None

    @property
    def is_calibrated(self) -> bool:
        """Always: `hydrostat calibrate` keeps motors.toml beside robot.toml, and without it motors do not arm."""
        return True

    def connect(self, calibrate: bool = True) -> None:
        """Identify and arm the motors (HydrostatError: one is silent; InputError: no motors.toml)."""
        del calibrate
        if self._motors is not None:
            raise HydrostatError("the motors are connected already")
        rest = np.zeros(len(self._names))
        self._way = WinchMapper(Simulation(self._robot), rest, solves=bool(self.config.port))
        try:
            if self.config.port:
                known, folder = self._way.known, Path(self.config.robot)
                self._motors = arm_motors(folder, self._robot, self.config.port, known.nearest, known=known)
            else:
                self._motors = Motors(self._robot.winches, SimulatedLink(rest))
        except BaseException:
            self._way.close()
            raise
        self._error, self._over = "", threading.Event()
        self._thread = threading.Thread(target=self._drive, name="motors", daemon=True)
        self._thread.start()

    def calibrate(self) -> None:
        """Say how: motors turn while their cables are felt, so this is a command of its own."""
        raise HydrostatError("calibrate by: hydrostat calibrate ROBOT --motors KIND:PORT")

    def configure(self) -> None:
        """Nothing is set: limits and currents are those of robot.toml and motors.toml."""

    def get_observation(self) -> dict[str, Any]:
        """What was last heard of the motors (HydrostatError: they have stopped, with the reason)."""
        motors = self._armed()
        with self._lock:
            places, currents = motors.places.copy(), motors.link.currents
        told = {f"{name}.pos": 1e3 * float(place) for name, place in zip(self._names, places, strict=True)}
        if self.config.port:
            drawn = np.full(len(places), np.nan) if currents is None else currents
            told |= {f"{name}.current": float(each) for name, each in zip(self._names, drawn, strict=True)}
        return told

    def send_action(self, action: dict[str, Any]) -> dict[str, Any]:
        """Let winches go there, and give what was asked of motors within their limits [mm].

        Raises:
            HydrostatError: the motors have stopped, with the reason.
            InputError: a number is not finite.
        """
        motors = self._armed()
        with self._lock:
            wanted = motors.command.copy()
            for index, name in enumerate(self._names):
                wanted[index] = 1e-3 * float(action.get(f"{name}.pos", 1e3 * wanted[index]))
            motors.ask(wanted)
            self._asked = time.monotonic()
            return {f"{name}.pos": 1e3 * float(each) for name, each in zip(self._names, motors.command, strict=True)}

    def disconnect(self) -> None:
        """Stop the motors, and let them go."""
        self._over.set()
        if self._motors is not None:
            self._thread.join(2.0)
            self._motors.link.close()
            self._way.close()
            self._motors = None

    def _armed(self) -> Motors:
        if self._motors is None:
            raise HydrostatError("the motors are not connected; call connect() first")
        if self._error:
            raise HydrostatError(self._error)
        return self._motors

    def _drive(self) -> None:
        """Tell the motors all the time; where nobody has asked for long, that they shall stand."""
        motors = self._motors
        assert motors is not None
        try:
            while not self._over.wait(1 / 60):
                with self._lock:
                    if time.monotonic() - self._asked > PATIENCE:
                        motors.ask(motors.places if motors.is_moving else motors.command)
                    motors.drive(time.monotonic())
                self._way.observe(motors.places)
        except Exception as error:  # noqa: BLE001 - of whatever kind, it is told to who asks next
            self._error = str(error) or type(error).__name__
        finally:
            motors.hold()
