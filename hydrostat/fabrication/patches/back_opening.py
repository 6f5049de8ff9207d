"""`back_opening`: the zipper in the back of a body in space, behind its winches."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from hydrostat.fabrication.patches.patch import Patch
from hydrostat.fabrication.patches.skin_holes import NearestOnSkin, SkinHole
from hydrostat.fabrication.patches.view import FrontView
from hydrostat.fabrication.patterns.opening import Opening, opening_at
from hydrostat.fabrication.patterns.pattern_options import PatternOptions
from hydrostat.fabrication.patterns.pinholes import Pinhole
from hydrostat.fabrication.patterns.shape import Place
from hydrostat.robot import Mount, Robot


def back_opening(
    robot: Robot,
    back: tuple[bool, ...],
    patches: tuple[Patch, ...],
    holes: tuple[SkinHole, ...],
    view: FrontView,
    options: PatternOptions,
) -> tuple[int, Opening] | None:
    """The zipper in the patch of the back that is behind the winches, and the number of that patch."""
    inside = [1e3 * np.array(winch.at) for winch in robot.winches if winch.mount is not Mount.WORLD]
    if not inside:
        return None
    at = _level(view.on_paper(np.array(inside)))
    best: tuple[float, int, list[Place]] | None = None
    for number, patch in enumerate(patches):
        if not back[number]:
            continue
        seen = Patch(disc=replace(patch.disc, vertices=_level(view.on_paper(patch.disc.vertices))), flat=patch.flat)
        behind, _, places = NearestOnSkin((seen,)).nearest(at)
        gap = float(np.linalg.norm(behind - at, axis=1).sum())
        if best is None or gap < best[0]:
            best = (gap, number, [(x, y) for x, y in places.tolist()])
    if best is None:
        return None
    number, places = best[1], best[2]
    own = [(hole, place) for hole in holes if hole.passes and (place := hole.on(number)) is not None]
    pinholes = tuple(Pinhole(place, options.pinhole / 2, ((hole.cable - 1, hole.point - 1),)) for hole, place in own)
    opening = opening_at(places, patches[number].outline, pinholes, options)
    return None if opening is None else (number, opening)


def _level(places: Float[np.ndarray, "places 2"]) -> Float[np.ndarray, "places 3"]:
    """Places of a drawing in space."""
    return np.column_stack([places, np.zeros(len(places))])
