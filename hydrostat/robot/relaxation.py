"""`Relaxation`: one branch of a material's fading memory."""

from dataclasses import dataclass

from hydrostat.robot.checks import check_positive

MOST_BRANCHES = 10
"""A material has at most this many branches."""


@dataclass(frozen=True, kw_only=True)
class Relaxation:
    """A Maxwell branch, one term of a Prony series: a spring behind a dashpot, beside the elastic material.

    After a sudden shear the branch carries modulus * exp(-t / time) of its stress, so the material begins stiffer by
    `modulus` and settles to the elastic material alone.

    Attributes:
        modulus: shear modulus of the branch [Pa].
        time: after which its stress has fallen to 1/e [s].

    Raises:
        InputError: a number that is not finite and above 0.
    """

    modulus: float
    time: float

    def __post_init__(self) -> None:
        check_positive("modulus", self.modulus, "Pa")
        check_positive("time", self.time, "s")
