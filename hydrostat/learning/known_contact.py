"""Contact as files of samples and models tell it: whether a body feels itself, from how far, with what friction."""

from collections.abc import Mapping
from math import isclose
from typing import Any

from hydrostat.errors import InputError
from hydrostat.robot import DISTANCE, Robot

ContactFacts = dict[str, bool | float | None]
"""contact, contact_distance [m] and contact_friction; None where there is no contact."""


def contact_facts(robot: Robot) -> ContactFacts:
    """What a file tells of the contact of a robot."""
    if robot.contact is None:
        return _facts(None)
    return _facts((robot.contact_distance, robot.contact.friction))


def contact_in_model(facts: Mapping[str, Any]) -> ContactFacts:
    """The same as a file tells it; one that does not, being earlier, was made with the usual distance, no friction."""
    if not facts["contact"]:
        return _facts(None)
    distance, friction = facts.get("contact_distance"), facts.get("contact_friction")
    usual = DISTANCE * facts["size"] if distance is None else distance
    return _facts((usual, 0.0 if friction is None else friction))


def check_contact(told: ContactFacts, robot: Robot) -> None:
    """Check that a model knows the contact of a robot (InputError: it knows another, or only one of them has any)."""
    mine = contact_facts(robot)
    if told["contact"] != mine["contact"]:
        have, lack = ("the model", "the robot") if told["contact"] else ("the robot", "the model")
        raise InputError(f"{have} knows contact and {lack} does not: give both or none [contact]")
    if told["contact"] and not all(isclose(told[name] or 0.0, mine[name] or 0.0, rel_tol=_SAME) for name in _NUMBERS):
        raise InputError(
            f"the model knows {_words(told)}, the robot has {_words(mine)}: give [contact] the same, or sample and "
            f"learn again"
        )


def _facts(numbers: tuple[float, float] | None) -> ContactFacts:
    return {"contact": numbers is not None, **dict(zip(_NUMBERS, numbers or (None, None), strict=True))}


def _words(facts: ContactFacts) -> str:
    distance, friction = (facts[name] or 0.0 for name in _NUMBERS)
    return f"contact from {1e3 * distance:.4g} mm with friction {friction:g}"


_NUMBERS = ("contact_distance", "contact_friction")
_SAME = 1e-6
"""A relative difference below this is rounding, as between meshes of two machines."""
