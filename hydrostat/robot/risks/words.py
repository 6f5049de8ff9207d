"""Words for risks: lengths and places in millimeters, several parts with the same risk in one line."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float
from hydrostat.robot.material import Material
from hydrostat.units import list_words


@dataclass(frozen=True)
class Risk:
    """One part with a risk."""

    part: str  # name of the part, such as "cable[0]"
    severity: float  # larger is worse
    text: str  # description of the risk


def merge_risks(found: Iterable[Risk]) -> Iterator[str]:
    """One line for all parts with the same risk, in the words of the worst; none if there is none."""
    found = list(found)
    if not found:
        return
    parts = list(dict.fromkeys(risk.part for risk in found))
    worst = max(found, key=lambda risk: risk.severity)
    if len(parts) == 1:
        yield f"{worst.part}: {worst.text}"
    elif len(parts) <= 3:
        yield f"{list_words(parts)}: {worst.text} ({worst.part} is the worst)"
    else:
        yield f"{', '.join(parts[:2])} and {len(parts) - 2} more: {worst.text} ({worst.part} is the worst)"


def mm(length: float) -> str:
    """Length [m] in millimeters, to three digits, micrometers at best."""
    return f"{round(1e3 * length, 3):.3g} mm"


def place(point: Float[np.ndarray, " dim"]) -> str:
    """Place [m] in millimeters."""
    return "[" + ", ".join(f"{round(1e3 * value):d}" for value in point) + "] mm"


def known_up_to(material: Material, limit: str) -> str:
    """Limit up to which the numbers of a material are believed."""
    return f"{material.name or 'the material'} is known up to {limit} (an estimate from lengths alone)"
