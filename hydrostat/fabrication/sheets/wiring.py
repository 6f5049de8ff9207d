"""`wiring_scheme`: how supply, board and motors are joined, for servos on a bus and for motors on boards."""

from hydrostat.drawing import MIDDLE, THICK, THIN, Canvas, Spot
from hydrostat.fabrication.lists.power import PowerPlan

_MOST = 6  # motors that are drawn; of more the last are told in words


def wiring_scheme(plan: PowerPlan, marks: tuple[str, ...], *, width: float) -> Canvas:
    """Supply, fuse, switch, board and motors [mm of paper]; `marks` are those of the winches, as on the map."""
    canvas = Canvas(width, 74.0)
    shown = marks[:_MOST]
    _put_power(canvas, plan)
    left, right, top = 50.0, width, 46.0
    step = (right - left) / len(shown)
    places = [left + step * (place + 0.5) for place in range(len(shown))]
    (_put_chain if plan.servos else _put_drivers)(canvas, plan, places, step, top)
    for place, mark in zip(places, shown, strict=True):
        canvas.balloon((place, top + 20.0), mark, dark=True)
    if len(marks) > _MOST:
        canvas.text((right, top + 26.5), f"and so on to {marks[-1]}", size=8, anchor="end", grey=0.25)
    return canvas


_RAIL, _GROUND = 14.0, 19.0  # heights of plus and minus [mm]


def _put_power(canvas: Canvas, plan: PowerPlan) -> None:
    """The supply at the left, its fuse and switch, and both rails."""
    _box(canvas, (0.4, 10.0, 26.0, 23.0), f"supply {plan.motor.volts:g} V", f"{plan.supply:g} A")
    end = canvas.width - 1.0
    canvas.line([[(26.0, _RAIL), (31.0, _RAIL)], [(39.0, _RAIL), (44.0, _RAIL)]], width=THICK)
    canvas.line([[(26.0, _GROUND), (end, _GROUND)], [(53.0, _RAIL), (end, _RAIL)]], width=THICK)
    canvas.line([[(31.0, 12.4), (39.0, 12.4), (39.0, 15.6), (31.0, 15.6)]], width=MIDDLE, closed=True)
    canvas.line([[(31.0, _RAIL), (39.0, _RAIL)]], width=THIN)
    canvas.text((35.0, 9.6), f"fuse {plan.fuse:g} A", size=8)
    canvas.line([[(44.0, _RAIL), (52.0, 10.6)]], width=THICK)
    canvas.disc((44.0, _RAIL), 0.7, grey=0.0)
    canvas.disc((53.0, _RAIL), 0.7, grey=0.0)
    canvas.text((49.0, 7.4), "switch, in reach", size=8)
    canvas.text((end, _RAIL - 2.6), f"+ {plan.motor.volts:g} V, {plan.wire[0]:g} mm²", size=8, anchor="end")
    canvas.text((29.5, _GROUND + 2.8), "minus joins GND", size=8, anchor="start")


def _put_chain(canvas: Canvas, plan: PowerPlan, places: list[float], step: float, top: float) -> None:
    """A board that speaks to servos which hang on one another."""
    _put_board(canvas, "OpenRB-150", top)
    line = top + 6.0
    ends = [38.0, *places]
    for one, other in zip(ends, places, strict=False):
        begin = one if one == ends[0] else one + 0.3 * step
        canvas.line([[(begin, line), (other - 0.3 * step, line)]], width=MIDDLE)
    for number, place in enumerate(places, start=1):
        _box(canvas, (place - 0.3 * step, top, place + 0.3 * step, top + 12.0), f"ID {number}", "")
    groups = min(plan.feeds, len(places))
    for group in range(groups):
        place = places[group * len(places) // groups]
        _drop(canvas, (place - 1.5, _RAIL), (place - 1.5, top))
        _drop(canvas, (place + 1.5, _GROUND), (place + 1.5, top))
    words = "plus and minus go into the chain" + (f" in {plan.feeds} places" if plan.feeds > 1 else "")
    canvas.text((canvas.width, top - 5.0), words, size=8, anchor="end", grey=0.25)


def _put_drivers(canvas: Canvas, plan: PowerPlan, places: list[float], step: float, top: float) -> None:
    """Boards that tell drivers how fast, and hear encoders."""
    _put_board(canvas, {"uno": "Uno", "mega": "Mega"}[plan.boards[0]], top)
    del plan
    wide = 0.4 * step
    for place in places:
        _box(canvas, (place - wide, top - 12.0, place + wide, top - 3.0), "driver", "")
        _box(canvas, (place - wide, top + 4.0, place + wide, top + 13.0), "motor", "encoder")
        _drop(canvas, (place - 1.5, _RAIL), (place - 1.5, top - 12.0))
        _drop(canvas, (place + 1.5, _GROUND), (place + 1.5, top - 12.0))
        canvas.line([[(place - 1.5, top - 3.0), (place - 1.5, top + 4.0)]], width=THICK)
        canvas.line([[(place + 1.5, top - 3.0), (place + 1.5, top + 4.0)]], width=THICK)
        canvas.line([[(place - wide, top - 7.5), (place - wide - 1.5, top - 7.5)]], width=THIN)
        canvas.line([[(place - wide, top + 8.5), (place - wide - 1.5, top + 8.5)]], width=THIN)
    canvas.line([[(38.0, top + 0.5), (places[-1] - wide - 1.5, top + 0.5)]], width=THIN, dash=(1.2, 0.8))
    for place in places:
        canvas.line([[(place - wide - 1.5, top - 7.5), (place - wide - 1.5, top + 8.5)]], width=THIN, dash=(1.2, 0.8))


def _put_board(canvas: Canvas, name: str, top: float) -> None:
    """The board, and the computer at its plug."""
    _box(canvas, (8.0, top, 38.0, top + 12.0), name, "")
    canvas.line([[(23.0, top + 12.0), (23.0, top + 17.0)]], width=MIDDLE)
    canvas.text((23.0, top + 19.5), "USB, computer", size=8)
    _drop(canvas, (28.0, 23.0), (28.0, top), dot=False)
    canvas.line([[(28.0, 23.0), (28.0, _GROUND)]], width=MIDDLE)
    canvas.disc((28.0, _GROUND), 0.5, grey=0.0)
    canvas.text((27.0, top - 3.0), "GND", size=8, anchor="end")


def _drop(canvas: Canvas, begin: Spot, end: Spot, *, dot: bool = True) -> None:
    canvas.line([[begin, end]], width=MIDDLE)
    if dot:
        canvas.disc(begin, 0.5, grey=0.0)


def _box(canvas: Canvas, box: tuple[float, float, float, float], first: str, second: str) -> None:
    left, top, right, bottom = box
    canvas.box(box, grey=1.0)
    canvas.line([[(left, top), (right, top), (right, bottom), (left, bottom)]], width=MIDDLE, closed=True)
    middle = ((left + right) / 2, (top + bottom) / 2)
    apart = 2.0 if second else 0.0
    canvas.text((middle[0], middle[1] - apart), first, size=8.5, bold=True)
    if second:
        canvas.text((middle[0], middle[1] + apart), second, size=8.5)
