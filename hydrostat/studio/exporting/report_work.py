"""`make_pictures`, `make_report`: a robot at rest and in its poses, as pictures and a page; in a process of its own."""

import io
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from matplotlib.figure import Figure

from hydrostat.drawing import Color
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik import IKResult, solve_ik
from hydrostat.plot import draw_network, draw_portrait, draw_reached, draw_rest, drawing, robot_report, save_png
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.exporting.download import Download, file_name
from hydrostat.studio.jobs import Report


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
    text = robot_report(robot, solved.reached, solved.missed)
    name = f"{file_name(robot.name)}_report.html"
    return Download(name=name, content=text.encode(errors="replace"), title="Report")
