"""Gravity of a robot: an acceleration along each axis of its body, or one word such as "-y"."""

import math

from hydrostat.errors import InputError

STANDARD_GRAVITY = 9.80665  # standard acceleration of free fall [m/s^2] (CGPM 1901)

DIRECTIONS = ("-x", "+x", "-y", "+y", "-z", "+z")  # words for standard gravity along an axis


def gravity_along(direction: str, dim: int) -> tuple[float, ...]:
    """Standard gravity [m/s^2] in a direction such as "-y", (dim,) (InputError: no such direction of this body)."""
    allowed = DIRECTIONS[: 2 * dim]
    if direction not in allowed:
        raise InputError(f'gravity: "{direction}" is no direction of this body; allowed are: {", ".join(allowed)}')
    down = STANDARD_GRAVITY if direction[0] == "+" else -STANDARD_GRAVITY
    return tuple(down if axis == direction[1] else 0.0 for axis in "xyz"[:dim])


def direction_of(gravity: tuple[float, ...]) -> str | None:
    """Word that `gravity_along` makes this gravity of; None if there is none."""
    dim = len(gravity)
    return next((word for word in DIRECTIONS[: 2 * dim] if gravity_along(word, dim) == gravity), None)


def check_gravity(gravity: tuple[float, ...], dim: int) -> None:
    """Refuse gravity that has not one finite component of reasonable size for each axis."""
    if len(gravity) != dim:
        raise InputError(f"gravity has {len(gravity)} entries, but the body has {dim} axes; give one for each")
    largest_gravity = 1000.0  # no component of gravity is larger [m/s^2]: about a hundred times that on earth
    for axis, component in enumerate(gravity):
        if not abs(component) <= largest_gravity or math.isnan(component):
            raise InputError(
                f"gravity[{axis}] must be from {-largest_gravity:g} to {largest_gravity:g} m/s^2, "
                f"not {component:g} m/s^2"
            )
