"""Diagrams: how a cable is stitched, put in and stopped, and how supply, board and motors are wired."""

import math

from hydrostat.drawing import Canvas, Spot
from hydrostat.fabrication.board_kind import BOARDS
from hydrostat.fabrication.lists.motors import PowerPlan
from hydrostat.fabrication.patterns.stitches import CableStitches, Side
from hydrostat.units import list_words

_CLOTH = 1.5  # thickness of drawn cloth [mm]


def stitch_scheme(sewn: CableStitches, mark: str, *, width: float, height: float) -> Canvas:
    """A cut through the stuffed body along a cable: which way it goes at each hole; `mark` is that of its winch."""
    canvas = Canvas(width, height)
    front, back = 0.36 * height, height - 4.5
    stitches = [stitch for stitch in sewn.stitches if stitch.passes or stitch is sewn.stitches[-1]]
    max_holes = 7  # holes that are drawn; of a longer cable the last are left out but for the stopper's
    chosen = [*stitches] if len(stitches) <= max_holes else [*stitches[: max_holes - 2], stitches[-1]]
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
            canvas.line([[*way, (x + 0.3 * step, after)]], width=Canvas.THICK)
            way = [(x + 0.62 * step, level[chosen[-1].after.other] if chosen[-1].passes else level[chosen[-1].after])]
            canvas.text((x + step / 2, front - 10.4), "…", size=8.5, bold=True)
    end = way[-1]
    canvas.line([way], width=Canvas.THICK)
    canvas.box((end[0] - 0.2, end[1] - 1.5, end[0] + 1.6, end[1] + 1.5), grey=0.0)
    for x, stitch in zip(across, chosen, strict=True):
        words = "stopper" if stitch is stitches[-1] else str(stitch.number)
        canvas.text((x, front - 7.0), words, size=8.5, bold=True)
        if stitch.passes:
            canvas.text((x, front - 10.2), "out" if stitch.after is Side.OUTSIDE else "in", size=8.5)
    canvas.balloon(winch, mark, dark=True)
    canvas.text((0.5, front - 2.4), "outside", size=8, anchor="start", grey=0.25)
    middle = (front + _CLOTH + back) / 2 + 2.0
    canvas.text((width / 2, middle), "inside, stuffed", size=8, grey=0.25)
    canvas.text((width - 0.5, back - 2.2), "back panel with zipper", size=8, anchor="end", grey=0.25)
    return canvas


def skin_scheme(*, sewn: bool, drawn: bool, tubes: bool, width: float, body: str = "foam") -> Canvas:
    """A cut through body and skin: cables sewn to the skin, cables drawn through the body, with or without tubes."""
    top = 9.5 if sewn else 7.0
    canvas = Canvas(width, top + (20.0 if drawn else 9.0))
    canvas.box((0, top, width - 12, canvas.height - 1), grey=0.9)
    _put_cloth(canvas, top, [], width - 12.0)
    if sewn:
        _put_sewn(canvas, top, tubes=tubes, width=width - 12.0)
    if drawn:
        _put_drawn(canvas, top, tubes=tubes, width=width - 12.0, body=body)
    canvas.text((width - 11.0, top + 0.8), "skin", size=8, anchor="start")
    canvas.text((width - 11.0, canvas.height - 3.0), body, size=8, anchor="start")
    return canvas


def _put_sewn(canvas: Canvas, top: float, *, tubes: bool, width: float) -> None:
    """A line over the skin, first in its tube, then bare, up to its stopper."""
    line, tube_end, stopper = top - 1.9, 0.4 * width if tubes else 0.0, width - 8.0
    _put_tube(canvas, [(0, line), (tube_end, line)])
    canvas.line([[(0, line), (stopper, line)]], width=Canvas.THICK)
    canvas.box((stopper, line - 1.6, stopper + 1.8, line + 1.6), grey=0.0)
    ends = [tube_end - at for at in (2.0, 4.0, 22.0, 24.0)] if tubes else []
    for x in (*ends, *(tube_end + 9.0 + 9.0 * k for k in range(int((stopper - tube_end - 10) / 9) + 1))):
        canvas.line([[(x - 0.5, top + _CLOTH + 0.7), (x - 0.5, line - 1.5), (x + 0.5, line - 1.5),
                      (x + 0.5, top + _CLOTH + 0.7)]], width=Canvas.THIN)  # fmt: skip
    if tubes:
        canvas.text((tube_end / 2, line - 4.4), "tube", size=8)
    canvas.text((stopper, line - 4.4), "on the skin: a stitch at every number", size=8, anchor="end")


