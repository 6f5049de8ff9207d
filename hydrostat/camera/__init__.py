"""Camera: measure marker positions from photographs and films, and print the tags for them."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.camera.lens import LensFile
    from hydrostat.camera.marker_camera import CameraFrames, MarkerCamera
    from hydrostat.camera.measure_film import FILMS, FilmOptions, measure_film
    from hydrostat.camera.measure_photos import PhotoMeasurements, PhotoOptions, measure_photos, table_text
    from hydrostat.camera.photo import Photo, read_colors
    from hydrostat.camera.print_tags import find_overhangs, tag_files, tags_pdf

__all__ = [
    "FILMS",
    "CameraFrames",
    "FilmOptions",
    "LensFile",
    "MarkerCamera",
    "Photo",
    "PhotoMeasurements",
    "PhotoOptions",
    "find_overhangs",
    "measure_film",
    "measure_photos",
    "read_colors",
    "table_text",
    "tag_files",
    "tags_pdf",
]

open_package(__name__)
