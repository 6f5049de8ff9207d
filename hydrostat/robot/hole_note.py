"""`describe_filled_holes`: a note on the holes of a body that its elements are too large for."""

from hydrostat.robot.body import Body


def describe_filled_holes(body: Body) -> str:
    """Describe the holes that are filled in the mesh of a body in space; empty without any."""
    if body.healing is None or body.element_size is None:
        return ""
    from hydrostat.geometry import HOLE_SHARE, fill_small_holes

    return fill_small_holes(body.healing.surface, HOLE_SHARE * body.element_size).describe(body.element_size)