def _put_drawn(canvas: Canvas, top: float, *, tubes: bool, width: float, body: str) -> None:
    """A line within the body, first in its tube, then bare from pin to pin, out through the skin to its stopper."""
    deep, out = top + 11.0, width - 10.0
    tube_end = 0.33 * width if tubes else 0.0
    bends: list[Spot] = [(0.46 * width, deep - 1.5), (0.62 * width, deep), (0.77 * width, deep - 2.5)]
    _put_tube(canvas, [(0, deep), (tube_end, deep)])
    end: Spot = (out, top - 1.6)
    canvas.line([[(0, deep), (tube_end, deep), *bends, (out, top + _CLOTH), end]], width=Canvas.THICK)
    canvas.box((out - 1.6, top - 2.2, out + 1.6, top - 0.4), grey=0.0)
    for x, y in bends:
        canvas.line([[(x, top - 3.0), (x, y)]], width=Canvas.THIN, dash=(0.8, 0.6))
        canvas.disc((x, top - 3.0), 0.6, grey=0.0)
        canvas.disc((x, y), 0.7)
    canvas.text((bends[1][0] + 1.0, top + 4.4), "depth", size=8, anchor="start")
    canvas.text((bends[0][0] - 1.6, top + 4.4), "pin", size=8, anchor="end")
    if tubes:
        canvas.text((tube_end / 2, deep + 3.4), "tube", size=8)
    canvas.text(((tube_end + out) / 2, deep + 4.2), f"through the {body}, from point to point", size=8)
    canvas.text((out, top - 4.6), "stopper", size=8)


def _put_tube(canvas: Canvas, way: list[Spot]) -> None:
    """Two walls; nothing where it has no length."""
    if way[0][0] < way[-1][0]:
        canvas.line([way], width=2.2)
        canvas.line([way], width=1.6, grey=1.0)


def _put_cloth(canvas: Canvas, top: float, holes: list[float], width: float) -> None:
    """A strip of cloth from the left to the right, cut by holes."""
    walls = [0.0, *(side for hole in holes for side in (hole - 1.0, hole + 1.0)), width]
    for start, end in zip(walls[::2], walls[1::2], strict=True):
        canvas.box((start, top, end, top + _CLOTH), grey=0.72)
        canvas.line([[(start, top), (end, top)], [(end, top + _CLOTH), (start, top + _CLOTH)]], width=Canvas.THIN)


def stopper_scheme(*, cloth: str, width: float, height: float) -> Canvas:
    """A cable pulled straight, its winch at zero: the stopper touches the cloth, and goes back by the slack."""
    canvas = Canvas(width, height)
    line, exit_at, body_end, stopper = 0.48 * height, 16.0, width - 27.0, width - 15.0
    canvas.box((exit_at, line - 5, body_end, line + 5), grey=0.93)
    canvas.box((body_end - _CLOTH, line - 7, body_end, line + 7), grey=0.72)
    canvas.line([[(x, line - 7), (x, line + 7)] for x in (body_end - _CLOTH, body_end)], width=Canvas.THIN)
    canvas.text(((exit_at + body_end) / 2, line + 2.6), "straight, not tight", size=8, grey=0.25)
    canvas.line([[(7.0, line - 4.2), (12.0, line), (stopper, line)]], width=Canvas.THICK)
    canvas.line([[(stopper + 1.8, line), (width - 1.0, line)]], width=Canvas.MIDDLE, dash=(1.2, 0.8))
    canvas.disc((7.0, line), 4.2, grey=1.0, edge=Canvas.MIDDLE)
    canvas.disc((7.0, line), 1.0, grey=0.0)
    canvas.line([[(9.3, line - 6.0), (9.3, line - 2.4)]], width=Canvas.MIDDLE)
    canvas.text((11.0, line - 7.6), "spool mark", size=8, anchor="start")
    for left, dash in ((body_end, (0.8, 0.6)), (stopper, None)):
        box: list[Spot] = [(left, line - 2), (left + 1.8, line - 2), (left + 1.8, line + 2), (left, line + 2)]
        if dash:
            canvas.line([box], width=Canvas.THIN, dash=dash, closed=True)
        else:
            canvas.fill([box], grey=0.0)
    canvas.text((body_end + 2.0, line - 6.2), "1 touches", size=8, anchor="start")
    canvas.text((stopper + 1.2, line - 3.8), "2", size=8)
    _dimension(canvas, body_end, stopper, line + 8.0, line + 2.4, "slack")
    canvas.text((0.3, line + 8.2), "winch at zero", size=8, anchor="start")
    canvas.text((body_end - 2.4, line + 9.0), f"{cloth}, last point", size=8, anchor="end")
    return canvas


