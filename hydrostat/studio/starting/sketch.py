"""`make_sketch`: a robot of a draft, with its pictures. Runs in a process of its own."""

import re
from dataclasses import dataclass, replace
from html import escape
from pathlib import PurePath

import numpy as np

from hydrostat.errors import InputError, SeveralPartsError
from hydrostat.geometry import DRAWN_HINT
from hydrostat.robot import Robot, SurfaceSketch, inflate_outline, sketch_robot
from hydrostat.studio.jobs import Report
from hydrostat.studio.starting.draft import BodyDraft
from hydrostat.studio.starting.photo import Backdrop, backdrop, cut_out

_CHOICE = re.compile(r": choose one by --part N.*")

MAX_MEMORY = 6 * 2**30  # the process may have so much memory [bytes]; a file that needs more is refused


@dataclass(frozen=True, kw_only=True, eq=False)
class Sketch:
    """A first robot, and what there is to know of it."""

    draft: BodyDraft  # what it is made of
    robot: Robot  # that would be begun with
    lines: tuple[str, ...]  # what was found and done in reading, healing and meshing
    clean: bool  # whether nothing had to be mended
    picture: str  # of the robot, as SVG that follows the colors of the page
    repair: str = ""  # of what was mended, likewise; "" if nothing was
    behind: Backdrop | None = None  # the picture that a flat body was read from; None: it was no picture


@dataclass(frozen=True, kw_only=True, eq=False)
class PartChoice:
    """Shapes of a file, one of which is the body."""

    file: str  # name of the file
    rings: dict[int, np.ndarray]  # corners of each by its number [mm], y up

    def picture(self, chosen: int | None) -> str:
        """Draw the shapes with their numbers as SVG; each is an element with `data-part`."""
        corners = np.concatenate(list(self.rings.values()))
        (left, low), (right, high) = corners.min(axis=0), corners.max(axis=0)
        size = max(right - left, high - low)
        edge = 0.04 * size
        box = f"{left - edge:.2f} {-high - edge:.2f} {right - left + 2 * edge:.2f} {high - low + 2 * edge:.2f}"
        shapes = []
        for number, ring in self.rings.items():
            path = "M" + " L".join(f"{x:.2f},{-y:.2f}" for x, y in ring) + "Z"
            x, y = (ring.min(axis=0) + ring.max(axis=0)) / 2
            kind = ' class="start-part-chosen"' if number == chosen else ""
            shapes.append(
                f'<g data-part="{number}"{kind}><path d="{path}" vector-effect="non-scaling-stroke"/>'
                f'<text x="{x:.2f}" y="{-y:.2f}" font-size="{0.07 * size:.2f}">{number}</text></g>'
            )
        return f'<svg viewBox="{box}" role="img" aria-label="Shapes of {escape(self.file)}">{"".join(shapes)}</svg>'


def make_sketch(report: Report, draft: BodyDraft) -> Sketch:
    """Read, heal, mesh and draw (InputError: no body can be made of it; one line says why)."""
    _limit_memory()
    try:
        return _sketch(report, draft)
    except MemoryError:
        raise InputError(f"{draft.file}: needs more than {MAX_MEMORY >> 30} GB of memory. Simplify it") from None
    except RecursionError:
        raise InputError(f"{draft.file}: nested too deep. Export it again") from None
    except SeveralPartsError as error:
        rings = {number: 1e3 * np.asarray(ring) for number, ring in error.parts.items()}
        if rings:
            report.part(PartChoice(file=draft.file, rings=rings))
        raise InputError(_CHOICE.sub(". Click the one that is the body", str(error))) from None
    except InputError as error:
        raise InputError(_here(str(error))) from None


def _sketch(report: Report, draft: BodyDraft) -> Sketch:
    from hydrostat.geometry import STEP_SUFFIXES, convert_step, read_drawing

    report.progress("reading", 0, 2)
    file, content, size, lines = draft.file, draft.content, draft.size, ()
    behind = None
    if draft.is_drawing:
        if draft.is_picture and not draft.reading.plain:
            read_drawing(content, name=file, size=size)  # a file that is no picture is told as such
            file, content = f"{PurePath(file).stem}.png", cut_out(content, draft.reading)
        drawing = read_drawing(content, name=file, size=size, inner=draft.inner, part=draft.part)
        lines = tuple(map(_here, drawing.notes))
        if draft.is_picture:
            behind = backdrop(draft.content, content, name=file, size=size)
        if draft.inflate is None:
            made = _with_pictures(report, draft, _flat(report, draft, file, content), lines, None)
            return replace(made, behind=behind)
        report.progress("inflating the outline", 0, 2)
        content, file, size = inflate_outline(drawing.outline, draft.inflate), f"{PurePath(file).stem}.ply", None
    elif file.endswith(STEP_SUFFIXES):
        content, lines = convert_step(content, name=file, part=draft.part)
        file = f"{PurePath(file).stem}.ply"
    sketch = SurfaceSketch.of_scan(
        content,
        file=file,
        name=draft.name,
        size=size,
        element_size=draft.element_size,
        nodes=draft.nodes,
        material=draft.material,
        tell=lambda stage: report.progress(stage, 0, 2),
    )
    return _with_pictures(report, draft, sketch.robot, (*lines, *sketch.healing.lines(), *sketch.notes), sketch)


def _here(words: str) -> str:
    """Text on a drawing, with the name of the control in the studio in place of the option."""
    return words.replace(f"add {DRAWN_HINT}", 'choose "Surface lines"')


def _flat(report: Report, draft: BodyDraft, file: str, content: bytes) -> Robot:
    report.progress("meshing", 0, 2)
    return sketch_robot(
        content,
        file=file,
        name=draft.name,
        size=draft.size,
        element_size=draft.element_size,
        thickness=draft.thickness,
        nodes=draft.nodes,
        material=draft.material,
        inner=draft.inner,
        drawing_part=draft.part,
    )


def _with_pictures(
    report: Report, draft: BodyDraft, robot: Robot, lines: tuple[str, ...], sketch: SurfaceSketch | None
) -> Sketch:
    """With its pictures, and without the pose that a first robot has as an example: a person makes poses here."""
    from hydrostat.plot import draw_healing, draw_rest, inline_svg

    report.progress("drawing", 1, 2)
    width = 6.4  # of pictures [inch]
    picture = inline_svg(draw_rest(robot, title="", width=width), name="sketch", label=f"{draft.name} at rest")
    repair = ""
    if sketch is not None and not sketch.healing.clean:
        figure = draw_healing(sketch.before, sketch.healing.surface, places=sketch.healing.places, width=width)
        repair = inline_svg(figure, name="repair", label=f"{draft.file} as imported, and healed")
    clean = not lines if sketch is None else sketch.healing.clean
    return Sketch(
        draft=draft, robot=replace(robot, poses={}), lines=tuple(lines), clean=clean, picture=picture, repair=repair
    )


def _limit_memory() -> None:
    """Limit the memory of this process where the system can: a file must not take the whole machine."""
    try:
        import resource
    except ImportError:  # Windows
        return
    from multiprocessing import parent_process

    if parent_process() is None:
        return  # only a process of its own; tests call this in theirs
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    most = MAX_MEMORY if hard == resource.RLIM_INFINITY else min(MAX_MEMORY, hard)
    resource.setrlimit(resource.RLIMIT_AS, (most, hard))
