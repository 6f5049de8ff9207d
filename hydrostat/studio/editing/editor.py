"""`Editor`: the stage "edit"."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from hydrostat.closed_set import parse_choice
from hydrostat.design import Zone
from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.robot import Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.editing.cable_draft import CableDraft, begin_cable, end_cable, overlay
from hydrostat.studio.editing.change import change, remesh, rename, set_contact, set_gravity
from hydrostat.studio.editing.copies import paste_parts, shift_parts
from hydrostat.studio.editing.cross_hair import CrossHair
from hydrostat.studio.editing.hold import Hold, find_place, take_hold
from hydrostat.studio.editing.part import Mirror, find_part, keys_of, name_of, place_of, title_of
from hydrostat.studio.editing.part_brush import PartBrush, add_body_part
from hydrostat.studio.editing.place import add_marker, add_pin, add_winch, move, remove
from hydrostat.studio.editing.tools import KEYS, Findings, Ruler, Tool, lay_ruler, look_over
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.stage import SAME_CLICK, Hit, Stage, parse_arrow
from hydrostat.studio.view.robot_items import diagnostic_items, robot_items
from hydrostat.studio.view.scene_items import RobotShape, SceneItem, rest_shape
from hydrostat.units import plural


class Editor(Stage):
    """The body at rest, and tools to place, move, change and delete what is in it."""

    def __init__(self, document: Document, jobs: Jobs) -> None:
        self._document, self._jobs = document, jobs
        self.tool = Tool.MOVE  # what the pointer does
        self.mirror: Mirror | None = None  # both sides are edited alike about this plane; None: no mirror
        self.depth = 0.005  # how deep below the skin of a body in space winches and cables are placed [m]
        self.draft: CableDraft | None = None  # the cable that is being laid
        self.snap = 0.0  # places of parts are multiples of it [m]; 0: of a tenth of a millimeter
        self.ruler: Ruler | None = None  # laid with its tool; None: it is not
        self.several = False  # whether a press adds to what is selected, as with Shift: fingers have none
        self.brush = PartBrush(document)  # paints regions of another material
        self.cross_hair = CrossHair(document)  # where Enter uses the tool
        self._chosen: tuple[str, ...] = ()
        self._copied: tuple[Robot, tuple[str, ...]] | None = None
        self._hold: Hold | None = None
        self._holds = 0
        self._refused = ""
        self._counted: tuple[Robot, Findings] | None = None

    @property
    def selected_key(self) -> str:
        """Key of the part that was selected last; "" for none."""
        return next(reversed(self.selection), "")

    @property
    def selection(self) -> tuple[str, ...]:
        """Keys of all parts that are selected, in the order in which they were."""
        if not self._document.is_open:
            return ()
        return tuple(key for key in self._chosen if find_part(self._document.robot, key) is not None)

    @property
    def findings(self) -> Findings | None:
        """Counts of the robot as it is; None until it has rested."""
        counted = self._counted
        return counted[1] if counted is not None and counted[0] is self._document.robot else None

    def shape(self) -> RobotShape:
        """The rest shape."""
        shape = rest_shape(self._document.robot)
        return replace(shape, notes=(self._refused,)) if self._refused else shape

    def scene_items(self) -> Sequence[SceneItem]:
        """All parts of the robot, the cable that is being laid, and the plane of the mirror."""
        robot = self._document.robot
        chosen = {key for own in self.selection for key in self._both(robot, own)}
        judge = self._document.judge
        flags = diagnostic_items(robot, judge.of(robot, self._document.work.wishes) or (), judge.chosen)
        ruler = [] if self.ruler is None else self.ruler.scene_items()
        parts = robot_items(robot, vias=True, chosen=chosen)
        regions = self.brush.scene_items(chosen, pickable=self.tool is Tool.MOVE)
        laid = overlay(robot, self.draft, self.mirror)
        return [*regions, *parts, *flags, *laid, *ruler, *self.cross_hair.scene_items()]

    def leave(self) -> None:
        """Drop what was begun: another stage is shown."""
        self.draft, self.ruler, self._hold, self._refused = None, None, None, ""
        self.brush.drawn.clear()
        self.cross_hair.hide()

    def choose(self, key: str, *, also: bool = False) -> None:
        """Select a part, "" for none; with `also` beside what is selected, or no longer if it is."""
        if not also:
            self._chosen = (key,) if key else ()
        elif key:
            rest = tuple(own for own in self.selection if own != key)
            self._chosen = rest if key in self.selection else (*rest, key)
        self._ring()

    def choose_several(self, on: bool) -> None:
        """Let each press add to what is selected, or take out of it."""
        self.several = on
        self._ring()

    def choose_all(self) -> None:
        """Select all parts."""
        self._chosen = tuple(keys_of(self._document.robot))
        self._ring()

    def copy(self) -> None:
        """Remember what is selected, to be pasted."""
        if self.selection:
            self._copied = (self._document.robot, self.selection)

    def paste(self) -> None:
        """Put in what was copied once more, beside it, and select that (InputError: nothing was copied, or no room)."""
        if self._copied is None:
            raise InputError("nothing copied. Select parts and press Ctrl C")
        self._copied = self._paste(*self._copied)

    def duplicate(self) -> None:
        """Copy what is selected, and paste it (InputError: there is no room beside it)."""
        if self.selection:
            self._paste(self._document.robot, self.selection)

    def _paste(self, source: Robot, keys: tuple[str, ...]) -> tuple[Robot, tuple[str, ...]]:
        """Put in parts of a robot once more, and select them."""
        robot, self._chosen = paste_parts(self._document.robot, source, keys)
        self._change(f"paste {plural(len(self._chosen), 'part')}", robot)
        return robot, self._chosen

    def nudge(self, step: float, axis: int) -> None:
        """Move what is selected by a step [m] along an axis (InputError: it would lie outside)."""
        if self.selection:
            way = np.zeros(self._document.robot.body.mesh.dim)
            way[axis] = step
            robot = shift_parts(self._document.robot, self.selection, way.tolist(), self.mirror)
            words = title_of(self.selected_key) if len(self.selection) == 1 else plural(len(self.selection), "part")
            self._document.change(f"nudge {words}", robot=robot, merge=f"nudge {' '.join(self.selection)}")

    def set_snap(self, step: float) -> None:
        """Put parts that are placed or dragged at multiples of a step [m]; 0: anywhere (InputError: no step)."""
        if not 0 <= step <= self._document.robot.body.mesh.size:
            raise InputError("snapping must be from 0 mm to the size of the body")
        self.snap = step
        self._ring()

    def take(self, tool: Tool | str) -> None:
        """Take another tool; a cable that was begun is dropped (InputError: there is no tool of this name)."""
        before, self.tool, self.draft, self.ruler = self.tool, parse_choice(Tool, tool, what="tool"), None, None
        self.brush.drawn.clear()
        if self.tool is Tool.MOVE or self.tool is not before:
            self.cross_hair.hide()
        self._ring()

    def mirror_about(self, axis: str) -> None:
        """Edit both sides of the plane where a coordinate is 0 alike; "": no longer (InputError: no such axis)."""
        axes = "xyz"[: self._document.robot.body.mesh.dim]
        if axis not in axes:
            raise InputError(f'unknown axis "{axis}". Available: {", ".join(axes)}')
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
        robot, keys = self._document.robot, self.selection
        if keys:
            words = title_of(keys[0]) if len(keys) == 1 else plural(len(keys), "part")
            gone = {key: None for own in keys for key in self._both(robot, own)}
            self._change(f"delete {words}", remove(robot, list(gone)))
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
                raise InputError(f"{words}: the body changed meanwhile, so nothing was changed. Try again")
            changed = replace(robot, body=body)
            if self._document.robot is robot:
                self._change(f"change {words}", changed)
                return

    def finish(self) -> None:
        """End the cable at its last point (InputError: it has no stopper yet), or close the polygon that is painted."""
        if self.draft is None:
            self._paint(self.brush.drawn.close())
            return
        laid = end_cable(self._document.robot, self.draft, self.mirror)
        self.draft = None
        self._change("add cable", laid)
        self.choose(f"cable:{len(laid.cables) - 1}")

    def cancel(self) -> None:
        """Drop the cable or polygon that was begun; else the selection, and take the first tool."""
        if self.draft is None and not self.brush.drawn.corners:
            self._chosen, self.tool = (), Tool.MOVE
        self.take(self.tool)

    def grab(self, hit: Hit) -> bool:
        """Take hold of a part; of a cable, to draw a new via point out of it."""
        if self.tool is Tool.PART:
            return self.brush.grab(hit)
        robot = self._document.robot
        if self.draft is not None or self.tool is Tool.RULER or find_part(robot, hit.key) is None:
            return False
        if self.tool is Tool.CABLE and not hit.key.startswith("via:"):
            return False  # it is a click that begins a cable
        if hit.key not in self.selection:
            self.choose(hit.key, also=hit.shift or self.several)
        self._hold = take_hold(robot, hit.key, self.mirror, hit.world)
        self._holds += 1
        return True

    def drag(self, hit: Hit) -> None:
        """Move what is held; where it cannot be it stays at the last place where it could."""
        if self._hold is None:
            self.brush.drawn.drag(hit.rest or hit.world)
            return
        try:
            robot, hold = self._hold.drawn_out(self._document.robot)
            moved = self._drag(robot, hold, hold.goal_at(robot, hit.world, self.snap))
        except InputError as error:
            self._refused = str(error)
            return
        many = self._many(hold.key)
        self._chosen = self._chosen if many else (hold.key,)
        self._hold, self._refused = hold, ""
        words = plural(len(self.selection), "part") if many else title_of(hold.key)
        self._document.change(f"move {words}", robot=moved, merge=f"drag {self._holds}")

    def release(self) -> None:
        """Let go."""
        self._hold, self._refused = None, ""
        self._paint(self.brush.drawn.end())

    def click(self, hit: Hit) -> None:
        """Select, place a new part, or lay a cable one point further; a pointer needs no cross-hair."""
        self.cross_hair.hide()
        self._use_tool(hit)

    def _use_tool(self, hit: Hit) -> None:
        if self.tool is Tool.CABLE:
            self._lay(hit)
        elif self.tool is Tool.RULER:
            self.ruler = lay_ruler(self.ruler, place_of(self._document.robot, hit.key) or hit.rest)
            self._ring()
        elif self.tool is Tool.PART:
            self._paint(None if hit.rest is None else self.brush.drawn.click(hit.rest))
        elif self.tool is Tool.MOVE or find_part(self._document.robot, hit.key) is not None:
            key = hit.key if find_part(self._document.robot, hit.key) else ""
            self.choose(key, also=hit.shift or (self.several and bool(key)))
        else:
            at = self._clicked_place(hit, skin=self.tool is not Tool.WINCH)
            self._add({Tool.PIN: add_pin, Tool.MARKER: add_marker, Tool.WINCH: add_winch}[self.tool], at)

    def key(self, name: str) -> bool:
        """Heed delete, escape, enter, arrows, the words of copying, and a letter for each tool."""
        begun = self.draft is not None or bool(self.brush.drawn.corners)
        start = place_of(self._document.robot, self.selected_key)
        if self.cross_hair.press(name, self._use_tool, start, can_show=self.tool is not Tool.MOVE and not begun):
            self._ring()
            return True
        words = {"all": self.choose_all, "copy": self.copy, "paste": self.paste, "duplicate": self.duplicate}
        if name in words:
            words[name]()
        elif (arrow := parse_arrow(name)) is not None:
            self.nudge(*arrow)
        elif name == "delete" and self.draft is not None:
            self.draft = self.draft.shorter()
            self._ring()
        elif name == "delete":
            self.delete()
        elif name == "escape" and (self.draft is None or len(self.draft.points) < 2):
            self.cancel()
        elif name == "escape" or (name == "enter" and begun):
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
        robot, at = self._document.robot, self._clicked_place(hit, skin=False)
        if self.draft is None:
            self.draft = begin_cable(robot, at, hit.key)
            self._chosen = ()
        elif np.linalg.norm(np.subtract(at, self.draft.points[-1])) <= SAME_CLICK * robot.body.mesh.size:
            if len(self.draft.points) > 1:
                self.finish()
        else:
            self.draft = self.draft.through(at)
        self._ring()

    def _many(self, key: str) -> bool:
        """Return True if a part is one of several that are selected."""
        return key in self.selection and len(self.selection) > 1

    def _drag(self, robot: Robot, hold: Hold, at: Point) -> Robot:
        """The robot with what is held at a place, and all that is selected with it moved as far."""
        before = place_of(robot, hold.key)
        if before is None or not self._many(hold.key):
            return move(robot, hold.places(at))
        return shift_parts(robot, self.selection, tuple(np.subtract(at, before).tolist()), self.mirror)

    def _clicked_place(self, hit: Hit, *, skin: bool) -> Point:
        """The place in the body that a click means."""
        robot = self._document.robot
        if hit.rest is None:
            raise InputError(f"no body here. Choose a point of the body to place a {self.tool}")
        at = find_place(robot.body, hit.rest, self.snap, None if skin else self.depth)
        return self.mirror.on_plane(at) if self.mirror is not None and self.mirror.near(robot, at) else at

    def _add(self, add: Callable[[Robot, Point], Robot], at: Point) -> None:
        """Place a new part, and its twin."""
        before = self._document.robot
        robot = add(before, at)
        key = next(key for key in keys_of(robot) if key not in keys_of(before))
        if self.mirror is not None and not self.mirror.holds(robot, key):
            robot = add(robot, self.mirror.point(at))
        self._change(f"add {self.tool}", robot)
        self.choose(key)

    def _paint(self, zone: Zone | None) -> None:
        """Add a region, if one was drawn, and its twin; it is selected, to be looked at."""
        if zone is not None:
            robot = add_body_part(self._document.robot, zone, self.brush.filling, self.mirror)
            self._change("paint region", robot)
            self.take(Tool.MOVE)
            self.choose(keys_of(robot)[-1])

    def _both(self, robot: Robot, key: str) -> Collection[str]:
        """A part and its twin."""
        twin = self.mirror.twin(robot, key) if self.mirror is not None else None
        return (key,) if twin is None else (key, twin)

    def _change(self, label: str, robot: Robot, renamed: dict[str, str] | None = None) -> None:
        timeline, wishes = self._document.work.follow_robot(robot, renamed)
        self._refused = ""
        self._document.change(label, robot=robot, timeline=timeline, wishes=wishes)

    def _ring(self) -> None:
        self._document.bell.ring(Topic.SCENE)
