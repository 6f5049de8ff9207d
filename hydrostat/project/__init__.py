"""A robot as a person works on it: robot.toml, and next to it keyframes and wishes for a design in studio.json."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.project.project_file import PROJECT_FILE, read_project_file, write_project_file
    from hydrostat.project.wishes import WISH_RANGES, Paint, Wishes, moved_zone, wished_constraints, wished_poses
    from hydrostat.project.work_folder import (
        Work,
        after_design,
        changed_outside,
        comments_lost,
        doubts,
        folder_stamp,
        follow_robot,
        fresh_name,
        open_note,
        open_work,
        save_work,
        text_of,
    )

__all__ = [
    "PROJECT_FILE",
    "WISH_RANGES",
    "Paint",
    "Wishes",
    "Work",
    "after_design",
    "changed_outside",
    "comments_lost",
    "doubts",
    "folder_stamp",
    "follow_robot",
    "fresh_name",
    "moved_zone",
    "open_note",
    "open_work",
    "read_project_file",
    "save_work",
    "text_of",
    "wished_constraints",
    "wished_poses",
    "write_project_file",
]

open_package(__name__)
