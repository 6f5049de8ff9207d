"""`HydrostatTeleop`: keys, knobs, gamepads, OSC and gloves of hydrostat as a teleoperator of LeRobot."""

import time
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from lerobot.teleoperators import Teleoperator, TeleoperatorConfig

from hydrostat.errors import HydrostatError
from hydrostat.robot import load_robot
from hydrostat.teleop import DriveSource, EmulatedHand, HandMap, WinchMapper, open_source


@TeleoperatorConfig.register_subclass("hydrostat")
@dataclass(kw_only=True)
class HydrostatTeleopConfig(TeleoperatorConfig):
    """What drives which robot.

    Attributes:
        robot: its folder, or gallery:NAME.
        source: as for `hydrostat drive --source`.
        hand_map: what `hydrostat mimic` has learned, for gloves and cameras.
    """

    robot: str
    source: str = "osc:9000"
    hand_map: str = ""


class HydrostatTeleop(Teleoperator):
    """What a person asks for, as actions of `HydrostatRobot`; who is not heard asks for what was asked last."""

    config_class = HydrostatTeleopConfig
    name = "hydrostat"

    def __init__(self, config: HydrostatTeleopConfig) -> None:
        """The source of a config (InputError: no such robot)."""
        super().__init__(config)
        self.config, self._channels = config, WinchMapper.channels(load_robot(config.robot))
        self._source: DriveSource | None = None
        self._values = self._channels.rest.copy()

    @cached_property
    def action_features(self) -> dict[str, type]:
        """What each winch shall take in [mm]."""
        return {f"{name.replace(' ', '_')}.pos": float for name in self._channels.names}

    @property
    def feedback_features(self) -> dict[str, type]:
        """None."""
        return {}

    @property
    def is_connected(self) -> bool:
        """Whether the source is open."""
        return self._source is not None

    @property
    def is_calibrated(self) -> bool:
        """Always: what a hand means is in its map."""
        return True

    def connect(self, calibrate: bool = True) -> None:
        """Open the source (HydrostatError: it is not there; InputError: no such kind)."""
        del calibrate
        known = HandMap.open(Path(self.config.hand_map)) if self.config.hand_map else None
        self._source = open_source(self.config.source, self._channels, known, EmulatedHand(self._channels))

    def calibrate(self) -> None:
        """Say how."""
        raise HydrostatError("learn a hand by: hydrostat mimic ROBOT --glove PORT --out DIR")

    def configure(self) -> None:
        """Nothing is set."""

    def get_action(self) -> dict[str, Any]:
        """What is asked for now [mm] (HydrostatError: the source is gone, or the person has ended)."""
        if self._source is None:
            raise HydrostatError("the source is not connected; call connect() first")
        wish, names = self._source.read(), self._channels.names
        if wish.over:
            raise HydrostatError("the person has ended")
        if not wish.hold and time.monotonic() - wish.stamp <= self._source.silence:
            for index, name in enumerate(names):
                self._values[index] = wish.places.get(name, self._values[index]) + wish.steps.get(name, 0.0)
            self._values = np.clip(self._values, self._channels.low, self._channels.high)
        return {key: 1e3 * float(value) for key, value in zip(self.action_features, self._values, strict=True)}

    def send_feedback(self, feedback: dict[str, Any]) -> None:
        """Nothing is felt."""
        del feedback

    def disconnect(self) -> None:
        """Let the source go."""
        if self._source is not None:
            self._source.close()
            self._source = None
