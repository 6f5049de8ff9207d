"""`make_pictures`: a robot at rest and in its poses, in a process of its own."""

import io
from pathlib import Path
from tempfile import TemporaryDirectory

from matplotlib.figure import Figure

from hydrostat.plot import draw_network, draw_portrait, draw_reached, draw_rest, save_png
from hydrostat.plot.palette import PAPER
from hydrostat.plot.picture_file import drawing
from hydrostat.robot import Robot
from hydrostat.studio.exporting.archive import file_name
from hydrostat.studio.exporting.download import Download
from hydrostat.studio.exporting.solved_poses import SolvedPoses, solve_poses
from hydrostat.studio.jobs import Report


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
        name = reached.wanted.name
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
        figure.savefig(buffer, format="svg", facecolor=PAPER, metadata={"Date": None, "Creator": None})
    return buffer.getvalue()
