"""`make_kit`: the kit of a robot with pictures of its pages, in a process of its own."""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from hydrostat.fabrication import Check, KitOptions, UnbuildableError, build_kit
from hydrostat.robot import Robot
from hydrostat.studio.exporting.download import Download, archive, file_name
from hydrostat.studio.jobs import Report


@dataclass(frozen=True, kw_only=True)
class KitMade:
    """A kit, or why there is none."""

    options: KitOptions  # that it was made with
    refused: tuple[str, ...] = ()  # why the robot cannot be built well; then there is nothing but these
    zip: Download | None = None  # all files; None if it was refused
    summary: tuple[str, ...] = ()  # what is in it, a line each
    warnings: tuple[str, ...] = ()  # what may fail later
    notes: tuple[str, ...] = ()  # information for the builder
    problems: tuple[str, ...] = ()  # why it cannot be built well, where it was made all the same
    checks: tuple[Check, ...] = ()  # whether the files are true to the robot that was simulated
    pages: tuple[bytes, ...] = ()  # of the assembly sheet, as PNG
    pattern: bytes | None = None  # of a plush robot, as SVG

    @property
    def check_summary(self) -> str:
        """Count of the passed checks, such as "8 of 8 checks passed"."""
        held = sum(check.passed for check in self.checks)
        return f"{held} of {len(self.checks)} checks passed"


SHEET, PATTERN = "assembly_sheet.pdf", "pattern/pattern.svg"

THICK = b"<style>* { vector-effect: non-scaling-stroke; stroke-width: 1px; }</style>"


def make_kit(report: Report, robot: Robot, options: KitOptions) -> KitMade:
    """Make the kit of a robot with cables, with pictures of its pages (InputError: the method cannot make the body)."""
    try:
        kit = build_kit(robot, options=options, progress=report.progress)
    except UnbuildableError as error:
        return KitMade(options=options, refused=error.reasons)
    report.progress("Pictures of the pages", 0, 1)
    name = f"{file_name(robot.name)}_kit"
    return KitMade(
        options=options,
        zip=Download(name=f"{name}.zip", content=archive(kit.files, folder=name), title="Kit"),
        summary=kit.summary,
        warnings=kit.warnings,
        notes=kit.notes,
        problems=kit.problems,
        checks=kit.checks,
        pages=page_pictures(kit.files[SHEET]),
        pattern=_screen_pattern(kit.files[PATTERN]) if PATTERN in kit.files else None,
    )


def _screen_pattern(pattern: bytes) -> bytes:
    """A pattern with lines as thin as a screen shows, rather than as a laser cuts."""
    head, end, rest = pattern.partition(b"<title>")
    return head + THICK + end + rest


def page_pictures(pdf: bytes) -> tuple[bytes, ...]:
    """Each page as PNG; none if the typesetter at hand is too old to read PDF."""
    import typst

    dots = 110.0  # to the inch: fine enough to be read where a page is as wide as a window
    most_pages = 12
    with TemporaryDirectory() as folder:
        sheet, source = Path(folder) / "sheet.pdf", Path(folder) / "pages.typ"
        sheet.write_bytes(pdf)
        pages = []
        for number in range(1, most_pages + 1):
            source.write_text(_PAGE.format(number=number), encoding="utf-8")
            try:
                pages.append(typst.compile(source, format="png", ppi=dots))
            except (RuntimeError, typst.TypstError):  # the sheet has no such page
                break
    return tuple(pages)


_PAGE = '#set page(width: auto, height: auto, margin: 0pt)\n#image("sheet.pdf", page: {number})\n'
