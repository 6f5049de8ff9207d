"""`make_report`: a robot as it is, on one page: body, network, what its winches reach; in a process of its own."""

import numpy as np

from hydrostat.drawing.svg import Html, tag
from hydrostat.plot.report_chapters import REACHED, body_part, network_part, reached_part, target_chapter
from hydrostat.plot.report_tables import Chapter, fact, page, section, table
from hydrostat.plot.sheet import MILLIMETRES
from hydrostat.robot import Robot, find_risks, robot_hash
from hydrostat.studio.exporting.download import Download, file_name
from hydrostat.studio.exporting.picture_work import SolvedPoses, solve_poses
from hydrostat.studio.jobs import Report
from hydrostat.units import counted


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
    chapters = [_body(robot), *targets, *_network(robot), *_reached(solved)]
    sections = [section(number, chapter) for number, chapter in enumerate(chapters, start=1)]
    return page(robot.name, _hero(solved), *sections, _footer(robot))


def _hero(solved: SolvedPoses) -> Html:
    robot = solved.robot
    parts = (
        f"A soft body, {counted(len(robot.winches), 'winch')} and {counted(len(robot.cables), 'cable')}, "
        f"{counted(len(robot.poses), 'pose')}. This page tells what the robot is, and what its winches reach."
    )
    steps: list[Html] = []
    if solved.reached:
        errors = np.concatenate([list(reached.errors.values()) for reached in solved.reached])
        error = float(np.sqrt(np.mean(errors**2)))
        tension = max(float(np.max(reached.pose.tensions)) for reached in solved.reached)
        share = f"{100 * error / robot.body.mesh.size:.1f} % of the body's size"
        steps.append(fact(f"{MILLIMETRES * error:.1f}", "mm rms", f"of all markers in all poses: {share}", best=True))
        steps.append(fact(f"{tension:.1f}", "N", "the largest tension of a cable in these poses"))
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
        f"{robot.body.file} as soft material. The hatched fields are held; the white dots are the markers, points to "
        "be watched."
    )
    risks = [tag("div", tag("b", "Mind: "), risk, class_="note") for risk in find_risks(robot)]
    return Chapter("The body", words, [body_part(robot), *risks])


def _network(robot: Robot) -> list[Chapter]:
    if not robot.cables:
        return []
    words = (
        "All cables of one winch share its contraction, each by the radius of its spool. A bar marks the stopper at "
        "the end of a cable, a pale pipe a sheath."
    )
    return [Chapter("Winches and cables", words, [network_part(robot, ": cables by number")])]


def _reached(solved: SolvedPoses) -> list[Chapter]:
    if not solved.reached and not solved.missed:
        return []
    poses = []
    for index, reached in enumerate(solved.reached):
        held = [tag("div", tag("b", "Limit: "), words, class_="note") for words in reached.held]
        poses.append(reached_part(solved.robot, reached, index, *held))
    missed = [tag("div", tag("b", "Not solved: "), line, class_="note") for line in solved.missed]
    return [Chapter(*REACHED, [*poses, *missed])]


def _footer(robot: Robot) -> Html:
    from hydrostat import __version__

    facts = {"hydrostat version": __version__, "robot hash (SHA-256)": robot_hash(robot)}
    rows = [(name, tag("code", value)) for name, value in facts.items()]
    words = (
        "An error is the distance from a marker to its target in the body's equilibrium, solved by finite elements; "
        "rms is the root of the mean of the squared errors."
    )
    return tag("footer", tag("h2", "How this was made"), tag("p", words), table(("", ""), rows))
