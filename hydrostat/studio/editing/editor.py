"""`Editor`: the stage "edit"."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from enum import StrEnum
from typing import Any

import numpy as np

from hydrostat.closed_set import member
from hydrostat.errors import InputError
from hydrostat.robot import Point, Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.editing.cable_draft import CableDraft, begin_cable, end_cable, overlay
from hydrostat.studio.editing.change import change, remesh, rename, set_contact, set_gravity
from hydrostat.studio.editing.findings import Findings, look_over
from hydrostat.studio.editing.hold import Hold, below_skin, inside, take_hold
from hydrostat.studio.editing.part import Mirror, find_part, name_of, title_of
from hydrostat.studio.editing.place import add_marker, add_pin, add_winch, move, remove
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.records.work import followed
from hydrostat.studio.stage import Hit, Stage
from hydrostat.studio.view.finding_things import finding_things
from hydrostat.studio.view.robot_things import robot_things
from hydrostat.studio.view.things import RobotShape, Thing, rest_shape


class Tool(StrEnum):
    """The tools."""

    MOVE = "move"
    PIN = "pin"
    MARKER = "marker"
    WINCH = "winch"
    CABLE = "cable"


KEYS = {"v": Tool.MOVE, "p": Tool.PIN, "m": Tool.MARKER, "w": Tool.WINCH, "c": Tool.CABLE}  # the key of each tool
SAME_CLICK = 0.005  # a click so near to the last one, as a share of the body, ends a cable: it was a double click
DEPTH = 0.005  # how deep below the skin of a body in space winches and cables are placed at first [m]


class Editor(Stage):
    """The body at rest, and tools to place, move, change and delete what is in it."""

    def __init__(self, document: Document, jobs: Jobs) -> None:
        self._document, self._jobs = document, jobs
        self.tool = Tool.MOVE  # what the pointer does
        self.mirror: Mirror | None = None  # both sides are edited alike about this plane; None: only what is touched
        self.depth = DEPTH  # how deep below the skin of a body in space winches and cables are placed [m]
        self.draft: CableDraft | None = None  # the cable that is being laid
        self._chosen = ""
        self._hold: Hold | None = None
        self._holds = 0
        self._refused = ""
        self._counted: tuple[Robot, Findings] | None = None

    @property
    def chosen(self) -> str:
        """Key of the part that is selected; "" for none."""
        if self._document.is_open and find_part(self._document.robot, self._chosen) is not None:
            return self._chosen
        return ""

    @property
    def findings(self) -> Findings | None:
        """Counts of the robot as it is; None until it has rested."""
        counted = self._counted
        return counted[1] if counted is not None and counted[0] is self._document.robot else None

    def shape(self) -> RobotShape:
        """The rest shape."""
        shape = rest_shape(self._document.robot)
        return replace(shape, notes=(self._refused,)) if self._refused else shape

    def things(self) -> Sequence[Thing]:
        """All parts of the robot, the cable that is being laid, and the plane of the mirror."""
        robot = self._document.robot
        chosen = set(self._both(robot, self.chosen)) if self.chosen else set()
        judge = self._document.judge
        flags = finding_things(robot, judge.of(robot, self._document.work.wishes) or (), judge.chosen)
        return [*robot_things(robot, vias=True, chosen=chosen), *flags, *overlay(robot, self.draft, self.mirror)]

    def leave(self) -> None:
        """Drop what was begun: another stage is shown."""
        self.draft, self._hold, self._refused = None, None, ""

    # What the panel does.

    def choose(self, key: str) -> None:
        """Select a part; "" for none."""
        self._chosen = key
        self._ring()

    def take(self, tool: Tool | str) -> None:
        """Take another tool; a cable that was begun is dropped (InputError: there is no tool of this name)."""
        self.tool, self.draft = member(Tool, tool, what="tool"), None
        self._ring()

    def mirror_about(self, axis: str) -> None:
        """Edit both sides of the plane where a coordinate is 0 alike; "": no longer (InputError: no such axis)."""
        axes = "xyz"[: self._document.robot.body.mesh.dim]
        if axis not in axes:
            raise InputError(f'there is no axis "{axis}"; the body has {", ".join(axes)}')
        self.mirror = Mirror(axis=axes.index(axis)) if axis else None
        self._ring()

    def set_depth(self, depth: float) -> None:
        """Set how deep below the skin winches and cables are placed [m] (InputError: it is no depth in this body)."""
        size = self._document.robot.body.mesh.size
        if not 0 <= depth <= size:
            raise InputError(f"the depth must be from 0 to {1e3 * size:.0f} mm, the size of the body")
        self.depth = depth

    def place(self, key: str, at: Point) -> None:
        """Put a part somewhere (InputError: it cannot be there)."""
        robot = self._document.robot
        self._change(f"move {title_of(key)}", move(robot, take_hold(robot, key, self.mirror).places(at)))

    def rename(self, key: str, name: str) -> None:
        """Give a winch, cable or marker another name (InputError: a name that is taken or not allowed)."""
        before, robot = name_of(self._document.robot, key), self._document.robot
        if name == before:
            return
        kind = key.partition(":")[0]
        renames = {before: name} if kind == "winch" else None
        self._change(f"rename {title_of(key)}", rename(robot, key, name), renames)
        self.choose(key if kind == "cable" else f"{kind}:{name}")

    def set(self, key: str, **values: Any) -> None:
        """Change numbers of a part, in SI, and of its twin; see `change.FIELDS` (InputError: one cannot be)."""
        robot = self._document.robot
        self._change(f"change {title_of(key)}", change(robot, self._both(robot, key), **values))

    def delete(self) -> None:
        """Remove what is selected, and its twin (InputError: the robot cannot do without it)."""
        key = self.chosen
        if key:
            robot = self._document.robot
            self._change(f"delete {title_of(key)}", remove(robot, self._both(robot, key)))
            self.choose("")

    def set_gravity(self, direction: str) -> None:
        """Let weight pull in a direction such as "-y"; "": none (InputError: no direction of this body)."""
        self._change(f"gravity {direction or 'off'}", set_gravity(self._document.robot, direction))

    def set_contact(self, on: bool) -> None:
        """Let parts of the body push one another off, at the usual distance, or pass through."""
        self._change(f"contact {'on' if on else 'off'}", set_contact(self._document.robot, on=on))

    def set_body(self, **values: Any) -> None:
        """Change material, thickness or element size as `remesh` does; takes a while, so call it in a thread.

        After an InputError, for a number out of its range or parts that no longer fit, nothing has changed.
        """
        before = self._document.robot.body
        body = remesh(self._document.robot, **values)
        words = " and ".join(key.replace("_", " ") for key in values)
        while True:
            robot = self._document.robot  # parts of it may have been changed meanwhile
            if robot.body is not before:
                raise InputError(f"{words}: the body is another one by now, so nothing was changed; ask for it again")
            changed = replace(robot, body=body)
            if self._document.robot is robot:
                self._change(f"change {words}", changed)
                return

    def finish(self) -> None:
        """End the cable at its last point (InputError: it has no stopper yet)."""
        if self.draft is None:
            return
        laid = end_cable(self._document.robot, self.draft, self.mirror)
        self.draft = None
        self._change("add cable", laid)
        self.choose(f"cable:{len(laid.cables) - 1}")

    def cancel(self) -> None:
        """Drop the cable that was begun; else the selection, and take the first tool."""
        if self.draft is not None:
            self.draft = None
            self._ring()
        else:
            self._chosen = ""
            self.take(Tool.MOVE)

    # What the pointer does.

    def grab(self, hit: Hit) -> bool:
        """Take hold of a part; of a cable, to draw a new via point out of it."""
        robot = self._document.robot
        if self.draft is not None or find_part(robot, hit.key) is None:
            return False
        if self.tool is Tool.CABLE and not hit.key.startswith("via:"):
            return False  # it is a click that begins a cable
        if self._chosen != hit.key:
            self.choose(hit.key)
        self._hold = take_hold(robot, hit.key, self.mirror, hit.world)
        self._holds += 1
        return True

    def drag(self, hit: Hit) -> None:
        """Move what is held; where it cannot be it stays at the last place where it could."""
        if self._hold is None:
            return
        try:
            robot, hold = self._hold.drawn_out(self._document.robot)
            moved = move(robot, hold.places(hold.asked(robot, hit.world)))
        except InputError as error:
            self._refused = str(error)
            return
        self._hold, self._chosen, self._refused = hold, hold.key, ""
        self._document.change(f"move {title_of(hold.key)}", robot=moved, merge=f"drag {self._holds}")

    def release(self) -> None:
        """Let go."""
        self._hold, self._refused = None, ""

    def click(self, hit: Hit) -> None:
        """Select, place a new part, or lay a cable one point further."""
        if self.tool is Tool.CABLE:
            self._lay(hit)
        elif self.tool is Tool.MOVE or find_part(self._document.robot, hit.key) is not None:
            self.choose(hit.key)
        else:
            at = self._clicked(hit, skin=self.tool is not Tool.WINCH)
            add = {Tool.PIN: add_pin, Tool.MARKER: add_marker, Tool.WINCH: add_winch}[self.tool]
            self._add(add, at)

    def key(self, name: str) -> bool:
        """Heed delete, escape, enter, and a letter for each tool."""
        if name == "delete":
            if self.draft is not None:
                self.draft = self.draft.shorter()
                self._ring()
            else:
                self.delete()
        elif name == "escape":
            if self.draft is not None and len(self.draft.points) > 1:
                self.finish()
            else:
                self.cancel()
        elif name == "enter" and self.draft is not None:
            self.finish()
        elif name in KEYS:
            self.take(KEYS[name])
        else:
            return False
        return True

    def step(self, now: float) -> bool:
        """Look the robot over once it has rested."""
        work, judge = self._document.work, self._document.judge
        judge.look(work.robot, work.wishes, now, held=self._hold is not None)
        if self.findings is None and judge.of(work.robot, work.wishes) is not None:
            self._counted = (work.robot, look_over(work.robot))
            self._document.bell.ring(Topic.JOB)
        return False

    def _lay(self, hit: Hit) -> None:
        """One more point of the cable that is being laid."""
        robot, at = self._document.robot, self._clicked(hit, skin=False)
        if self.draft is None:
            self.draft = begin_cable(robot, at, hit.key)
            self._chosen = ""
        elif np.linalg.norm(np.subtract(at, self.draft.points[-1])) <= SAME_CLICK * robot.body.mesh.size:
            if len(self.draft.points) > 1:
                self.finish()
        else:
            self.draft = self.draft.through(at)
        self._ring()

    def _clicked(self, hit: Hit, *, skin: bool) -> Point:
        """The place in the body that a click means."""
        robot = self._document.robot
        if hit.rest is None:
            raise InputError(f"click on the body to place a {self.tool}")
        at = inside(robot.body, hit.rest) if skin else below_skin(robot.body, hit.rest, self.depth)
        return self.mirror.on_plane(at) if self.mirror is not None and self.mirror.near(robot, at) else at

    def _add(self, add: Callable[[Robot, Point], Robot], at: Point) -> None:
        """Place a new part, and its twin."""
        robot = add(self._document.robot, at)
        parts = {
            Tool.PIN: f"pin:{len(robot.pins) - 1}",
            Tool.MARKER: f"marker:{robot.markers[-1].name}" if robot.markers else "",
            Tool.WINCH: f"winch:{robot.winches[-1].name}" if robot.winches else "",
        }
        key = parts[self.tool]
        if self.mirror is not None and not self.mirror.holds(robot, key):
            robot = add(robot, self.mirror.point(at))
        self._change(f"add {self.tool}", robot)
        self.choose(key)

    def _both(self, robot: Robot, key: str) -> Collection[str]:
        """A part and its twin."""
        twin = self.mirror.twin(robot, key) if self.mirror is not None else None
        return (key,) if twin is None else (key, twin)

    def _change(self, label: str, robot: Robot, renamed: dict[str, str] | None = None) -> None:
        timeline, wishes = followed(self._document.work, robot, renamed)
        self._refused = ""
        self._document.change(label, robot=robot, timeline=timeline, wishes=wishes)

    def _ring(self) -> None:
        self._document.bell.ring(Topic.THINGS)
