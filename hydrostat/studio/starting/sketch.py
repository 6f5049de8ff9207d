"""`make_sketch`: a robot of a draft, with its pictures. Runs in a process of its own."""

from dataclasses import dataclass, replace
from pathlib import PurePath

from hydrostat.errors import InputError
from hydrostat.geometry import DRAWN_HINT
from hydrostat.robot import Robot, SurfaceSketch, inflate_outline, sketch_robot
from hydrostat.studio.jobs import Report
from hydrostat.studio.starting.draft import BodyDraft
from hydrostat.studio.starting.photo import Backdrop, backdrop, cut_out

MOST_MEMORY = 6 * 2**30  # the process may have so much memory [bytes]; a file that needs more is refused


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


def make_sketch(report: Report, draft: BodyDraft) -> Sketch:
    """Read, heal, mesh and draw (InputError: no body can be made of it; one line says why)."""
    _limit_memory()
    try:
        return _sketch(report, draft)
    except MemoryError:
        raise InputError(f"{draft.file}: needs more than {MOST_MEMORY >> 30} GB of memory. Simplify it") from None
    except RecursionError:
        raise InputError(f"{draft.file}: nested too deep. Export it again") from None
    except InputError as error:
        raise InputError(_here(str(error))) from None


def _sketch(report: Report, draft: BodyDraft) -> Sketch:
    from hydrostat.geometry import read_drawing

    report.progress("reading", 0, 2)
    file, content, size, lines = draft.file, draft.content, draft.size, ()
    behind = None
    if draft.is_drawing:
        if draft.is_picture and not draft.reading.plain:
            read_drawing(content, name=file, size=size)  # a file that is no picture is told as such
            file, content = f"{PurePath(file).stem}.png", cut_out(content, draft.reading)
        drawing = read_drawing(content, name=file, size=size, inner=draft.inner)
        lines = tuple(map(_here, drawing.notes))
        if draft.is_picture:
            behind = backdrop(draft.content, content, name=file, size=size)
        if draft.inflate is None:
            made = _with_pictures(report, draft, _flat(report, draft, file, content), lines, None)
            return replace(made, behind=behind)
        report.progress("inflating the outline", 0, 2)
        content, file, size = inflate_outline(drawing.outline, draft.inflate), f"{PurePath(file).stem}.ply", None
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
    return words.replace(f"say {DRAWN_HINT}", 'choose "Surface lines" for shapes inside')


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
        repair = inline_svg(figure, name="repair", label=f"{draft.file} as it came, and healed")
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
    most = MOST_MEMORY if hard == resource.RLIM_INFINITY else min(MOST_MEMORY, hard)
    resource.setrlimit(resource.RLIMIT_AS, (most, hard))
