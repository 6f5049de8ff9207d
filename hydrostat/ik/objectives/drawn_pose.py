"""`drawn_pose`: the shape of a pose, drawn over the body's own drawing."""

from pathlib import Path

from hydrostat.errors import InputError
from hydrostat.geometry.files.outline_file import read_drawing, read_outline
from hydrostat.geometry.outline import Outline
from hydrostat.robot import Robot, Source


def drawn_pose(robot: Robot, drawing: Path | str) -> Outline:
    """The outline of a pose in the coordinates of the robot, for `ShapeGoal`.

    Copy the drawing or picture of the body, and bend what is on it; the page must stay as it is. Read by itself, a
    drawing would be put into the middle of its own bounding box, and the pose would no longer be where it was drawn.
    Another page is noticed by the page and unit of an SVG drawing, the unit of a DXF drawing, the pixels of a picture;
    DXF has no page, so where its program counts from another corner, the pose is shifted without a word.

    Args:
        robot: a flat one, whose body was drawn.
        drawing: file of the same kind as the body's: SVG, DXF, PNG or JPG.

    Raises:
        InputError: the body was not drawn, or the file cannot be read.
        OutlineError: no pose can be made of the drawing, or it has another page.
    """
    body, file = robot.body, Path(drawing)
    if body.source is not Source.OUTLINE:
        raise InputError(f"{file.name}: a pose can be drawn over a drawing only, the body is of a {body.source} file")
    try:
        content = file.read_bytes()
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from error
    page = read_drawing(body.content, name=body.file, size=body.size).page
    return read_outline(content, name=file.name, page=page)
