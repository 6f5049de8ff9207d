"""`pack_class`: robots of a class, with kits and pages if asked for, as one zip, in a process of its own."""

from dataclasses import dataclass
from itertools import count

from hydrostat.errors import HydrostatError, InputError, in_words
from hydrostat.fabrication import KitOptions
from hydrostat.project import Work
from hydrostat.simulation import Simulation
from hydrostat.studio.exporting.download import Download, archive, file_name, work_zip
from hydrostat.studio.exporting.kit_work import make_kit
from hydrostat.studio.jobs import Report

PAGE_TIME = 20.0  # no page of a robot takes longer [s]


@dataclass(frozen=True)
class PupilWork:
    """Robot of a pupil."""

    name: str  # of the pupil
    work: Work
    text: str  # of the robot.toml that it was opened from; "": none
    options: KitOptions  # of its kit


def pack_class(report: Report, works: list[PupilWork], kits: bool, pages: bool) -> Download:
    """Pack the robots of a class. class.txt lists what is missing; Stop ends kits and pages and keeps the rest."""
    files, lines, taken, stopped = dict[str, bytes](), list[str](), set[str](), False
    for number, pupil in enumerate(works):
        folder = _folder(pupil.name, taken)
        robot = work_zip(pupil.work, pupil.text)
        files[f"{folder}/{robot.name}"] = robot.content
        lines.append(f"{pupil.name} ({folder}/): {pupil.work.robot.name}")
        for wanted, words, make in ((kits, "kit", _kit), (pages, "page", _page)):
            report.progress(f"{pupil.name}, {words}" if wanted else pupil.name, number, len(works))
            if not wanted or stopped:
                continue
            try:
                name, content = make(report, pupil)
            except KeyboardInterrupt:
                stopped = True
                lines.append(f"  no {words}, and none for the next pupils: stopped")
            except Exception as error:  # noqa: BLE001 - of one robot: keep the others
                told = in_words(str(error)) if isinstance(error, HydrostatError) else repr(error)
                lines.append(f"  no {words}: {told}")
            else:
                files[f"{folder}/{name}"] = content
    files["class.txt"] = "\n".join([*lines, ""]).encode()
    return Download(name="class.zip", content=archive(files, folder="class"), title="Class")


def _folder(name: str, taken: set[str]) -> str:
    """Folder of a pupil that no other has, whatever the case of its letters."""
    stem = file_name(name)
    folder = next(each for n in count(1) if (each := stem if n == 1 else f"{stem}_{n}").casefold() not in taken)
    taken.add(folder.casefold())
    return folder


def _kit(report: Report, pupil: PupilWork) -> tuple[str, bytes]:
    """Name and content of the kit (InputError: the robot cannot be built)."""
    if not pupil.work.robot.cables:
        raise InputError("the robot has no cables")
    kit = make_kit(_Silent(report), pupil.work.robot, pupil.options)
    if kit.zip is None:
        raise InputError(" ".join(kit.refused))
    return kit.zip.name, kit.zip.content


def _page(report: Report, pupil: PupilWork) -> tuple[str, bytes]:
    """Name and content of the page (InputError: no flat robot with cables)."""
    from hydrostat.toy import make_toy

    robot = pupil.work.robot
    if robot.body.mesh.dim != 2:
        raise InputError("a page of a 3D body takes minutes. Run hydrostat share")
    timeline, silent = pupil.work.timeline, _Silent(report)
    toy = make_toy(Simulation(robot), seconds=PAGE_TIME, timeline=timeline, jobs=1, progress=silent.progress)
    return f"{file_name(robot.name)}.html", toy.page.encode()


@dataclass(frozen=True)
class _Silent:
    """Report of a part of the work, which the class is not told of."""

    report: Report

    def progress(self, stage: str, done: int, total: int) -> None:
        """Say nothing."""

    def part(self, value: object) -> None:
        """Say nothing."""

    def finish(self) -> None:
        """Say nothing."""
