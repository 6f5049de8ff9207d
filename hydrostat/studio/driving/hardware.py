"""`Hardware`: motors that do what the screen shows, while somebody looks at it."""

import threading
import time
from collections.abc import Callable
from contextlib import suppress

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control import (
    CALIBRATION,
    EMULATED,
    Bus,
    BusLink,
    Calibration,
    LinkState,
    TensionGuard,
    check_port,
    not_judged,
    open_bus,
)
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import PinDrive, Robot
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.document import Document
from hydrostat.studio.view.scene_items import RobotShape

SILENT = 1.5
"""Motors hold when no page has given a sign of life for so long [s]: it was closed, hidden, or its line is gone."""

SHOWN_TOLERANCE = 2e-3  # the guard judges tensions where motors are this close to what is shown [m]

Opener = Callable[[str, Robot, Calibration, Callable[[Vector], Vector]], Bus]


class Hardware:
    """Motors behind the studio: connected and armed by a person, told by a thread of their own.

    They follow the contractions that the screen shows, as fast as their link allows. They hold on any error, when
    nobody looks at the page, when the robot is changed, and when they are told to; then they must be armed again.

    Attributes:
        allowed: True if this user may turn motors of this machine; guests may not.
        words: status of the motors for users.
        port: last port with motors; "" before.
    """

    def __init__(
        self, document: Document, bell: Bell, *, allowed: bool, opener: Opener = open_bus, silent: float = SILENT
    ) -> None:
        """No motors yet."""
        self.allowed, self.words, self.port = allowed, "", ""
        self._document, self._bell, self._opener, self._silent = document, bell, opener, silent
        self._link: BusLink | None = None
        self._robot: Robot | None = None
        self._lock, self._over = threading.RLock(), threading.Event()
        self._goal = self._places = self._pulls = np.zeros(0)
        self._follows = False  # motors follow what is shown; false again once it was said that they do not
        self._shown = False  # whether the goal is what is shown, not what there was before
        self._alive = 0.0
        self._thread: threading.Thread | None = None

    @property
    def state(self) -> LinkState | None:
        """State of the link; None without one."""
        link = self._link
        return None if link is None else link.state

    @property
    def is_armed(self) -> bool:
        """True if the motors are armed and follow commands."""
        return self.state is LinkState.ARMED

    @property
    def places(self) -> dict[str, float]:
        """Contraction of each winch, measured by its motor [m], by name; empty without motors."""
        robot, places = self._robot, self._places
        return (
            {} if robot is None or self._link is None else dict(zip(self._names(robot), places.tolist(), strict=False))
        )

    @property
    def currents(self) -> dict[str, float]:
        """Current of each motor [A], positive when reeling in, by winch name; empty without motors."""
        robot, link = self._robot, self._link
        drawn = None if link is None else link.currents
        if robot is None or drawn is None:
            return {}
        return dict(zip(self._names(robot), drawn.tolist(), strict=True))

    def connect(self, port: str) -> None:
        """Find the motors of the open robot on a port; takes a second or more, and turns none but for the proof.

        Raises:
            InputError: a guest, no robot with winches, no motors.toml, or no such kind of port.
            HydrostatError: who is silent.
        """
        if not self.allowed:
            raise InputError("guests cannot use the motors of this machine")
        check_port(port)
        self.disconnect()
        robot, folder = self._document.robot, self._document.folder
        PinDrive.require_none(robot.drives, "the motors of the studio")
        if not robot.winches:
            raise InputError("this robot has no winches. Press Design to find some")
        if port == EMULATED:
            calibration = Calibration.emulate(folder, robot)
        elif folder is None:
            raise InputError(f"save the robot first. {CALIBRATION} next to robot.toml assigns motors to winches")
        else:
            calibration = Calibration.read(folder, robot)
        with self._lock:
            self._robot, self._shown = robot, False
            self._goal = self._places = self._pulls = np.zeros(len(robot.winches))
        link = BusLink(self._opener(port, robot, calibration, self._load), robot.winches, calibration)
        try:
            facts = link.identify()
        except BaseException:
            link.close()
            raise
        names = calibration.labels
        link.guard = TensionGuard(self._expected_tensions, np.array([fact.constant for fact in facts]), names)
        with self._lock:  # another window may have connected, or the studio closed, meanwhile
            if self._over.is_set() or self._link is not None or self._robot is not robot:
                link.close()
                raise HydrostatError(f"{port}: the connection changed meanwhile. Connect again")
            self._link, self.port = link, port
        unjudged = not_judged(np.array([fact.constant for fact in facts]), names)
        if folder is not None and (folder / "correction.json").exists():
            self._say("correction.json is not used in the studio. Use hydrostat play or drive")
        missing = "" if link.state is LinkState.CALIBRATED else _CALIBRATE
        self._say(f"{port}: {len(facts)} motors answered{missing}" + (f"; {unjudged}" if unjudged else ""))

    def arm(self) -> None:
        """Let motors turn: they go to what is shown (HydrostatError: none are connected, or they cannot be armed)."""
        with self._lock:
            link = self._link
            if link is None:
                raise InputError("connect the motors first")
            link.arm()
            self._places, self._alive = link.read(time.monotonic()), time.monotonic()
            self._goal = self._goal if self._shown else self._places
            self.words = ""
        if self._thread is None or not self._thread.is_alive():
            self._thread = threading.Thread(target=self._run, name="motors of the studio", daemon=True)
            self._thread.start()
        self._ring()

    def hold(self, why: str = "") -> None:
        """Let motors stand; they must be armed again. Nothing happens where none turn.

        It waits for no other thread, not even for one that arms them just now: they are not armed then.
        """
        self._stand(why)
        self._ring()

    def disconnect(self) -> None:
        """Stop motors, and let their port go."""
        with self._lock:
            link, self._link = self._link, None
            self._robot, self.words = None, ""
        if link is not None:
            link.close()
        self._ring()

    def show(self, robot: Robot, shape: RobotShape) -> None:
        """Take a shape as what motors shall do: what its winches have taken in, and what its cables pull."""
        with self._lock:
            if self._link is None or shape.contractions is None:
                return
            if robot is not self._robot and not self._same(robot):
                self.disconnect()
                self.words = "the robot changed: motors disconnected. Connect again"
                return
            pulls = dict.fromkeys(self._names(robot), 0.0)
            for cable, tension in zip(robot.cables, shape.tensions.tolist(), strict=True):
                pulls[cable.winch] += tension
            self._goal, self._pulls = np.array(shape.contractions, dtype=float), np.array(list(pulls.values()))
            self._shown = True

    def beat(self) -> None:
        """Take a sign of life of a page that somebody looks at."""
        self._alive = time.monotonic()

    def close(self) -> None:
        """Stop motors for good."""
        self._over.set()
        self.disconnect()

    def _run(self) -> None:
        """Tell motors what is shown, and see where they are, as long as they are armed; only the studio ends it."""
        period = 0.02  # motors are told and read so often [s]
        while not self._over.wait(period):
            try:
                if not self._turn():
                    continue
            except Exception as error:  # noqa: BLE001 - whatever it is, motors stop, and this thread goes on
                self._stand("")
                self.words = f"motors stopped: {error}"
            with suppress(Exception):  # who shows it may have gone; this thread is who stops motors
                self._ring()

    def _turn(self) -> bool:
        """Tell and read motors once; False where none turn."""
        with self._lock:
            link = self._link
            if link is None or not self.is_armed:
                return self._notice_stop(link)
            now = time.monotonic()
            if now - self._alive > self._silent:
                self._stand("no active browser tab: motors holding. Re-arm to continue")
                return True
            link.send(self._goal, now, speed=link.limits.speed)
            self._places, self._follows = link.read(now), True
            return True

    def _notice_stop(self, link: BusLink | None) -> bool:
        """Take the reason why a link stopped by itself, such as for a late computer; True if it just has."""
        if link is None or not self._follows:
            return False
        self._follows, self.words = False, self.words or link.why
        return True

    def _stand(self, why: str) -> None:
        """Stop motors; state the reason if they were armed."""
        link, self._follows = self._link, False
        if link is not None:
            if link.state is LinkState.ARMED:
                self.words = why  # first, as whoever sees that motors stand reads why
            link.stop()

    def _same(self, robot: Robot) -> bool:
        """True if another state of the document has the same winches."""
        return self._robot is not None and robot.winches == self._robot.winches

    def _expected_tensions(self, contractions: Vector) -> Vector:
        """Tensions of the winches where motors are near what is shown [N]; NaN, not judged, where they are not."""
        return np.where(np.abs(contractions - self._goal) < SHOWN_TOLERANCE, self._pulls, np.nan)

    def _load(self, contractions: Vector) -> Vector:
        """Tensions that load emulated motors [N]: those of the shown pose, once the motors are there."""
        return np.where(contractions > self._goal - SHOWN_TOLERANCE, self._pulls, 0.0)

    def _say(self, words: str) -> None:
        self.words = words
        self._ring()

    def _ring(self) -> None:
        self._bell.ring(Topic.DRIVE)

    @staticmethod
    def _names(robot: Robot) -> list[str]:
        return [winch.name for winch in robot.winches]


_CALIBRATE = "; not calibrated. Run hydrostat calibrate"
"""Reason why motors cannot be armed yet."""
