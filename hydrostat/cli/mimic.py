"""`hydrostat mimic`."""

import select
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.design_results import kit_motor
from hydrostat.cli.folders import OutFolder, RobotFolder, folder_of, require_folder
from hydrostat.cli.options import MotorPort
from hydrostat.cli.waiting import one_interrupt, prepare_physics, read_robot
from hydrostat.errors import HydrostatError, InputError

if TYPE_CHECKING:
    from hydrostat.arrays import Vector
    from hydrostat.simulation import Simulation
    from hydrostat.teleop import HandSource, HeldStill, LessonPoses

PAIRS, MAP, RECORDING, PICTURE = "poses.csv", "map.json", "poses.mcap", "pose.png"
TIPS = 150  # poses to choose from where each has to be solved first


def mimic(
    robot: RobotFolder,
    glove: Annotated[
        str,
        typer.Option(
            metavar="PORT", help="Hand input: serial port of a glove, camera:FILE.task, camera:PORT or emulated."
        ),
    ],
    out: OutFolder,
    poses: Annotated[
        int, typer.Option("--count", metavar="N", help="Total number of poses, including earlier ones in DIR.")
    ] = 60,
    worn: Annotated[bool, typer.Option("--worn", help="Record without prompts: the robot wears the glove.")] = False,
    markers: Annotated[bool, typer.Option("--markers", help="Learn marker positions instead of contractions.")] = False,
    port: MotorPort = None,
) -> None:
    """Teach a hand-to-robot map with a glove or camera.

    The robot shows a pose and you copy it. Hold each pose still and press Enter. The command averages 0.3 s of readings
    and shows the most informative next pose. After each pose it prints the cross-validation error and saves the pairs
    in DIR. Run the command again to add poses. With --worn the robot wears the glove, and you need not press Enter.

    Without --motors the motors are simulated, and DIR/pose.png shows each pose.

    Example: hydrostat mimic examples/cupping_hand --glove emulated --count 30 --out build/glove
    """
    from hydrostat import control, teleop

    if port is not None:
        control.check_port(port)
    if poses < 4:
        raise InputError(f"--count {poses}: must be at least 4")
    require_folder(out)
    loaded = read_robot(robot)
    wearer = teleop.EmulatedHand(teleop.WinchMapper.list_channels(loaded))
    wearer.waves, emulated = False, glove == teleop.EMULATED
    hand = teleop.open_hand(glove, wearer)
    try:
        simulation = prepare_physics(loaded)
        lesson = _lesson(simulation, hand, out, markers=markers)
        show = wearer.person.mimic if emulated else lambda _: None
        with (
            one_interrupt(""),  # arming turns motors, too
            _Session(folder_of(robot), simulation, port, hand) as session,
        ):
            session.say(lesson.summary())
            while lesson.count < poses:
                contractions = lesson.next_pose()
                session.go(contractions, out, drawn=port is None and not emulated and not worn)
                show(session.motors.places)
                held = session.take(lesson.count, asks=not (worn or emulated))
                if held is None:
                    break
                lesson.take(held, _markers(simulation, session.motors.places) if markers else session.motors.places)
                lesson.made.save(out / PAIRS)
                session.say(lesson.summary())
    except (KeyboardInterrupt, SystemExit):
        print(f"interrupted; poses so far are in {out / PAIRS}", flush=True)
        raise typer.Exit(130) from None
    finally:
        hand.close()
    _done(lesson, loaded.name, out, glove, markers=markers)


