"""`make_report`: a robot as it is, on one page: body, network, what its winches reach; in a process of its own."""

import numpy as np

from hydrostat.drawing.svg import Html, tag
from hydrostat.ik import ReachedPose
from hydrostat.plot import draw_network, draw_reached, draw_rest, draw_target
from hydrostat.plot.report_parts import NARROW, Chapter, fact, grid, page, picture, section, table
from hydrostat.plot.report_tables import (
    body_table,
    cable_table,
    contraction_table,
    marker_table,
    place_table,
    tension_table,
    winch_table,
)
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
    chapters = [_body(robot), *_targets(robot), *_network(robot), *_reached(solved)]
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
        error, tension = _rms(errors), max(float(np.max(reached.pose.tensions)) for reached in solved.reached)
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
    figure = draw_rest(robot.with_network((), ()), title="", width=NARROW)
    shown = picture(figure, "body", "Body, mesh and markers", ", coordinates in mm")
    risks = [tag("div", tag("b", "Mind: "), risk, class_="note") for risk in find_risks(robot)]
    markers = [tag("h3", "Markers"), place_table(robot)] if robot.markers else []
    facts = tag("div", tag("h3", "Body"), body_table(robot), *markers)
    return Chapter("The body", words, [tag("div", shown, facts, class_="pose"), *risks])


def _targets(robot: Robot) -> list[Chapter]:
    if not robot.poses:
        return []
    bare = robot.with_network((), ())
    pictures = [
        picture(draw_target(bare, pose, title="", width=NARROW), f"target-{index}", pose.name,
                f": where {counted(len(pose.targets), 'marker')} should go")
        for index, pose in enumerate(robot.poses.values())
    ]  # fmt: skip
    words = "Each pose names targets for markers: a cross is a target, and a marker without an arrow should stay."
    return [Chapter("What it should do", words, [grid(*pictures)])]


def _network(robot: Robot) -> list[Chapter]:
    if not robot.cables:
        return []
    words = (
        "All cables of one winch share its contraction, each by the radius of its spool. A bar marks the stopper at "
        "the end of a cable, a pale pipe a sheath."
    )
    shown = picture(draw_network(robot, title="", width=NARROW), "network", "The network", ": cables by number")
    facts = tag("div", tag("h3", "Winches"), winch_table(robot), tag("h3", "Cables"), cable_table(robot))
    return [Chapter("Winches and cables", words, [tag("div", shown, facts, class_="pose")])]


def _reached(solved: SolvedPoses) -> list[Chapter]:
    if not solved.reached and not solved.missed:
        return []
    words = (
        "Inverse kinematics finds how much cable each winch takes in, and the body comes to rest under these cables "
        "and nothing else. Every number below is measured there. The grey shadow is the rest shape."
    )
    poses = [_reached_pose(solved.robot, reached, index) for index, reached in enumerate(solved.reached)]
    missed = [tag("div", tag("b", "Not solved: "), line, class_="note") for line in solved.missed]
    return [Chapter("What it reaches", words, [*poses, *missed])]


def _reached_pose(robot: Robot, reached: ReachedPose, index: int) -> Html:
    note = f": {MILLIMETRES * reached.rms_error:.2f} mm rms; {reached.reason}"
    tables = {
        "Markers": marker_table(robot, reached),
        "Winches": contraction_table(robot, reached),
        "Cables": tension_table(robot, reached),
    }
    numbers = [part for head, rows in tables.items() for part in (tag("h3", head), rows)]
    held = [tag("div", tag("b", "Limit: "), words, class_="note") for words in reached.held]
    figure = draw_reached(robot, reached, title="", width=NARROW)
    shown = picture(figure, f"reached-{index}", reached.wanted.name, note)
    return tag("div", shown, tag("div", *numbers, *held), class_="pose")


def _footer(robot: Robot) -> Html:
    from hydrostat import __version__

    facts = {"hydrostat version": __version__, "robot hash (SHA-256)": robot_hash(robot)}
    rows = [(name, tag("code", value)) for name, value in facts.items()]
    words = (
        "An error is the distance from a marker to its target in the body's equilibrium, solved by finite elements; "
        "rms is the root of the mean of the squared errors."
    )
    return tag("footer", tag("h2", "How this was made"), tag("p", words), table(("", ""), rows))


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt(np.mean(errors**2)))
