"""Pictures and the report: how robots, poses and designs look."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.plot.activation_figures import draw_activation
    from hydrostat.plot.animation import WIDTHS, find_ffmpeg, save_gif, save_mp4
    from hydrostat.plot.branch_figure import draw_branches
    from hydrostat.plot.calibration_page import write_calibration_page
    from hydrostat.plot.chart import new_chart, plain_axes, short_number
    from hydrostat.plot.design_charts import draw_winch_front
    from hydrostat.plot.film import Film, Stop, trajectory_frames, upright
    from hydrostat.plot.frame import Attachments, Frame
    from hydrostat.plot.frame_pictures import FramePictures, Picture
    from hydrostat.plot.grasp_figure import draw_pull, pull_frames
    from hydrostat.plot.healing_figure import draw_healing
    from hydrostat.plot.identified_figure import draw_identified
    from hydrostat.plot.learning_curves import draw_curves
    from hydrostat.plot.live_page import LivePage
    from hydrostat.plot.motion_figures import draw_motion, draw_trajectory
    from hydrostat.plot.photo_overlay import draw_photo_overlay
    from hydrostat.plot.picture_file import drawing, inline_svg, save_png
    from hydrostat.plot.report import write_report
    from hydrostat.plot.report_tables import cable_table
    from hydrostat.plot.robot_figures import (
        draw_network,
        draw_parts,
        draw_portrait,
        draw_pose,
        draw_reached,
        draw_rest,
        reached_title,
    )
    from hydrostat.plot.robot_report import robot_report
    from hydrostat.plot.scene import save_glb
    from hydrostat.plot.sheet import WIDTH, new_figure
    from hydrostat.plot.skin import FlatSkin, outer_points

__all__ = [
    "WIDTH",
    "WIDTHS",
    "Attachments",
    "Film",
    "FlatSkin",
    "Frame",
    "FramePictures",
    "LivePage",
    "Picture",
    "Stop",
    "cable_table",
    "draw_activation",
    "draw_branches",
    "draw_curves",
    "draw_healing",
    "draw_identified",
    "draw_motion",
    "draw_network",
    "draw_parts",
    "draw_photo_overlay",
    "draw_portrait",
    "draw_pose",
    "draw_pull",
    "draw_reached",
    "draw_rest",
    "draw_trajectory",
    "draw_winch_front",
    "drawing",
    "find_ffmpeg",
    "inline_svg",
    "new_chart",
    "new_figure",
    "outer_points",
    "plain_axes",
    "pull_frames",
    "reached_title",
    "robot_report",
    "save_gif",
    "save_glb",
    "save_mp4",
    "save_png",
    "short_number",
    "trajectory_frames",
    "upright",
    "write_calibration_page",
    "write_report",
]

open_package(__name__)