def _lesson(simulation: "Simulation", hand: "HandSource", out: Path, *, markers: bool) -> "LessonPoses":
    """A lesson that goes on where that of the folder ended, if there is one."""
    import numpy as np

    from hydrostat import teleop

    channels = teleop.WinchMapper.list_channels(simulation.robot)
    answers = pool = teleop.LessonPoses.pool(channels)
    names = channels.names
    if markers:
        names = teleop.MarkerMapper.list_channels(simulation).names
        pool = pool[:: len(pool) // TIPS]
        print("solving candidate poses ...", flush=True)
        answers = np.array([_markers(simulation, contractions) for contractions in pool])
        pool, answers = pool[np.isfinite(answers).all(1)], answers[np.isfinite(answers).all(1)]
    made = teleop.Mimicry(hand.names, names)
    if (out / PAIRS).exists():
        made = teleop.Mimicry.open(out / PAIRS)
        if (made.sensors, made.outputs) != (hand.names, names):
            raise InputError(f"{out / PAIRS}: recorded with another hand, robot or --markers. Give another --out.")
    out.mkdir(parents=True, exist_ok=True)
    return teleop.LessonPoses(made, pool, answers)


def _markers(simulation: "Simulation", contractions: "Vector") -> "Vector":
    """Coordinates of the markers at contractions [m]; NaN where there is no equilibrium."""
    import numpy as np

    pose = simulation.solve(contractions, strict=False)
    markers = np.concatenate([np.asarray(place) for place in pose.markers.values()])
    return markers if pose.result.converged else np.full_like(markers, np.nan)


class _Session:
    """Motors that show poses, and a person who mimics them."""

    def __init__(self, folder: Path, simulation: "Simulation", port: str | None, hand: "HandSource") -> None:
        from hydrostat import control, teleop

        robot, self._simulation, self._hand = simulation.robot, simulation, hand
        self.kind = "simulated" if port is None else port.partition(":")[0]
        rest = teleop.WinchMapper.list_channels(robot).rest
        self._way = teleop.WinchMapper(simulation, rest, solves=port is not None)
        try:
            self.motors = control.Motors(robot.winches, control.SimulatedLink(rest))
            if port is not None:
                known = self._way.known
                self.motors = control.arm_motors(
                    folder, robot, port, known.nearest, known=known, motor=kit_motor(robot, folder), log=print
                )
        except BaseException:
            self._way.close()
            raise

    def __enter__(self) -> "_Session":
        return self

    def __exit__(self, *_: object) -> None:
        self.motors.link.close()
        self._way.close()

    def say(self, words: str) -> None:
        """Print a line."""
        print(f"{self.kind}: {words}", flush=True)

    def beat(self) -> None:
        """Keep the motors' watchdog alive."""
        self.motors.drive(self.motors.clock())
        self._way.observe(self.motors.places)

    def go(self, contractions: "Vector", out: Path, *, drawn: bool) -> None:
        """Take a pose, and draw it if nobody could see it otherwise."""
        from hydrostat import teleop

        teleop.go_there(self.motors, contractions, self.beat)
        if drawn:
            self.motors.hold()
            self._simulation.solve(self.motors.places, strict=False).plot().savefig(out / PICTURE, dpi=80)

    def take(self, number: int, *, asks: bool) -> "HeldStill | None":
        """The readings of a hold; None when the person ends."""
        from hydrostat import teleop

        while True:
            if asks and self._key(number) == "q":
                return None
            try:
                held = teleop.HeldStill.wait(self._hand, self.beat)
            except HydrostatError as error:
                if not asks:
                    raise
                self.say(f"{error}. Try again")
                continue
            if held.still:
                return held
            self.say(f"hand moved by {held.spread:.3f} of the sensor range. Hold still and try again")
            if not asks:
                self.beat()

    def _key(self, number: int) -> str:
        """Return the key that the person types; motors are commanded to hold meanwhile."""
        self.say(f"pose {number + 1}: copy it, hold still, press Enter (q: quit)")
        tick = 1 / 60  # motors are told again after so long [s]
        while not select.select([sys.stdin], [], [], 0.0)[0]:
            self.beat()
            time.sleep(tick)
        line = sys.stdin.readline()
        return "q" if not line else line.strip().lower()


def _done(lesson: "LessonPoses", robot: str, out: Path, glove: str, *, markers: bool) -> None:
    """Write what was learned."""
    from hydrostat import teleop

    made = lesson.made
    if lesson.count < 4:
        print(f"too few poses for a map ({lesson.count}, minimum 4). They are saved in {out / PAIRS}")
        return
    ridge = made.learn()
    error = made.errors(ridge)[0]
    known = teleop.HandMap(
        robot=robot, sensors=made.sensors, outputs=made.outputs, ridge=ridge, poses=lesson.count, error=error
    )
    known.save(out / MAP)
    written = [PAIRS, MAP]
    try:
        written.append(made.write_mcap(out / RECORDING).name)
    except HydrostatError as none:
        print(f"note: {none}")
    print(f"Wrote {', '.join(written)} in {out}")
    source = glove if glove.startswith("camera:") else f"glove:{glove}"
    print(f"Drive with it: hydrostat drive ROBOT --source {source} --map {out / MAP}{' --markers' if markers else ''}")
