"""Pictures and the report: how robots, poses and designs look."""

from hydrostat.plot.activation_figures import draw_activation, draw_candidates, draw_trees
from hydrostat.plot.motion import motion_frames, motion_svg
from hydrostat.plot.motion_figures import draw_motion
from hydrostat.plot.picture_file import inline_svg, save_png
from hydrostat.plot.pose_figures import draw_portrait, draw_pose, draw_reached
from hydrostat.plot.report import report_text, write_report
from hydrostat.plot.robot_figures import draw_network, draw_rest, draw_target

__all__ = [
    "draw_activation",
    "draw_candidates",
    "draw_motion",
    "draw_network",
    "draw_portrait",
    "draw_pose",
    "draw_reached",
    "draw_rest",
    "draw_target",
    "draw_trees",
    "inline_svg",
    "motion_frames",
    "motion_svg",
    "report_text",
    "save_png",
    "write_report",
]
