"""`make_report`: a robot as it is, as one page, in a process of its own."""

from hydrostat.robot import Robot
from hydrostat.studio.exporting.archive import file_name
from hydrostat.studio.exporting.download import Download
from hydrostat.studio.exporting.robot_report import robot_report
from hydrostat.studio.exporting.solved_poses import solve_poses
from hydrostat.studio.jobs import Report


def make_report(report: Report, robot: Robot) -> Download:
    """The report of a robot as an HTML file."""
    solved = solve_poses(report, robot)
    report.progress("Pages", 0, 1)
    text = robot_report(solved)
    name = f"{file_name(robot.name)}_report.html"
    return Download(name=name, content=text.encode(errors="replace"), title="Report")
