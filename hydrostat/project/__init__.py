"""A robot as a person works on it: robot.toml, and next to it keyframes and wishes for a design in studio.json."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.project.project_file import PROJECT_FILE, read_project_file, write_project_file
    from hydrostat.project.wishes import WISH_RANGES, Paint, Wishes
    from hydrostat.project.work_folder import Work, changed_outside, folder_stamp, fresh_name, open_note, text_of

__all__ = [
    "PROJECT_FILE",
    "WISH_RANGES",
    "Paint",
    "Wishes",
    "Work",
    "changed_outside",
    "folder_stamp",
    "fresh_name",
    "open_note",
    "read_project_file",
    "text_of",
    "write_project_file",
]

open_package(__name__)
