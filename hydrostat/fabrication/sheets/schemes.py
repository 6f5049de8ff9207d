"""Schemes: how a cable is stitched through cloth, and how its stopper is set."""

from hydrostat.fabrication.patterns.stitches import CableStitches, Side
from hydrostat.fabrication.sheets.canvas import MIDDLE, THICK, THIN, Canvas, Spot

_CLOTH = 1.5
"""Thickness of drawn cloth [mm]."""

_MOST = 7
"""Holes that are drawn; of a longer cable the last are left out but for the stopper's."""


def stitch_scheme(sewn: CableStitches, letter: str, *, width: float, height: float) -> Canvas:
    """A cut through the stuffed body along a cable: which way it goes at each hole.

    Args:
        sewn: how the cable is sewn.
        letter: of its winch.
        width: of the picture [mm].
        height: of the picture [mm].
    """
    canvas = Canvas(width, height)
    front, back = 0.36 * height, height - 4.5
    stitches = [stitch for stitch in sewn.stitches if stitch.passes or stitch is sewn.stitches[-1]]
    chosen = [*stitches] if len(stitches) <= _MOST else [*stitches[: _MOST - 2], stitches[-1]]
    skipped = len(chosen) < len(stitches)
    left, right = 13.0, width - 9.0
    step = (right - left) / max(len(chosen) - 1, 1)
    across = [left + step * place for place in range(len(chosen))]
    holes = [x for x, stitch in zip(across, chosen, strict=True) if stitch.passes]
    _put_cloth(canvas, front, holes, width)
    _put_cloth(canvas, back, [], width)
    winch: Spot = (4.0, (front + back) / 2 + 0.5)
    level = {Side.OUTSIDE: front - 2.2, Side.INSIDE: front + _CLOTH + 2.2}
    way: list[Spot] = [winch, (left - 3.5, level[sewn.begins])]
    for place, (x, stitch) in enumerate(zip(across, chosen, strict=True)):
        after = level[stitch.after]
        before = level[stitch.after.other] if stitch.passes else after
        way += [(x - 0.9, before), (x + 0.9, after)] if stitch.passes else [(x, after)]
        if skipped and place == len(chosen) - 2:
            canvas.line([[*way, (x + 0.3 * step, after)]], width=THICK)
            way = [(x + 0.62 * step, level[chosen[-1].after.other] if chosen[-1].passes else level[chosen[-1].after])]
            canvas.text((x + step / 2, front - 10.4), "…", size=8.5, bold=True)
    end = way[-1]
    canvas.line([way], width=THICK)
    canvas.fill([[(end[0] - 0.2, end[1] - 1.5), (end[0] + 1.6, end[1] - 1.5), (end[0] + 1.6, end[1] + 1.5),
                  (end[0] - 0.2, end[1] + 1.5)]], grey=0.0)  # fmt: skip
    for x, stitch in zip(across, chosen, strict=True):
        words = "stopper" if stitch is stitches[-1] else str(stitch.number)
        canvas.text((x, front - 7.0), words, size=8.5, bold=True)
        if stitch.passes:
            canvas.text((x, front - 10.2), "out" if stitch.after is Side.OUTSIDE else "in", size=8.5)
    canvas.balloon(winch, letter, dark=True)
    canvas.text((0.5, front - 2.4), "outside", size=8, anchor="start", grey=0.25)
    middle = (front + _CLOTH + back) / 2 + 2.0
    canvas.text((width / 2, middle), "inside, stuffed", size=8, grey=0.25)
    canvas.text((width - 0.5, back - 2.2), "back panel with zipper", size=8, anchor="end", grey=0.25)
    return canvas


