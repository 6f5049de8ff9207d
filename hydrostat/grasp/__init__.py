"""Grasp simulation: close a robot on an object, then pull the object out."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.grasp.grasped_object import find_overlaps, move_object, place_object, read_object
    from hydrostat.grasp.pull_out import PullCase, PullOptions, PullOut, pull_bands, pull_out

__all__ = [
    "PullCase",
    "PullOptions",
    "PullOut",
    "find_overlaps",
    "move_object",
    "place_object",
    "pull_bands",
    "pull_out",
    "read_object",
]

open_package(__name__)
