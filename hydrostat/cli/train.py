"""`hydrostat train`."""

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from hydrostat.cli.folders import RobotFolder, require_folder
from hydrostat.cli.waiting import one_interrupt, read_robot, report_progress
from hydrostat.errors import InputError
from hydrostat.version import install_command

if TYPE_CHECKING:
    from hydrostat.robot import Obstacle, Robot
    from hydrostat.training import CurvePoint, ReachEnv


def train(
    robot: RobotFolder,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Output folder for curves, checkpoints and the policy.")],
    task: Annotated[
        str, typer.Option(metavar="NAME", help="Task: reach, reach-with-hysteresis, push, twist or walk.")
    ] = "reach",
    method: Annotated[
        str, typer.Option(metavar="NAME", help="Algorithm: sac-her, td3-her, ddpg-her or tqc-her.")
    ] = "sac-her",
    steps: Annotated[int, typer.Option(metavar="N", help="Number of training actions.")] = 10_000,
    horizon: Annotated[
        int | None,
        typer.Option(
            metavar="T", help="Actions per episode.", show_default="1 to reach, 4 to push or twist, 10 or 50 to walk"
        ),
    ] = None,
    model: Annotated[
        Path | None,
        typer.Option(metavar="MODEL", help="Train in a model from `hydrostat learn` instead of the simulator."),
    ] = None,
    simulator_every: Annotated[
        int, typer.Option(metavar="N", help="Run every Nth episode in the simulator, with --model. 0 = none.")
    ] = 0,
    tolerance: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Success distance. Fixed for twist.",
            show_default="5 mm to reach or push, 20 mm to walk",
        ),
    ] = None,
    friction: Annotated[
        float | None,
        typer.Option(
            metavar="MU",
            help="Friction coefficient of cables, ground or object.",
            show_default="cables 0.2, ground 0.6, object 0.8",
        ),
    ] = None,
    actions: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Action type for walk: gait or contractions.", show_default="gait"),
    ] = None,
    sparse: Annotated[bool, typer.Option("--sparse", help="Sparse reward: 0 on success, -1 otherwise.")] = False,
    incremental: Annotated[
        bool, typer.Option("--incremental", help="Let actions change the contractions instead of setting them.")
    ] = False,
    marker: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Marker to control. Repeatable.", show_default="all")
    ] = None,
    pair: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ONE,OTHER", help="Antagonistic pair: one action drives ONE or OTHER, never both. Repeatable."
        ),
    ] = None,
    obstacle: Annotated[
        str | None,
        typer.Option(
            "--object",
            metavar="SHAPE:SIZES",
            help="Object to push or twist, e.g. sphere:30mm.",
            show_default="[[obstacle]] of the robot",
        ),
    ] = None,
    at: Annotated[
        str | None, typer.Option(metavar="X,Y,Z", help="Center of the --object [mm].", show_default="0,0,0")
    ] = None,
    mass: Annotated[str, typer.Option(metavar="MASS", help="Mass of the --object.")] = "58 g",
    tied: Annotated[
        list[str] | None,
        typer.Option(metavar="PART", help="Tie all winches whose name contains PART to one action. Repeatable."),
    ] = None,
    goals: Annotated[int, typer.Option(metavar="N", help="Number of unseen goals for evaluation.")] = 100,
    seed: Annotated[int, typer.Option(help="Random seed.")] = 0,
    contact: Annotated[bool, typer.Option("--contact", help="Enable self-contact.")] = False,
    num_envs: Annotated[int, typer.Option(metavar="N", help="Number of parallel environments.")] = 4,
    processes: Annotated[
        int,
        typer.Option(
            metavar="N", help="Number of processes that run the environments. The curve does not depend on it."
        ),
    ] = 1,
    watch: Annotated[bool, typer.Option("--watch", help="Show evaluation episodes in the browser.")] = False,
    resume: Annotated[bool, typer.Option("--resume", help="Resume from the checkpoint in DIR.")] = False,
) -> None:
    """Train a policy by reinforcement learning.

    The policy maximizes the sum of rewards of an episode. Each reward is minus the distance to the goal, in units of
    the tolerance; with --sparse it is 0 on success and -1 otherwise.

    Without --model, each action is one equilibrium of the simulator. Evaluation always runs in the simulator, on unseen
    goals. The learning curve is in curve.json and curve.png, and in DIR/tensorboard if TensorBoard is installed. Needs
    the extra rl. For static poses, inverse kinematics and `hydrostat learn` are better and cheaper. Use this command
    for comparison, and for tasks they cannot solve.

    Task reach-with-hysteresis: cables have friction, and the pose depends on the loading path. A --model for it has no
    friction: a deliberate model error. Task walk: the robot stands on the ground without its pins and walks in a
    dynamic simulation. One action is 0.5 s of a gait, or contractions for 0.1 s. Tasks push and twist: the robot moves
    an object with mass in a dynamic simulation. The object is an [[obstacle]] of the robot, or the --object. Each
    action is a keyframe.

    Example: hydrostat train gallery:cupping_hand --contact --steps 2000 --out build/policy

    Example: hydrostat train gallery:starfish --horizon 5 --incremental --marker top --pair left,right --out build/top

    Example: hydrostat train gallery:letter_s --task reach-with-hysteresis --friction 0.3 --steps 400 --out build/rubs

    Example: hydrostat train gallery:puppy --task walk --steps 400 --goals 4 --out build/walk

    Example: hydrostat train gallery:puppy --task push --object sphere:30mm --at -90,60 --steps 400 --out build/push
    """
    try:
        from hydrostat import training
    except ModuleNotFoundError as error:
        raise InputError(f"train: package {error.name} not found. Install it: {install_command('rl')}") from None
    from hydrostat.learning import LearnedModel
    from hydrostat.units import LENGTH, parse_quantity, plural

    require_folder(out)
    methods = [str(each) for each in training.TrainMethod]
    if method not in methods:
        raise InputError(f"--method {method}: unknown method. Available: {', '.join(methods)}.")
    if simulator_every and model is None:
        raise InputError("--simulator-every: needs --model. Without it every episode runs in the simulator.")
    if at and not obstacle:
        raise InputError("--at: needs --object. Move an [[obstacle]] of the robot in robot.toml.")
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
        obstacle=None if obstacle is None else _read_object(loaded, obstacle, at, mass, friction),
    )
    env, judged = (made.for_task(loaded, asked) for _ in range(2))
    if watch:
        judged.render_mode = "human"
        print(f"Evaluation episodes: {judged.page.address}", flush=True)
    networks = None if model is None else LearnedModel.load(model)
    if networks is not None:
        env.learn_in(networks, exact=simulator_every)
    options = training.TrainOptions(
        method=training.TrainMethod(method),
        steps=steps,
        seed=seed,
        eval_interval=max(1, steps // 10),
        num_envs=num_envs,
    )
    training.begun_curve(out, options, resume=resume)
    progress, began = report_progress(), time.process_time()
    wanted = training.held_out_goals(judged, goals, seed, progress=progress)
    size, (word, factor) = judged.unit, judged.measure
    _row(f"    actions{judged.cost:>12}  mean     median   worst    within  CPU")

    def tell(point: "CurvePoint") -> None:
        _row(f"{_line(point, word, factor)}   {time.process_time() - began:.0f} s")

    with one_interrupt("stopping: --resume continues from the last row above", interrupt=True):
        more = {"resume": resume, "processes": processes}
        listener = training.Listener(point=tell, progress=progress)
        trained, curve = training.train(env, wanted, options, out, judge_in=judged, listener=listener, **more)
    last = curve[-1]
    share = f", {100 * last.mean / size:.2f} % of the body size" if word == "mm" else ""
    print(f"mean distance {factor * last.mean:.2f} {word}{share} ({plural(goals, 'unseen goal')})")
    print(f"Wrote {_picture(curve, method, out, word, factor)}")
    policy = training.policy_of(trained, env, task=task, error=last.mean)
    print(f"Wrote {policy.save(out / 'actor.policy')} (runs without PyTorch)")
    moves = training.moves_of(judged, policy.act, wanted[0])
    moves.write(out / "moves.csv", judged.robot)
    print(f"Wrote {out / 'moves.csv'}: motion for the first goal. Run it with hydrostat play")
    if networks is not None and env.portable:
        learned = training.portable_policy(trained, cast("ReachEnv", env), networks)
        print(f"Wrote {learned.save(out / 'policy.model')}")


def _read_object(robot: "Robot", text: str, at: str | None, mass: str, friction: float | None) -> "Obstacle":
    """Return the object to push or turn, at its position."""
    from hydrostat.cli.given_object import parse_object
    from hydrostat.cli.options import middle
    from hydrostat.grasp import move_object

    dim = robot.body.mesh.dim
    obstacle = parse_object(text, dim, mass=mass, friction=0.8 if friction is None else friction)
    return obstacle if at is None else move_object(obstacle, middle(at, dim))


def _row(text: str) -> None:
    """Print a row, over the words of progress that a terminal shows."""
    print(f"{chr(13)}{text:<70}" if sys.stderr.isatty() else text, flush=True)


def _line(point: "CurvePoint", word: str, factor: float) -> str:
    """Format the results of a policy at one point of its training curve as a line of a table."""
    lengths = "  ".join(f"{factor * value:4.2f} {word}" for value in (point.mean, point.median, point.worst))
    return f"{point.steps:11}{point.equilibria:12}  {lengths}  {100 * point.success:3.0f} %"


def _picture(curve: "list[CurvePoint]", name: str, out: Path, word: str, factor: float) -> Path:
    """Distances and successes over the actions, as PNG."""
    import numpy as np

    from hydrostat.plot import draw_curves, save_png

    steps = np.array([point.steps for point in curve])
    distances = np.array([[factor * point.mean] for point in curve])
    successes = np.array([[point.success] for point in curve])
    panes = {f"mean distance [{word}]": {name: (steps, distances)}, "success rate": {name: (steps, successes)}}
    return save_png(draw_curves(panes), out / "curve.png")
