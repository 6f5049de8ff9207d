"""What is wrong with patches, and what to mind, in words."""

import shapely

from hydrostat.fabrication.patches.cutting import MOST_EASE, MOST_GIVE
from hydrostat.fabrication.patches.distortion import distortion
from hydrostat.fabrication.patches.patch import Patch
from hydrostat.fabrication.patches.seams import Seam
from hydrostat.fabrication.patterns.skin import Skin

GIVES_LITTLE = 0.06
"""What any cloth gives: above that a pattern asks for one that stretches. Assumed, measured on none."""

NARROWEST = 8.0
"""A neck of a patch narrower than that [mm] cannot be sewn and turned. Assumed."""


def patch_problems(
    names: tuple[str, ...], patches: tuple[Patch, ...], skins: tuple[Skin, ...], seams: tuple[Seam, ...]
) -> tuple[str, ...]:
    """Why the patches cannot be sewn, a line each."""
    problems = []
    for name, patch, skin in zip(names, patches, skins, strict=True):
        give = distortion(patch).give(0.95)
        if give > MOST_GIVE:
            problems.append(
                f"patch {name} would have to stretch or shrink by {give:.1%} to lie on the body, more than "
                f"{MOST_GIVE:.0%}, which felt gives: cast this body in a mould, or simplify its shape"
            )
        if not patch.outline.is_valid:
            problems.append(f"patch {name} laps over itself when it lies flat: cast this body in a mould")
        elif isinstance(neck := patch.outline.buffer(-NARROWEST / 2), shapely.MultiPolygon) or neck.is_empty:
            problems.append(
                f"patch {name} is narrower than {NARROWEST:g} mm somewhere: it cannot be sewn and turned; cast this "
                "body in a mould, or make it larger"
            )
        problems += [f"patch {name}: {problem}" for problem in skin.problems]
    worst = max(seams, key=lambda seam: seam.mismatch)
    if worst.mismatch > MOST_EASE:
        one, other = (names[number] for number in worst.patches)
        lengths = " and ".join(f"{length:.0f} mm" for length in worst.lengths)
        problems.append(
            f"the seam between patches {one} and {other} is {lengths} long on them, {worst.mismatch:.0%} apart: more "
            f"than {MOST_EASE:.0%} cannot be eased in"
        )
    return tuple(problems)


def patch_warnings(
    names: tuple[str, ...], patches: tuple[Patch, ...], skins: tuple[Skin, ...], seams: tuple[Seam, ...]
) -> tuple[str, ...]:
    """What to mind with the cloth, a line each."""
    warnings = []
    gives = {name: distortion(patch).give(0.95) for name, patch in zip(names, patches, strict=True)}
    most = max(gives, key=lambda name: gives[name])
    if gives[most] > GIVES_LITTLE:
        warnings.append(
            f"the cloth has to give up to {gives[most]:.0%} (patch {most}, 95 % of its area): take a cloth that "
            "stretches, such as knitted plush or soft felt"
        )
    ease = max((seam.mismatch for seam in seams), default=0.0)
    if ease > 0.01:
        warnings.append(
            f"sides of seams differ by up to {ease:.1%}: pin notch to notch, ease the longer one in between"
        )
    for name, skin in zip(names, skins, strict=True):
        warnings += [f"patch {name}: {warning}" for warning in skin.warnings]
    return tuple(warnings)
