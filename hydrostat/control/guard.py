"""`TensionGuard`: does each motor draw what the model says that its cable pulls?"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector


@dataclass(frozen=True, kw_only=True)
class GuardLimits:
    """Allowed difference between measured and modeled cable tension.

    Attributes:
        times: a cable may pull so many times what the model says ...
        more: ... and so much more [N]: friction of gear and cable.
        pulls: a cable that the model pulls at by so much [N] must be felt ...
        felt: ... by at least this share of it ...
        seconds: ... within so long [s].
    """

    times: float = 1.5
    more: float = 2.0
    pulls: float = 2.0
    felt: float = 0.2
    seconds: float = 0.5


def not_judged(constants: Vector, names: Sequence[str]) -> str:
    """Return a warning that names the cables a guard cannot check; "" if none.

    Args:
        constants: torque constant of each motor [N m/A]; NaN if unknown.
        names: winch names.
    """
    blind = [name for name, constant in zip(names, constants.tolist(), strict=True) if np.isnan(constant)]
    whose = "" if len(blind) == len(names) else f" of {', '.join(blind)}"
    motors = "the motor" if len(blind) == 1 else "these motors"
    words = f"the torque per current of {motors} is unknown, so a slack, broken or held cable goes undetected"
    return f"no tension guard{whose}: {words}" if blind else ""


class TensionGuard:
    """Compare motor torque with simulated tensions: too much is a jam, too little a slack or broken cable."""

    def __init__(
        self,
        tensions: Callable[[Vector], Vector],
        constants: Vector,
        names: tuple[str, ...],
        limits: GuardLimits | None = None,
    ) -> None:
        """A guard of winches.

        Args:
            tensions: total cable tension of each winch [N] by contractions [m].
            constants: torque of each motor by its current [N m/A].
            names: winch names.
            limits: allowed differences.
        """
        self._tensions, self._constants, self._names = tensions, constants, names
        self._limits = limits or GuardLimits()
        self._missed = np.full(len(names), np.nan)  # since when a cable is not felt [s]

    def begin(self) -> None:
        """Reset the guard before motors are armed."""
        self._missed = np.full(len(self._names), np.nan)

    def fault(self, contractions: Vector, currents: Vector, radii: Vector, now: float) -> str:
        """Return the fault as text; empty for none.

        Args:
            contractions: present contractions [m].
            currents: motor currents [A]; NaN if unknown, which skips the check.
            radii: winding radii of the cables [m].
            now: time of a monotonic clock [s].
        """
        model, felt, limits = self._tensions(contractions), self._constants * currents / radii, self._limits
        ways = np.where(model < 0, -1.0, 1.0)  # reversed cables pull the other way
        model, felt = ways * model, ways * felt
        over = felt - (limits.times * np.maximum(model, 0.0) + limits.more)
        if (worst := int(np.argmax(np.nan_to_num(over, nan=-np.inf)))) is not None and over[worst] > 0:
            return (
                f"{self._names[worst]}: measured tension {felt[worst]:.1f} N, expected {model[worst]:.1f} N. The cable "
                "may be jammed; motors stopped"
            )
        missed = (model >= limits.pulls) & (felt < limits.felt * model)
        self._missed = np.where(missed, np.where(np.isnan(self._missed), now, self._missed), np.nan)
        since = now - self._missed
        for index in np.flatnonzero(np.nan_to_num(since, nan=-1.0) >= limits.seconds).tolist():
            length, turn = self._slack(contractions, index, felt[index], ways[index]), float(radii[index])
            by = "" if np.isnan(length) else f" (about {1e3 * length:.0f} mm, {np.degrees(length / turn):.0f} degrees)"
            return (
                f"{self._names[index]}: cable slack or broken, or its motor lost power "
                f"({max(felt[index], 0.0):.1f} N measured, {model[index]:.1f} N expected). Run hydrostat calibrate{by}"
            )
        return ""

    def _slack(self, contractions: Vector, index: int, felt: float, way: float) -> float:
        """Length by which a cable that pulls as is felt [N] is longer than in the model [m]; NaN if that is unknown."""
        less = np.array(contractions, dtype=float)
        for length in np.arange(5e-4, 0.04, 5e-4).tolist():
            less[index] = contractions[index] - way * length
            if way * float(self._tensions(less)[index]) <= max(felt, 0.0) + 0.05:
                return length
        return float("nan")
