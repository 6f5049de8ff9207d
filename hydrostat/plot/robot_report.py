"""`robot_report`: a robot and its poses on one page that needs no other file and no network."""

from collections.abc import Sequence

import numpy as np

from hydrostat.drawing import Html, tag
from hydrostat.ik import IKResult
from hydrostat.plot.report_chapters import REACHED, body_part, network_part, reached_part, target_chapter
from hydrostat.plot.report_tables import Chapter, fact, page, section, table
from hydrostat.robot import Robot, find_risks, robot_hash
from hydrostat.units import MILLIMETERS, plural
from hydrostat.version import __version__


def robot_report(robot: Robot, results: Sequence[IKResult], failures: Sequence[str] = ()) -> str:
    """Return the page as text.

    Args:
        robot: robot that the page describes.
        results: inverse-kinematics results of its poses.
        failures: a line for each pose that was not solved.
    """
    targets = [target_chapter(robot, robot.poses.values())] if robot.poses else []
    chapters = [_body(robot), *targets, *_network(robot), *_pose_chapters(robot, results, failures)]
    sections = [section(number, chapter) for number, chapter in enumerate(chapters, start=1)]
    return page(robot.name, _hero(robot, results), *sections, _footer(robot))


def _hero(robot: Robot, results: Sequence[IKResult]) -> Html:
    parts = (
        f"A soft body, {plural(len(robot.winches), 'winch')} and {plural(len(robot.cables), 'cable')}, "
        f"{plural(len(robot.poses), 'pose')}. This page describes the robot and its poses."
    )
    steps: list[Html] = []
    if results:
        errors = np.concatenate([list(reached.errors.values()) for reached in results])
        error = float(np.sqrt(np.mean(errors**2)))
        tension = max(float(np.max(reached.pose.tensions)) for reached in results)
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


def _pose_chapters(robot: Robot, results: Sequence[IKResult], failures: Sequence[str]) -> list[Chapter]:
    if not results and not failures:
        return []
    poses = []
    for index, reached in enumerate(results):
        held = [tag("div", tag("b", "Limit: "), words, class_="note") for words in reached.active_limits]
        poses.append(reached_part(robot, reached, index, *held))
    missed = [tag("div", tag("b", "Not solved: "), line, class_="note") for line in failures]
    return [Chapter(*REACHED, [*poses, *missed])]


def _footer(robot: Robot) -> Html:
    facts = {"hydrostat version": __version__, "robot hash (SHA-256)": robot_hash(robot)}
    rows = [(name, tag("code", value)) for name, value in facts.items()]
    words = (
        "An error is the distance from a marker to its target in the body's equilibrium, solved by finite elements; "
        "rms is the root of the mean of the squared errors."
    )
    return tag("footer", tag("h2", "Methods"), tag("p", words), table(("", ""), rows))
