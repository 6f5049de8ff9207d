"""Grasps: a robot closes on an object, which is pulled out again."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.grasp.pull_out import PullCase, PullOptions, PullOut, pull_bands, pull_out
    from hydrostat.grasp.thing import moved_thing, place_thing, read_thing

__all__ = [
    "PullCase",
    "PullOptions",
    "PullOut",
    "moved_thing",
    "place_thing",
    "pull_bands",
    "pull_out",
    "read_thing",
]

open_package(__name__)
