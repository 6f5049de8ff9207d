"""`make_pictures`, `make_report`: a robot at rest and in its poses, as pictures and a page; in a process of its own."""

import io
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.figure import Figure

from hydrostat.drawing import Color, Html, tag
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik import IKResult, solve_ik
from hydrostat.plot import (
    MILLIMETERS,
    REACHED,
    Chapter,
    body_part,
    draw_network,
    draw_portrait,
    draw_reached,
    draw_rest,
    drawing,
    fact,
    network_part,
    page,
    reached_part,
    save_png,
    section,
    table,
    target_chapter,
)
from hydrostat.robot import Robot, find_risks, robot_hash
from hydrostat.simulation import Simulation
from hydrostat.studio.exporting.download import Download, file_name
from hydrostat.studio.jobs import Report
from hydrostat.units import plural


@dataclass(frozen=True, kw_only=True, eq=False)
class SolvedPoses:
    """Inverse-kinematics results of the poses of a robot."""

    robot: Robot  # whose they are
    reached: tuple[IKResult, ...]  # those that were solved, in their order
    missed: tuple[str, ...]  # a line for each that was not


def solve_poses(report: Report, robot: Robot) -> SolvedPoses:
    """Solve all poses by inverse kinematics; none of a robot without cables."""
    simulation = Simulation(robot)
    reached, missed = [], []
    poses = list(robot.poses.values()) if robot.cables else []
    for done, pose in enumerate(poses):
        report.progress(f"Pose {pose.name}", done, len(poses))
        try:
            reached.append(solve_ik(simulation, pose).without_factors())
        except (InputError, NotConvergedError) as error:
            missed.append(f"{pose.name}: {error}")
    return SolvedPoses(robot=robot, reached=tuple(reached), missed=tuple(missed))


def make_pictures(report: Report, robot: Robot) -> tuple[Download, ...]:
    """Each picture as PNG, those of flat bodies as SVG too."""
    solved = solve_poses(report, robot)
    figures = _figures(solved)
    pictures: list[Download] = []
    for done, (name, (title, figure)) in enumerate(figures.items()):
        report.progress("Pictures", done, len(figures))
        stem = f"{file_name(robot.name)}_{name}"
        pictures.append(Download(name=f"{stem}.png", content=_png(figure), title=title))
        if robot.body.mesh.dim == 2:
            pictures.append(Download(name=f"{stem}.svg", content=_svg(figure), title=title))
    return tuple(pictures)


def _figures(solved: SolvedPoses) -> dict[str, tuple[str, Figure]]:
    """Title and figure, by the name of the file."""
    robot = solved.robot
    figures = {"rest": ("Mesh", draw_rest(robot))}
    if robot.cables:
        figures["network"] = ("Network", draw_network(robot))
    figures["portrait"] = ("Rest", draw_portrait(robot, robot.body.mesh.nodes))
    for reached in solved.reached:
        name = reached.pose_target.name
        figures[f"pose_{file_name(name)}"] = (f"{name}: errors", draw_reached(robot, reached))
        bare = draw_portrait(robot, reached.pose.nodes)
        figures[f"portrait_{file_name(name)}"] = (name, bare)
    return figures


def _png(figure: Figure) -> bytes:
    with TemporaryDirectory() as folder:
        return save_png(figure, Path(folder) / "picture.png").read_bytes()


def _svg(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    with drawing():
        figure.savefig(buffer, format="svg", facecolor=Color.PAPER, metadata={"Date": None, "Creator": None})
    return buffer.getvalue()


def make_report(report: Report, robot: Robot) -> Download:
    """The report of a robot as an HTML file."""
    solved = solve_poses(report, robot)
    report.progress("Pages", 0, 1)
    text = robot_report(solved)
    name = f"{file_name(robot.name)}_report.html"
    return Download(name=name, content=text.encode(errors="replace"), title="Report")


def robot_report(solved: SolvedPoses) -> str:
    """The page as text; it needs no other file and no network."""
    robot = solved.robot
    targets = [target_chapter(robot, robot.poses.values())] if robot.poses else []
    chapters = [_body(robot), *targets, *_network(robot), *_pose_chapters(solved)]
    sections = [section(number, chapter) for number, chapter in enumerate(chapters, start=1)]
    return page(robot.name, _hero(solved), *sections, _footer(robot))


def _hero(solved: SolvedPoses) -> Html:
    robot = solved.robot
    parts = (
        f"A soft body, {plural(len(robot.winches), 'winch')} and {plural(len(robot.cables), 'cable')}, "
        f"{plural(len(robot.poses), 'pose')}. This page describes the robot and its poses."
    )
    steps: list[Html] = []
    if solved.reached:
        errors = np.concatenate([list(reached.errors.values()) for reached in solved.reached])
        error = float(np.sqrt(np.mean(errors**2)))
        tension = max(float(np.max(reached.pose.tensions)) for reached in solved.reached)
        share = f"{100 * error / robot.body.mesh.size:.1f} % of the body's size"
        steps.append(fact(f"{MILLIMETERS * error:.1f}", "mm rms", f"of all markers in all poses: {share}", best=True))
        steps.append(fact(f"{tension:.1f}", "N", "maximum cable tension in these poses"))
    return tag(
        "div",
        tag("p", "hydrostat \N{MIDDLE DOT} robot report", class_="eyebrow"),
        tag("h1", robot.name),
        tag("p", parts),
        tag("ol", *steps, class_="path") if steps else "",
        class_="hero",
    )


def _body(robot: Robot) -> Chapter:
    words = (
        f"{robot.body.file} as soft material. Hatched areas are fixed. White dots are the markers, the tracked points."
    )
    risks = [tag("div", tag("b", "Warning: "), risk, class_="note") for risk in find_risks(robot)]
    return Chapter("The body", words, [body_part(robot), *risks])


def _network(robot: Robot) -> list[Chapter]:
    if not robot.cables:
        return []
    words = (
        "All cables of one winch share its contraction, each by the radius of its spool. A bar marks the stopper at "
        "the end of a cable, a pale pipe a sheath."
    )
    return [Chapter("Winches and cables", words, [network_part(robot, ": cables by number")])]


def _pose_chapters(solved: SolvedPoses) -> list[Chapter]:
    if not solved.reached and not solved.missed:
        return []
    poses = []
    for index, reached in enumerate(solved.reached):
        held = [tag("div", tag("b", "Limit: "), words, class_="note") for words in reached.active_limits]
        poses.append(reached_part(solved.robot, reached, index, *held))
    missed = [tag("div", tag("b", "Not solved: "), line, class_="note") for line in solved.missed]
    return [Chapter(*REACHED, [*poses, *missed])]


def _footer(robot: Robot) -> Html:
    from hydrostat.version import __version__

    facts = {"hydrostat version": __version__, "robot hash (SHA-256)": robot_hash(robot)}
    rows = [(name, tag("code", value)) for name, value in facts.items()]
    words = (
        "An error is the distance from a marker to its target in the body's equilibrium, solved by finite elements; "
        "rms is the root of the mean of the squared errors."
    )
    return tag("footer", tag("h2", "Methods"), tag("p", words), table(("", ""), rows))
