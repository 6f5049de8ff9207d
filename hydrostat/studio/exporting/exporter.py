"""`Exporter`: the stage "export"."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from hydrostat.errors import HydrostatError, InputError
from hydrostat.fabrication import KitOptions
from hydrostat.ik import IKOptions, IKResult, solve_ik
from hydrostat.robot import CableSide, Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.exporting.download import Download, archive, file_name, work_files, work_zip
from hydrostat.studio.exporting.kit_work import KitMade, make_kit
from hydrostat.studio.exporting.report_work import make_pictures, make_report
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.robot_link import pack_robot
from hydrostat.studio.stage import Stage
from hydrostat.studio.view.robot_items import diagnostic_items, robot_items
from hydrostat.studio.view.scene_items import RobotShape, SceneItem, rest_shape

_ONCE = IKOptions(restarts=0)  # a pose is shown as soon as it is found


class Export(StrEnum):
    """Output that is made in a process of its own."""

    KIT = "kit"
    REPORT = "report"
    PICTURES = "pictures"


@dataclass(frozen=True, eq=False)
class _Made:
    """A result, with the robot it is of."""

    robot: Robot
    value: Any
    name: str = ""


class Exporter(Stage):
    """Export stage: kit, report, pictures and the robot itself. All is in memory until it is downloaded.

    A result is that of one robot: it is not shown once the robot has changed, and is back if the change is undone.
    Options of the next kit, its method, motor and paper, are of this sitting: they are not part of the robot, not saved
    with it, and not undone.
    """

    def __init__(self, document: Document, jobs: Jobs) -> None:
        self._document, self._jobs = document, jobs
        self.options = KitOptions()  # of the next kit
        self.pose = ""  # that is shown, by its name; "": the robot at rest
        self.busy: Export | None = None  # what is being made; None: nothing
        self.errors: dict[Export, str] = {}  # why something could not be made, by what it was
        self._made: dict[Export, _Made] = {}
        self._posed: _Made | None = None
        self._turn: object = None

    @property
    def kit(self) -> KitMade | None:
        """The kit of the robot as it is now, if it was made."""
        return self._result(Export.KIT)

    @property
    def report(self) -> Download | None:
        """The report of the robot as it is now, if it was made."""
        return self._result(Export.REPORT)

    @property
    def pictures(self) -> tuple[Download, ...]:
        """Pictures of the robot as it is now, if they were made."""
        return self._result(Export.PICTURES) or ()

    def is_outdated(self, export: Export) -> bool:
        """True if an export was made and the robot has changed since."""
        return export in self._made and self._result(export) is None

    def choose(self, options: KitOptions) -> None:
        """Have the next kit made so."""
        if options != self.options:
            self.options = self._document.judge.options = options
            self._document.bell.ring(Topic.JOB, Topic.SCENE)

    def lay_cables(self, face: CableSide) -> None:
        """Have the cables of a flat robot run there, one step to undo (InputError: a robot in space)."""
        robot = self._document.robot
        if face is not robot.face:
            self._document.change(f"cables {face.words}", robot=replace(robot, face=face))

    def show(self, pose: str) -> None:
        """Show a pose as the winches reach it, by its name; "": the robot at rest."""
        self.pose = pose
        self._document.bell.ring(Topic.SHAPE, Topic.SCENE)

    def make_kit(self, *, force: bool = False) -> None:
        """Make the kit as a job; if forced, even where it cannot be built well (InputError: no cables, or busy)."""
        if not self._document.robot.cables:
            raise InputError("a kit needs cables. Press Design, or place winches and cables by hand")
        options = self.kit_options()
        self._start(Export.KIT, "Building the kit", make_kit, replace(options, force=force or options.force))

    def kit_options(self) -> KitOptions:
        """Options of the next kit, with the limits that were asked for (InputError: no robot is open)."""
        robot = self._document.robot
        wished, designed = self._document.work.wishes.to_constraints(robot), self._document.judge.torque_limit(robot)
        limits = [torque for torque in (wished.torque, designed) if torque is not None]
        return replace(self.options, tension=wished.tension_limit, torque=min(limits, default=None))

    def make_report(self) -> None:
        """Write the report, in a process of its own (InputError: other work is in progress)."""
        self._start(Export.REPORT, "Writing the report", make_report)

    def make_pictures(self) -> None:
        """Draw the pictures, in a process of its own (InputError: other work is in progress)."""
        self._start(Export.PICTURES, "Drawing pictures", make_pictures)

    def pictures_zip(self) -> Download:
        """All pictures in one file (InputError: there are none yet)."""
        if not self.pictures:
            raise InputError("no pictures of this robot yet. Draw them first")
        name = f"{file_name(self._document.robot.name)}_pictures"
        files = {picture.name: picture.content for picture in self.pictures}
        return Download(name=f"{name}.zip", content=archive(files, folder=name), title="Pictures")

    def robot_zip(self) -> Download:
        """The folder of the robot in one file (InputError: no robot is open)."""
        return work_zip(self._document.work, self._document.text)

    def robot_link(self) -> str:
        """The robot as the end of a link (InputError: none is open, in space, no drawing, or too large)."""
        work = self._document.work
        if work.robot.body.mesh.dim != 2:
            raise InputError("a link holds flat robots only. Send the .zip")
        return pack_robot(work_files(work, ""))

    def enter(self) -> None:
        """Let a process stand ready, so that work begins at once."""
        self._jobs.warm(make_kit.__module__)

    def shape(self) -> RobotShape:
        """The pose that is shown, once it is solved; till then the rest shape."""
        posed = self._posed
        if posed is not None and self._is_wanted(posed):
            reached: IKResult = posed.value
            pose = reached.pose
            return RobotShape(
                nodes=pose.nodes, tensions=pose.tensions, contractions=pose.contractions, errors=dict(reached.errors)
            )
        return rest_shape(self._document.robot)

    def scene_items(self) -> Sequence[SceneItem]:
        """All parts of the robot."""
        tensions = self.shape().tensions
        most = float(tensions.max(initial=0.0))
        robot, judge = self._document.robot, self._document.judge
        flags = diagnostic_items(robot, judge.of(robot, self._document.work.wishes) or (), judge.chosen)
        return [*robot_items(robot, tensions=tensions, scale=most or 1.0), *flags]

    def step(self, now: float) -> bool:
        """Solve the pose that is shown, if it is not yet; judge the robot once it has rested."""
        robot = self._document.robot
        self._document.judge.look(robot, self._document.work.wishes, now)
        pose = robot.poses.get(self.pose) if robot.cables else None
        if pose is None or (self._posed is not None and self._is_wanted(self._posed)):
            return False
        name = self.pose
        try:
            self._posed = _Made(robot, solve_ik(self._document.simulation, pose, options=_ONCE), name)
        except HydrostatError:
            self.pose = ""
            raise
        self._document.bell.ring(Topic.SHAPE, Topic.SCENE)
        return False

    def _is_wanted(self, posed: "_Made") -> bool:
        return posed.name == self.pose and posed.robot is self._document.robot

    def _start(self, export: Export, title: str, function: Callable[..., Any], *arguments: Any) -> None:
        robot = self._document.robot

        turn = object()

        def keep(value: Any) -> None:
            self._made[export] = _Made(robot, value)
            if isinstance(value, KitMade) and value.refused:
                self._document.judge.learn(robot, refused=value.refused)
            self.errors.pop(export, None)

        def end(error: str) -> None:
            if self._turn is turn:
                self.busy = None
            if error and error != "stopped":
                self.errors[export] = error
            self._document.bell.ring(Topic.JOB)

        before = self.busy, self._turn
        self.busy, self._turn = export, turn  # before it starts: it may be at its end at once
        failed = self.errors.pop(export, None)
        try:
            self._jobs.start(title, function, robot, *arguments, on_done=keep, on_end=end)
        except InputError:
            self.busy, self._turn = before
            if failed is not None:
                self.errors[export] = failed
            raise

    def _result(self, export: Export) -> Any:
        made = self._made.get(export)
        current = made is not None and self._document.is_open and made.robot is self._document.robot
        return made.value if made is not None and current else None
