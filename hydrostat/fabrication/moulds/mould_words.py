"""What is said of a mould: how it stands, what is wrong with it, what to mind."""

from hydrostat.fabrication.kit_options import MouldKind, MouldOptions
from hydrostat.fabrication.moulds.halves import Halves
from hydrostat.fabrication.moulds.openings import Sprue, Vent
from hydrostat.fabrication.moulds.pocket import Pocket, clashes
from hydrostat.fabrication.moulds.pull import Pull
from hydrostat.fabrication.moulds.stance import Stance
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Material
from hydrostat.units import counted

UNNOTICED = 0.05  # share of undercut that nobody notices: foam is pressed past it

TOLERATED = 0.3
"""Share of undercut beyond which a rigid mould is a problem. A judgement, measured on none: soft foam is squeezed to
less than half its thickness as it is drawn out, and comes back; but what grips all round tears it."""

STIFF = 1e6  # Young's modulus from which on a body is not squeezed past an undercut by hand [Pa]


def standing(stance: Stance, sprue: Sprue | None, vents: tuple[Vent, ...], kind: MouldKind) -> str:
    """Tell how the mould stands when it is poured."""
    held = ", the end that is held at the top" if stance.held_upwards else ""
    upward = sum(vent.upward for vent in vents)
    backward = len(vents) - upward
    text = f"Closed, on its edge, the parting plane upright and the funnel on top{held}."
    if sprue is not None:
        text += f" The sprue is {2 * sprue.radius:g} mm across."
    if vents and kind is MouldKind.SILICONE:
        return text + f" Punch {len(vents)} vents of 3 mm through the silicone at the high points."
    if upward:
        text += f" {upward} {_vents(upward)} open at the top."
    if backward:
        text += f" {backward} {_vents(backward)} open at the back of a half: close them with tape when foam comes out."
    return text


def _vents(count: int) -> str:
    return "vent is" if count == 1 else "vents are"


def mould_problems(
    pull: Pull,
    material: Material,
    sprue: Sprue | None,
    pockets: tuple[Pocket, ...],
    printed: tuple[Printed, ...],
    options: MouldOptions,
    halves: Halves,
    *,
    links: tuple[int, int] = (0, 0),
) -> tuple[str, ...]:
    """Tell why the mould cannot be built well; `links` counts holes of the body that the lower and upper half close."""
    found = [pocket.problem for pocket in pockets if pocket.problem] + clashes(pockets)
    rigid = options.kind is MouldKind.PRINTED
    if rigid and any(links):
        found.append(
            f"{_reaches(links)} and closes behind it like a link of a chain: it cannot come off; close "
            f"{'that hole' if sum(links) == 1 else 'these holes'} in the surface and cut the foam out afterwards, or "
            "choose a mould of silicone, which is cut open there"
        )
    if rigid and (pull.share > TOLERATED or (pull.share > UNNOTICED and material.young > STIFF)):
        found.append(
            f"{100 * pull.share:.0f} % of the surface is undercut along the best of {len(pull.shares)} pulls: the body "
            "would tear as a rigid mould comes off; choose a mould of silicone, which gives way"
        )
    if sprue is None:
        found.append("the parting plane does not cross the body, so that nothing can be poured; simplify its surface")
    if rigid:
        found += [
            f"the {half} half of the mould falls into {len(parts)} pieces: the body reaches through its walls"
            for half, parts in (("upper", halves.upper.decompose()), ("lower", halves.lower.decompose()))
            if sum(part.volume() > 0 for part in parts) > 1
        ]
    for piece in printed:
        if any(side > most + 1e-6 for side, most in zip(_sorted(piece.size), _sorted(options.bed), strict=True)):
            size = " x ".join(f"{side:.0f}" for side in piece.size)
            found.append(f"{piece.title}: {size} mm is more than the printer takes; use a larger printer")
    return tuple(found)


def _sorted(size: tuple[float, float, float]) -> list[float]:
    """Sort sides in the plane, the longer first: a piece may be turned on the bed, not tilted."""
    return [*sorted(size[:2], reverse=True), size[2]]


def _reaches(links: tuple[int, int]) -> str:
    """Which half reaches through how many holes."""
    parts = [
        f"the {half} half of the mould reaches through {counted(count, 'hole')} of the body"
        for half, count in zip(("lower", "upper"), links, strict=True)
        if count
    ]
    return " and ".join(parts)


def mould_warnings(
    pull: Pull, material: Material, kind: MouldKind, *, links: tuple[int, int] = (0, 0)
) -> tuple[str, ...]:
    """Tell what a person should mind; `links` as in `mould_problems`."""
    found = []
    if kind is MouldKind.SILICONE and any(links):
        found.append(
            f"{_reaches(links)} and closes behind it: silicone gives way, but a closed loop cannot be drawn out; "
            "cut the silicone open there with a knife, and tape the cut from outside before you pour"
        )
    if pull.share <= (UNNOTICED if kind is MouldKind.PRINTED else TOLERATED):
        return tuple(found)
    return (
        *found,
        f"{100 * pull.share:.0f} % of the surface is undercut: {material.name or 'the body'} is squeezed past it; use "
        "plenty of release agent, open the mould slowly and draw the body out part by part",
    )