def skin_scheme(*, width: float, height: float) -> Canvas:
    """A cut through foam, skin and a cable that is sewn on: first in its tube, then bare, up to its stopper."""
    canvas = Canvas(width, height)
    top, tube_end, stopper = 0.45 * height, 0.42 * width, width - 10.0
    canvas.fill([[(0, top + 1.4), (width, top + 1.4), (width, height - 1), (0, height - 1)]], grey=0.9)
    _put_cloth(canvas, top, [], width)
    line = top - 1.9
    canvas.line([[(0, line), (tube_end, line)]], width=2.2)
    canvas.line([[(0, line), (tube_end, line)]], width=1.6, grey=1.0)
    canvas.line([[(0, line), (stopper, line)]], width=THICK)
    canvas.fill([[(stopper, line - 1.6), (stopper + 1.8, line - 1.6), (stopper + 1.8, line + 1.6),
                  (stopper, line + 1.6)]], grey=0.0)  # fmt: skip
    loops = [*(tube_end - at for at in (2.0, 4.0, 22.0, 24.0)), *(tube_end + 9.0 + 9.0 * k for k in range(4))]
    for x in loops:
        canvas.line([[(x - 0.5, top + _CLOTH + 0.7), (x - 0.5, line - 1.5), (x + 0.5, line - 1.5),
                      (x + 0.5, top + _CLOTH + 0.7)]], width=THIN)  # fmt: skip
    canvas.text((tube_end / 2, line - 4.4), "tube, sewn on at both ends", size=8)
    canvas.text(((tube_end + stopper) / 2 + 2, line - 4.4), "a stitch at every number", size=8)
    canvas.text((stopper + 0.9, line - 4.4), "stopper", size=8)
    canvas.text((1.0, top + _CLOTH + 2.6), "knitted skin", size=8, anchor="start")
    canvas.text((width / 2, height - 3.6), "foam", size=8)
    return canvas


def _put_cloth(canvas: Canvas, top: float, holes: list[float], width: float) -> None:
    """A strip of cloth from the left to the right, cut by holes."""
    walls = [0.0, *(side for hole in holes for side in (hole - 1.0, hole + 1.0)), width]
    for start, end in zip(walls[::2], walls[1::2], strict=True):
        box = [(start, top), (end, top), (end, top + _CLOTH), (start, top + _CLOTH)]
        canvas.fill([box], grey=0.72)
        canvas.line([box[:2], box[2:]], width=THIN)


def stopper_scheme(*, outside: bool, width: float, height: float) -> Canvas:
    """A cable pulled straight, from its winch at zero to its stopper: what is measured, and what is left loose.

    Args:
        outside: whether the motors stand outside, on a base.
        width: of the picture [mm].
        height: of the picture [mm].
    """
    canvas = Canvas(width, height)
    line, exit_at, body_end, stopper = 0.55 * height, 16.0, width - 22.0, width - 13.0
    canvas.fill([[(exit_at, line - 5), (body_end, line - 5), (body_end, line + 5), (exit_at, line + 5)]], grey=0.93)
    canvas.line([[(exit_at, line - 5), (body_end, line - 5), (body_end, line + 5), (exit_at, line + 5)]], width=THIN,
                closed=True)  # fmt: skip
    canvas.text(((exit_at + body_end) / 2, line + 2.6), "body", size=8, grey=0.25)
    canvas.line([[(7.0, line), (stopper, line)]], width=THICK)
    canvas.line([[(stopper + 1.8, line), (width - 1.0, line)]], width=MIDDLE, dash=(1.2, 0.8))
    canvas.disc((7.0, line), 4.2, grey=1.0, edge=MIDDLE)
    canvas.disc((7.0, line), 1.0, grey=0.0)
    canvas.line([[(11.4, line - 3), (exit_at, line - 3)], [(11.4, line + 3), (exit_at, line + 3)]], width=THIN)
    canvas.fill([[(stopper, line - 2), (stopper + 1.8, line - 2), (stopper + 1.8, line + 2), (stopper, line + 2)]],
                grey=0.0)  # fmt: skip
    _dimension(canvas, exit_at, stopper, line - 8.0, line - 1.0, "stopper")
    _dimension(canvas, body_end, stopper, line + 8.0, line + 1.0, "slack")
    canvas.text((0.3, line + 7.4), "base, at zero" if outside else "winch at zero", size=8, anchor="start")
    return canvas


def _dimension(canvas: Canvas, left: float, right: float, at: float, foot: float, words: str) -> None:
    """An arrow between two places with what it measures."""
    canvas.line([[(x, foot), (x, at + (0.8 if foot < at else -0.8))] for x in (left, right)], width=THIN)
    middle = (left + right) / 2
    canvas.arrow((middle, at), (left, at), width=THIN, head=1.4)
    canvas.arrow((middle, at), (right, at), width=THIN, head=1.4)
    beside = at + (2.4 if foot < at else -2.2)
    canvas.text((middle, beside), words, size=8, halo=False)
