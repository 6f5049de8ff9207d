"""`KnownContact`: the self-contact of a body, as files of samples and models record it."""

from collections.abc import Mapping
from math import isclose
from typing import Any, NamedTuple

from hydrostat.errors import InputError
from hydrostat.robot import DISTANCE, Robot


class KnownContact(NamedTuple):
    """Self-contact of a body. Files hold each value under the name of its field.

    Attributes:
        contact: self-contact is on.
        contact_distance: distance at which it begins [m]; None without contact.
        contact_friction: its Coulomb coefficient; None without contact.
    """

    contact: bool
    contact_distance: float | None = None
    contact_friction: float | None = None


def contact_facts(robot: Robot) -> KnownContact:
    """Return the contact of a robot."""
    if robot.contact is None:
        return KnownContact(contact=False)
    return KnownContact(True, robot.contact_distance, robot.contact.friction)


def contact_in_model(facts: Mapping[str, Any]) -> KnownContact:
    """Return the contact in the facts of a file.

    Files of earlier versions lack the numbers: they were made with the usual distance, and without friction.
    """
    if not facts["contact"]:
        return KnownContact(contact=False)
    distance, friction = facts.get("contact_distance"), facts.get("contact_friction")
    usual = DISTANCE * facts["size"] if distance is None else distance
    return KnownContact(True, usual, 0.0 if friction is None else friction)


def check_contact(known: KnownContact, robot: Robot) -> None:
    """Check that a model was trained with a robot's contact (InputError: other contact, or one of them has none)."""
    mine = contact_facts(robot)
    if known.contact != mine.contact:
        have, lack = ("the model", "the robot") if known.contact else ("the robot", "the model")
        raise InputError(f"{have} knows contact and {lack} does not: give both or none [contact]")
    same = 1e-6  # A relative difference below this is rounding, as between meshes of two machines
    if known.contact and not all(
        isclose(*pair, rel_tol=same) for pair in zip(_numbers(known), _numbers(mine), strict=True)
    ):
        raise InputError(
            f"the model knows {_words(known)}, the robot has {_words(mine)}: give [contact] the same, or sample and "
            f"learn again"
        )


def _numbers(known: KnownContact) -> tuple[float, float]:
    """Return distance [m] and friction, 0 where there is none."""
    return known.contact_distance or 0.0, known.contact_friction or 0.0


def _words(known: KnownContact) -> str:
    distance, friction = _numbers(known)
    return f"contact from {1e3 * distance:.4g} mm with friction {friction:g}"
