"""`hydrostat train`."""

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from hydrostat.cli.folders import RobotFolder, require_folder
from hydrostat.cli.waiting import one_interrupt, read_robot, told
from hydrostat.errors import HydrostatError, InputError

if TYPE_CHECKING:
    from hydrostat.robot import Obstacle, Robot
    from hydrostat.training import CurvePoint, ReachEnv


def train(
    robot: RobotFolder,
    out: Annotated[Path, typer.Option(metavar="DIR", help="For curves, checkpoints and the policy.")],
    task: Annotated[
        str, typer.Option(metavar="NAME", help="reach, reach-with-hysteresis, push, twist or walk.")
    ] = "reach",
    method: Annotated[str, typer.Option(metavar="NAME", help="sac-her, td3-her, ddpg-her or tqc-her.")] = "sac-her",
    steps: Annotated[int, typer.Option(metavar="N", help="Actions to learn from.")] = 10_000,
    horizon: Annotated[int | None, typer.Option(metavar="T", help="Actions in an episode; 1 to reach.")] = None,
    model: Annotated[
        Path | None, typer.Option(metavar="MODEL", help="Learn in the networks that hydrostat learn wrote.")
    ] = None,
    exact: Annotated[int, typer.Option(metavar="N", help="With --model: every Nth episode exact; 0: none.")] = 0,
    tolerance: Annotated[
        str | None,
        typer.Option(metavar="LENGTH", help="Distance that is a success; 5 mm to reach or push, 20 to walk."),
    ] = None,
    friction: Annotated[
        float | None, typer.Option(metavar="MU", help="Of cables that rub, 0.2; of ground, 0.6; of a thing, 0.8.")
    ] = None,
    actions: Annotated[
        str | None, typer.Option(metavar="NAME", help="To walk, what an action is: gait or contractions.")
    ] = None,
    sparse: Annotated[bool, typer.Option("--sparse", help="Reward 0 for success and -1, no distance.")] = False,
    incremental: Annotated[bool, typer.Option("--incremental", help="Actions add to what was taken in.")] = False,
    marker: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="That shall reach; all if not given.")
    ] = None,
    pair: Annotated[
        list[str] | None, typer.Option(metavar="ONE,OTHER", help="Winches of one number: the one, or the other.")
    ] = None,
    thing: Annotated[
        str | None, typer.Option("--object", metavar="SHAPE:SIZES", help="To push or twist; else the robot's own.")
    ] = None,
    at: Annotated[str | None, typer.Option(metavar="X,Y,Z", help="Middle of the --object [mm]; 0 if left out.")] = None,
    mass: Annotated[str, typer.Option(metavar="MASS", help="Of the --object.")] = "58 g",
    tied: Annotated[
        list[str] | None, typer.Option(metavar="PART", help="Winches with this in their names are moved by one number.")
    ] = None,
    goals: Annotated[int, typer.Option(metavar="N", help="Unseen goals that policies are judged by.")] = 100,
    seed: Annotated[int, typer.Option(help="Of all that is drawn at random.")] = 0,
    contact: Annotated[bool, typer.Option("--contact", help="The body feels itself.")] = False,
    together: Annotated[int, typer.Option(metavar="N", help="Episodes side by side.")] = 4,
    processes: Annotated[int, typer.Option(metavar="N", help="That share them; the curve is the same.")] = 1,
    watch: Annotated[bool, typer.Option("--watch", help="Show in the browser how policies are judged.")] = False,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the checkpoint in DIR.")] = False,
) -> None:
    """Learn by trial and error (reinforcement learning), such as to bring the markers of a robot to goals.

    Without --model every action is an equilibrium of the simulator. Policies are always judged by the simulator itself,
    on goals that they have not seen. curve.json and curve.png show how it went, and TensorBoard, where it is installed,
    reads DIR/tensorboard. Episodes go on side by side, and --processes share them. Needs the extra rl. For a body
    that stands still, inverse kinematics and `hydrostat learn` are better and cheaper; this is for comparison, and for
    tasks that have no other way.

    With --task reach-with-hysteresis cables rub, and the way counts; --model is then of the robot without friction, so
    that what is learned from is wrong. With --task walk the robot stands on the ground, without its pins, and goes a
    way in time; an action is half a second of a gait, or contractions for a tenth of a second. With --task push or
    twist a thing with a mass is moved by keyframes, in time: an [[obstacle]] of the robot, or the --object.

    Example: hydrostat train examples/cupping_hand --contact --steps 2000 --out build/policy

    Example: hydrostat train examples/starfish --horizon 5 --incremental --marker top --pair left,right --out build/top

    Example: hydrostat train examples/letter_s --task reach-with-hysteresis --friction 0.3 --steps 400 --out build/rubs

    Example: hydrostat train examples/puppy --task walk --steps 400 --goals 4 --out build/walk

    Example: hydrostat train examples/puppy --task push --object sphere:30mm --at -90,60 --steps 400 --out build/push
    """
    try:
        from hydrostat import training
    except ModuleNotFoundError as error:
        raise HydrostatError(f'training needs {error.name}; install it: pip install "hydrostat[rl]"') from None
    from hydrostat.learning import load_model, save_model
    from hydrostat.simulation import write_profile
    from hydrostat.units import LENGTH, parse_quantity, plural

    require_folder(out)
    methods = [str(each) for each in training.TrainMethod]
    if method not in methods:
        raise InputError(f"--method {method}: there are: {', '.join(methods)}")
    if exact and model is None:
        raise InputError("--exact is for networks, with --model; without, every episode is exact")
    if at and not thing:
        raise InputError("--at is for an --object; a thing of the robot's own is where robot.toml has it")
    made, loaded = training.task_of(task).env, read_robot(robot)
    asked = training.TaskOptions(
        markers=marker or (),
        pairs=tuple([name.strip() for name in one.split(",")] for one in pair or ()),
        steps=horizon,
        incremental=incremental,
        tolerance=None if tolerance is None else parse_quantity(tolerance, LENGTH),
        shaped=not sparse,
        contact=contact,
        friction=friction,
        actions=actions,
        tied=tied or (),
        thing=None if thing is None else _thing(loaded, thing, at, mass, friction),
    )
    env, judged = (made.for_task(loaded, asked) for _ in range(2))
    if watch:
        judged.render_mode = "human"
        print(f"Policies are shown at {judged.page.address} while they are judged", flush=True)
    networks = None if model is None else load_model(model)
    if networks is not None:
        env.learn_in(networks, exact=exact)
    options = training.TrainOptions(
        method=training.TrainMethod(method), steps=steps, seed=seed, every=max(1, steps // 10), together=together
    )
    training.begun_curve(out, options, resume=resume)
    progress, began = told(), time.process_time()
    wanted = training.held_out_goals(judged, goals, seed, progress=progress)
    size, (word, factor) = judged.unit, judged.measure
    _row(f"    actions{judged.cost:>12}  mean     median   worst    within  CPU")

    def tell(point: "CurvePoint") -> None:
        _row(f"{_line(point, word, factor)}   {time.process_time() - began:.0f} s")

    with one_interrupt("stopping; --resume goes on from the last row above, if there is one"):
        more = {"resume": resume, "processes": processes}
        listener = training.Listener(point=tell, progress=progress)
        trained, curve = training.train(env, wanted, options, out, judge_in=judged, listener=listener, **more)
    last = curve[-1]
    share = f", {100 * last.mean / size:.2f} % of the size" if word == "mm" else ""
    print(f"{factor * last.mean:.2f} {word}{share}, on {plural(goals, 'unseen goal')}")
    print(f"Wrote {_picture(curve, method, out, word, factor)}")
    policy = training.policy_of(trained, env, task=task, error=last.mean)
    print(f"Wrote {policy.save(out / 'actor.policy')}, which runs without PyTorch")
    moves = training.moves_of(judged, policy.act, wanted[0])
    write_profile(out / "moves.csv", judged.robot, moves)
    print(f"Wrote {out / 'moves.csv'}, what it does for the first of them; motors play it by hydrostat play")
    if networks is not None and env.portable:
        learned = training.portable_policy(trained, cast("ReachEnv", env), networks)
        print(f"Wrote {save_model(learned, out / 'policy.model')}")


def _thing(robot: "Robot", text: str, at: str | None, mass: str, friction: float | None) -> "Obstacle":
    """What is pushed or turned, in its place."""
    from hydrostat.cli.options import middle, positive
    from hydrostat.grasp import moved_thing, read_thing
    from hydrostat.units import MASS

    dim = robot.body.mesh.dim
    thing = read_thing(text, dim, mass=positive("--mass", mass, MASS), friction=0.8 if friction is None else friction)
    return thing if at is None else moved_thing(thing, middle(at, dim))


def _row(text: str) -> None:
    """Print a row, over the words of progress that a terminal shows."""
    print(f"{chr(13)}{text:<70}" if sys.stderr.isatty() else text, flush=True)


def _line(point: "CurvePoint", word: str, factor: float) -> str:
    """How good a policy was, in numbers."""
    lengths = "  ".join(f"{factor * value:4.2f} {word}" for value in (point.mean, point.median, point.worst))
    return f"{point.steps:11}{point.equilibria:12}  {lengths}  {100 * point.success:3.0f} %"


def _picture(curve: "list[CurvePoint]", name: str, out: Path, word: str, factor: float) -> Path:
    """Distances and successes over the actions, as PNG."""
    import numpy as np

    from hydrostat.plot import draw_curves, save_png

    steps = np.array([point.steps for point in curve])
    distances = np.array([[factor * point.mean] for point in curve])
    successes = np.array([[point.success] for point in curve])
    panes = {f"mean distance [{word}]": {name: (steps, distances)}, "share of successes": {name: (steps, successes)}}
    return save_png(draw_curves(panes), out / "curve.png")
