"""`make_kit`: the kit of a robot, in a process of its own."""

from hydrostat.fabrication import KitOptions, UnbuildableError, build_kit
from hydrostat.robot import Robot
from hydrostat.studio.exporting.archive import archive, file_name
from hydrostat.studio.exporting.download import Download
from hydrostat.studio.exporting.kit_made import KitMade
from hydrostat.studio.exporting.page_pictures import page_pictures
from hydrostat.studio.jobs import Report

SHEET, PATTERN = "assembly_sheet.pdf", "pattern/pattern.svg"

THICK = b"<style>* { vector-effect: non-scaling-stroke; stroke-width: 1px; }</style>"


def make_kit(report: Report, robot: Robot, options: KitOptions) -> KitMade:
    """Make the kit of a robot with cables, with pictures of its pages.

    Raises:
        InputError: a body that the method cannot make.
    """
    try:
        kit = build_kit(robot, options=options, progress=report.progress)
    except UnbuildableError as error:
        return KitMade(options=options, refused=error.reasons)
    report.progress("Pictures of the pages", 0, 1)
    name = f"{file_name(robot.name)}_kit"
    return KitMade(
        options=options,
        zip=Download(name=f"{name}.zip", content=archive(kit.files, folder=name), title="Kit"),
        count=len(kit.files),
        summary=kit.summary,
        warnings=kit.warnings,
        problems=kit.problems,
        checks=kit.checks,
        pages=page_pictures(kit.files[SHEET]),
        pattern=_seen(kit.files[PATTERN]) if PATTERN in kit.files else None,
    )


def _seen(pattern: bytes) -> bytes:
    """A pattern with lines as thin as a screen shows, rather than as a laser cuts."""
    head, end, rest = pattern.partition(b"<title>")
    return head + THICK + end + rest
