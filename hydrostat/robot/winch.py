"""`Winch`: an actuator, a motor with a spool that takes in cable (tendon)."""

# Of the thesis (docs/thesis.md): R12, R27

from dataclasses import dataclass
from enum import StrEnum

from hydrostat.closed_set import make_member
from hydrostat.errors import InputError
from hydrostat.given import Point, check_not_negative, check_point, check_positive, check_type
from hydrostat.painters import check_motor


class Mount(StrEnum):
    """Mounting of a winch: in the body, or fixed in the world."""

    BODY = "body"
    WORLD = "world"


@dataclass(frozen=True, kw_only=True)
class Winch:
    """Winch whose cables share its contraction, on its spool or on their own steps of the shaft.

    Attributes:
        name: name, unique in the robot.
        at: position in the rest pose [m].
        spool_radius: spool radius at which contraction, travel and release are measured [m].
        travel: maximum contraction [m].
        release: maximum cable length paid out beyond the rest length [m].
        body: True if motor and housing form a rigid part of the body, see `fit_winch_bodies`.
        mount: `Mount.WORLD` (or its text) fixes `at` in space, where its cables begin.

    Raises:
        InputError: an empty name, a value out of range, or an unknown mount.
    """

    name: str
    at: Point
    spool_radius: float = 0.006
    travel: float = 0.06
    release: float = 0.0
    mount: Mount = Mount.BODY
    body: bool = False

    def __post_init__(self) -> None:
        check_type(self.name, str, "name must be a text")
        if not self.name:
            raise InputError("name must not be empty")
        check_point("at", self.at)
        check_positive("spool_radius", self.spool_radius, "m")
        check_positive("travel", self.travel, "m")
        check_not_negative("release", self.release, "m")
        most = 20.0  # No winch takes in more [m]
        for field, value in (("travel", self.travel), ("release", self.release), ("spool_radius", self.spool_radius)):
            if value > most:
                raise InputError(f"{field} must be at most {most:g} m, not {value:g}; in meters: 60 mm is 0.06")
        make_member(self, "mount", Mount)
        if self.body and self.mount is Mount.WORLD:
            raise InputError('body = true is for a winch in the body. Remove it, or mount = "world"')


def check_drive_limits(motor: str, tension: float | None, torque: float | None) -> None:
    """Reject a motor and limits of all winches that cannot be (InputError)."""
    check_type(motor, str, 'motor must be a key, such as "sts3215"')
    if motor != "auto":
        check_motor(motor)
    for name, limit, unit in (("max_tension", tension, "N"), ("max_torque", torque, "N m")):
        if limit is not None:
            check_positive(name, limit, unit)