def _dimension(canvas: Canvas, left: float, right: float, at: float, foot: float, words: str) -> None:
    """An arrow between two places with what it measures."""
    canvas.line([[(x, foot), (x, at + (0.8 if foot < at else -0.8))] for x in (left, right)], width=Canvas.THIN)
    middle = (left + right) / 2
    canvas.arrow((middle, at), (left, at), width=Canvas.THIN, head=1.4)
    canvas.arrow((middle, at), (right, at), width=Canvas.THIN, head=1.4)
    beside = at + (2.4 if foot < at else -2.2)
    canvas.text((middle, beside), words, size=8, halo=False)


def wiring_scheme(plan: PowerPlan, marks: tuple[str, ...], *, width: float) -> Canvas:
    """Supply, fuse, switch, board and motors [mm of paper]; `marks` are those of the winches, as on the map."""
    canvas = Canvas(width, 74.0)
    max_motors = 6  # largest number of motors drawn; a sentence states the rest
    shown = marks[:max_motors]
    _put_power(canvas, plan)
    left, right, top = 50.0, width, 46.0
    step = (right - left) / len(shown)
    places = [left + step * (place + 0.5) for place in range(len(shown))]
    (_put_chain if plan.servos else _put_drivers)(canvas, plan, places, step, top)
    for place, mark in zip(places, shown, strict=True):
        canvas.balloon((place, top + 21.5), mark, dark=True)
    if len(marks) > max_motors:
        canvas.text((right, top + 26.5), f"and so on to {marks[-1]}", size=8, anchor="end", grey=0.25)
    return canvas


_RAIL, _GROUND = 14.0, 19.0  # heights of plus and minus [mm]


def _put_power(canvas: Canvas, plan: PowerPlan) -> None:
    """The supply at the left, its fuse and switch, and both rails."""
    _box(canvas, (0.4, 10.0, 26.0, 23.0), f"supply {plan.motor.volts:g} V", f"{plan.supply:g} A")
    end = canvas.width - 1.0
    canvas.line([[(26.0, _RAIL), (31.0, _RAIL)], [(39.0, _RAIL), (44.0, _RAIL)]], width=Canvas.THICK)
    canvas.line([[(26.0, _GROUND), (end, _GROUND)], [(53.0, _RAIL), (end, _RAIL)]], width=Canvas.THICK)
    canvas.line([[(31.0, 12.4), (39.0, 12.4), (39.0, 15.6), (31.0, 15.6)]], width=Canvas.MIDDLE, closed=True)
    canvas.line([[(31.0, _RAIL), (39.0, _RAIL)]], width=Canvas.THIN)
    canvas.text((35.0, 8.0), f"fuse {plan.fuse:g} A", size=8)
    canvas.line([[(44.0, _RAIL), (52.0, 10.6)]], width=Canvas.THICK)
    canvas.disc((44.0, _RAIL), 0.7, grey=0.0)
    canvas.disc((53.0, _RAIL), 0.7, grey=0.0)
    canvas.text((43.5, 8.0), "switch, in reach", size=8, anchor="start")
    canvas.text((end, _RAIL - 2.6), f"+ {plan.motor.volts:g} V, {plan.wire[0]:g} mm²", size=8, anchor="end")
    canvas.text((29.5, _GROUND + 2.8), "minus joins GND", size=8, anchor="start")


def _put_chain(canvas: Canvas, plan: PowerPlan, places: list[float], step: float, top: float) -> None:
    """A board that speaks to servos which hang on one another."""
    _put_board(canvas, "bus adapter" if plan.motor.is_feetech else "OpenRB-150", top, has_plug=not plan.has_relay)
    if plan.has_relay:
        _box(canvas, (8.0, top + 17.0, 38.0, top + 26.5), "ESP32-S3", "USB: power bank")
        for place, pin in zip((13.0, 23.0, 33.0), (*BOARDS[plan.board or ""].servo_pins, "GND"), strict=True):
            canvas.line([[(place, top + 12.0), (place, top + 17.0)]], width=Canvas.MIDDLE)
            canvas.text((place + 0.8, top + 14.6), pin, size=8, anchor="start")
    line = top + 6.0
    ends = [38.0, *places]
    for one, other in zip(ends, places, strict=False):
        begin = one if one == ends[0] else one + 0.3 * step
        canvas.line([[(begin, line), (other - 0.3 * step, line)]], width=Canvas.MIDDLE)
    for number, place in enumerate(places, start=1):
        _box(canvas, (place - 0.3 * step, top, place + 0.3 * step, top + 12.0), f"ID {number}", "")
    for number in plan.feed_ids:
        if number <= len(places):
            _put_feed(canvas, places[number - 1], top)
    words = "plus and minus go into the chain at " + list_words(f"ID {number}" for number in plan.feed_ids)
    canvas.text((canvas.width, _RAIL - 7.0), words, size=8, anchor="end", grey=0.25)


