"""`Driver`: the stage "drive"."""

from collections.abc import Callable, Sequence
from math import inf, isfinite

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control import Link, Motors, SimulatedLink, Timeline
from hydrostat.errors import InputError
from hydrostat.ik import solve_ik
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.driving.film import Recorder
from hydrostat.studio.driving.keyframes import Keyframes
from hydrostat.studio.driving.machine import Machine
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.stage import Hit, Stage, format_error
from hydrostat.studio.view.contact_items import contact_items
from hydrostat.studio.view.robot_items import robot_items
from hydrostat.studio.view.scene_items import RobotShape, SceneItem


class Driver(Stage):
    """Contractions by hand and in time (R58): knobs or keyframes command a link, and the body follows its motors."""

    def __init__(self, document: Document, jobs: Jobs, *, connect: Callable[[Vector], Link] = SimulatedLink) -> None:
        """A stage for a document; `connect` makes the link to motors whose winches have taken in so much [m]."""
        self.keyframes, self.recorder = Keyframes(document), Recorder(document, jobs)
        self._document = document
        self._machine = Machine(document, self.keyframes, connect)
        self._lock = self._machine.lock
        self.player = self._machine.player
        self._pull: tuple[str, float, Hit] | None = None

    def shape(self) -> RobotShape:
        """The body as the motors pull it."""
        return self._machine.shape()

    def scene_items(self) -> Sequence[SceneItem]:
        """All parts of the robot, the winch that is pulled marked."""
        chosen = () if self._pull is None else (f"winch:{self._pull[0]}",)
        robot, shape = self._document.robot, self.shape()
        options = {"scale": self.strongest, "carried": shape.carried}
        items = robot_items(robot, tensions=shape.tensions, chosen=chosen, **options)
        return items + contact_items(shape, robot.body.mesh.size)

    @property
    def motors(self) -> Motors:
        """The motors of the winches; others when the robot is another one."""
        return self._machine.motors

    @property
    def kit(self) -> str:
        """Name of the kit's motor, whose speed the motors have at first; "" without winches."""
        return self._machine.kit

    @property
    def strongest(self) -> float:
        """Maximum cable tension [N]."""
        return self._machine.strongest

    def commands(self) -> dict[str, float]:
        """Commanded contractions [m], by winch."""
        with self._lock:
            self._machine.meet()
            return dict(zip(self.motors.names, self.motors.command.tolist(), strict=True))

    def places(self) -> dict[str, float]:
        """Contractions that the winches have [m], by name."""
        with self._lock:
            self._machine.meet()
            return dict(zip(self.motors.names, self.motors.places.tolist(), strict=True))

    def tensions(self) -> dict[str, float]:
        """The largest tension of the cables of each winch [N], by name."""
        robot, shape = self._document.robot, self.shape()
        most = dict.fromkeys((winch.name for winch in robot.winches), 0.0)
        for cable, tension in zip(robot.cables, shape.tensions.tolist(), strict=True):
            most[cable.winch] = max(most[cable.winch], tension)
        return most

    def turn(self, name: str, contraction: float) -> None:
        """Set the contraction of a winch [m], within limits; the selected key follows (InputError: no such winch)."""
        if not isfinite(contraction):
            raise InputError(f"{name}: the contraction must be a number")
        with self._lock:
            robot = self._document.robot
            self._machine.meet(robot)
            robot.winch(name)
            self._machine.halt()
            self.motors.turn(name, contraction)
            self.keyframes.adjust(self.commands())
            self._machine.update_keys()
        self._tell()

    def let_go(self) -> None:
        """The knob is let go: the next turn is a change of its own."""
        self._document.seal()

    def rest(self) -> None:
        """Let all cable out that was taken in; stops playing. No key changes by it."""
        with self._lock:
            self._machine.meet()
            self._machine.halt()
            self.keyframes.choose(None)
            self.motors.ask(np.zeros(len(self.motors.names)))
        self._tell()

    def grab(self, hit: Hit) -> bool:
        """Take hold of a winch, to pull cable out of it downwards."""
        name = hit.key.removeprefix("winch:")
        if name == hit.key or name not in self.commands():
            return False
        self._pull = (name, self.commands()[name], hit)
        return True

    def drag(self, hit: Hit) -> None:
        """Down takes in, up lets out, millimeter by millimeter."""
        if self._pull is not None:
            name, begun, start = self._pull
            self.turn(name, begun + start.world[-1] - hit.world[-1])

    def release(self) -> None:
        """The winch is let go."""
        self._pull = None
        self.let_go()

    def key(self, name: str) -> bool:
        """Space plays or stops, r rests, delete removes the selected key, escape selects none."""
        actions = {"space": self.toggle, "r": self.rest, "delete": self.delete_key, "escape": self.choose_none}
        if name not in actions or not self._document.robot.cables:
            return False
        actions[name]()
        return True

    def toggle(self) -> None:
        """Play, or stop playing (InputError: there is nothing to play)."""
        if self.player.playing:
            self.stop()
        else:
            self.play()

    def play(self) -> None:
        """Play from the playhead, or from the start if that is at the end (InputError: there is nothing to play)."""
        timeline = self.keyframes.timeline
        if not timeline.keys:
            raise InputError("no keyframes yet. Turn the knobs and press Add")
        with self._lock:
            self._machine.meet()
            self._machine.notice = ""
            self.keyframes.choose(None)
            self.player.play(timeline.seconds)
        self._tell()

    def stop(self) -> None:
        """Stop where it is."""
        with self._lock:
            self._machine.halt()
        self._tell()

    def seek(self, time: float) -> None:
        """Put the playhead to a time [s]; the winches go where the keyframes say (InputError: it is no number)."""
        if not isfinite(time):
            raise InputError("the playhead must be at a number of seconds")
        with self._lock:
            self._machine.meet()
            self._machine.notice = ""
            self.keyframes.choose(None)
            self._machine.seek(time)
        self._tell()

    def set_loop(self, loop: bool) -> None:
        """Let playing begin again at the end, or stop there."""
        self.player.rounds = inf if loop else 1
        self._tell()

    def set_speed(self, speed: float) -> None:
        """Play at a multiple of the timeline's speed (InputError: it is out of range)."""
        self.player.set_speed(speed)
        self._tell()

    def choose(self, index: int) -> None:
        """Select a key, and show it (InputError: there is no such key)."""
        with self._lock:
            self._machine.meet()
            self.keyframes.choose(index)
            self._machine.halt()
            self._machine.seek(self.keyframes.timeline.keys[index].time)
        self._tell()

    def choose_none(self) -> None:
        """Select no key; stops playing."""
        with self._lock:
            self._machine.halt()
            self.keyframes.choose(None)
        self._tell()

    def add_key(self) -> None:
        """Keep the knobs as they are now as a key at the playhead."""
        with self._lock:
            commands = self.commands()
            if not commands:
                raise InputError("this robot has no winches. Press Design to find some")
            self._machine.halt()
            self.keyframes.add_key(self.player.time, commands)
            self._machine.update_keys()
        self._tell()

    def key_from_pose(self, name: str) -> str:
        """Add a key at the playhead that comes nearest to a stored pose; takes a while. How near, in a sentence.

        Raises:
            InputError: there is no such pose, or it cannot be reached for.
            NotConvergedError: the robot has no equilibrium to begin at.
        """
        simulation = self._document.simulation
        robot = simulation.robot
        found = solve_ik(simulation, robot.pose(name))
        if self._document.robot is not robot:
            raise InputError("the robot changed meanwhile. Try again")
        with self._lock:
            self._machine.meet(robot)
            self._machine.halt()
            self.motors.ask(found.pose.contractions)
            self.add_key()
        return f"{name}: marker error {format_error(found.rms_error)} rms"

    def move_key(self, index: int, time: float) -> None:
        """Drag a key to a time [s]; ends with `drop_key` (InputError: there is no such key)."""
        with self._lock:
            self._machine.halt()
            self._machine.seek(self.keyframes.move(index, time))
        self._tell()

    def drop_key(self) -> None:
        """The key is let go."""
        self.keyframes.drop()

    def duplicate_key(self) -> None:
        """Copy the selected key (InputError: none is selected, or there is no room)."""
        with self._lock:
            self._machine.halt()
            self._machine.seek(self.keyframes.duplicate())
        self._tell()

    def delete_key(self) -> None:
        """Remove the selected key (InputError: none is selected)."""
        with self._lock:
            self.keyframes.delete()
            self._machine.update_keys()
        self._tell()

    def table(self) -> bytes:
        """The timeline as a CSV; see `Timeline.table`."""
        return self.keyframes.timeline.table(self._document.robot)

    def load_table(self, name: str, content: bytes) -> None:
        """Put a CSV in place of the timeline; see `Timeline.read`."""
        timeline = Timeline.read(self._document.robot, name, content)
        with self._lock:
            self._machine.halt()
            self.keyframes.replace_all(timeline, f"import {name}")
            self._machine.seek(0.0)
        self._tell()

    def enter(self) -> None:
        """The robot may be another one."""
        self._tell()

    def leave(self) -> None:
        """Motors stop, and all is let go."""
        with self._lock:
            self._machine.halt()
            self._pull = None
            self.motors.hold()
            self.keyframes.drop()
            self.keyframes.choose(None)

    def step(self, now: float) -> bool:
        """Command the motors, see where they are, and let the body follow; whether there is more to do.

        Whatever goes wrong, a HydrostatError of the link or of the physics, the motors hold and nothing plays any more.
        """
        if not self._document.robot.cables:
            return False
        if not self._machine.due(now):
            return True
        try:
            changed = self._machine.run(now)
        except Exception as error:
            if self._machine.fail(error):  # told once, though it may be tried again and again
                self._tell()
            raise
        if changed:
            self._tell()
        return self._machine.busy

    def _tell(self) -> None:
        self._document.bell.ring(Topic.DRIVE, Topic.SHAPE)
