"""The object of --object, with --mass and --friction."""

from typing import TYPE_CHECKING

from hydrostat.cli.option_errors import naming_fields, naming_option
from hydrostat.cli.options import positive

if TYPE_CHECKING:
    from hydrostat.robot import Obstacle


def parse_object(text: str, dim: int, *, mass: str, friction: float) -> "Obstacle":
    """Parse an object at the origin (InputError: no such object, mass or friction)."""
    from dataclasses import replace

    from hydrostat.grasp import read_object
    from hydrostat.units import MASS

    weight = positive("--mass", mass, MASS)
    with naming_option(f"--object {text}"):
        found = read_object(text, dim, mass=weight, friction=0.0)
    with naming_fields("friction"):
        return replace(found, friction=friction)