def _put_drivers(canvas: Canvas, plan: PowerPlan, places: list[float], step: float, top: float) -> None:
    """Draw the boards with the speed signals to the drivers and from the encoders."""
    _put_board(canvas, BOARDS[plan.boards[0]].title.removeprefix("Arduino ").removesuffix("-DevKitC-1"), top)
    if len(plan.boards) == 1:
        _box(canvas, (0.4, 28.0, 25.0, 37.5), "9 V battery" if plan.resets else "power bank", "only to play alone")
        canvas.line([[(12.0, 37.5), (12.0, top)]], width=Canvas.MIDDLE, dash=(1.2, 0.8))
    wide = 0.4 * step
    for place in places:
        _box(canvas, (place - wide, top - 12.0, place + wide, top - 3.0), "driver", "")
        _box(canvas, (place - wide, top + 4.0, place + wide, top + 13.0), "motor", "encoder")
        _put_feed(canvas, place, top - 12.0)
        canvas.line([[(place - 1.5, top - 3.0), (place - 1.5, top + 4.0)]], width=Canvas.THICK)
        canvas.line([[(place + 1.5, top - 3.0), (place + 1.5, top + 4.0)]], width=Canvas.THICK)
        canvas.line([[(place - wide, top - 7.5), (place - wide - 1.5, top - 7.5)]], width=Canvas.THIN)
        canvas.line([[(place - wide, top + 8.5), (place - wide - 1.5, top + 8.5)]], width=Canvas.THIN)
    row = top + 15.5  # below the motors, so that the signals cross no other wire
    canvas.text((50.0, row + 2.6), "signals", size=8, anchor="start")
    way: list[Spot] = [(38.0, top + 9.0), (43.0, top + 9.0), (43.0, row), (places[-1] - wide - 1.5, row)]
    canvas.line([way], width=Canvas.THIN, dash=(1.2, 0.8))
    for place in places:
        across = place - wide - 1.5
        canvas.line([[(across, top - 7.5), (across, row)]], width=Canvas.THIN, dash=(1.2, 0.8))


def _put_board(canvas: Canvas, name: str, top: float, *, has_plug: bool = True) -> None:
    """The board, and the computer at its plug."""
    _box(canvas, (8.0, top, 38.0, top + 12.0), name, "TX   RX   GND" if not has_plug else "")
    if has_plug:
        canvas.line([[(23.0, top + 12.0), (23.0, top + 17.0)]], width=Canvas.MIDDLE)
        canvas.text((23.0, top + 19.5), "USB, computer", size=8)
    _drop(canvas, (28.0, 23.0), (28.0, top), dot=False)
    canvas.line([[(28.0, 23.0), (28.0, _GROUND)]], width=Canvas.MIDDLE)
    canvas.disc((28.0, _GROUND), 0.5, grey=0.0)
    canvas.text((27.0, top - 3.0), "GND", size=8, anchor="end")


def _put_feed(canvas: Canvas, place: float, end: float) -> None:
    """Wires from plus and minus down to a driver or servo; plus passes over minus in a bow, which does not join it."""
    plus, bow = place - 1.5, 1.3
    arc = [
        (plus - bow * math.sin(math.radians(angle)), _GROUND - bow * math.cos(math.radians(angle)))
        for angle in range(0, 181, 20)
    ]
    canvas.line([[(plus, _RAIL), *arc, (plus, end)]], width=Canvas.MIDDLE)
    canvas.disc((plus, _RAIL), 0.5, grey=0.0)
    _drop(canvas, (place + 1.5, _GROUND), (place + 1.5, end))


def _drop(canvas: Canvas, begin: Spot, end: Spot, *, dot: bool = True) -> None:
    canvas.line([[begin, end]], width=Canvas.MIDDLE)
    if dot:
        canvas.disc(begin, 0.5, grey=0.0)


def _box(canvas: Canvas, box: tuple[float, float, float, float], first: str, second: str) -> None:
    left, top, right, bottom = box
    canvas.box(box, grey=1.0)
    canvas.line([[(left, top), (right, top), (right, bottom), (left, bottom)]], width=Canvas.MIDDLE, closed=True)
    middle = ((left + right) / 2, (top + bottom) / 2)
    apart = 2.0 if second else 0.0
    canvas.text((middle[0], middle[1] - apart), first, size=8.5, bold=True)
    if second:
        canvas.text((middle[0], middle[1] + apart), second, size=8.5)
