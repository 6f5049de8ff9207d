"""`filled_chapters`: where the cables of a flat robot run, and how far it leaves its plane once it is filled."""

from hydrostat.design import FilledReach, Network, out_of_plane
from hydrostat.drawing import Html, tag
from hydrostat.errors import HydrostatError
from hydrostat.plot.report_tables import Chapter, millimetres, table
from hydrostat.robot import describe_cable_side
from hydrostat.simulation import filled_motion, is_filled_motion_fast
from hydrostat.units import plural

HEAD = "Once it is filled"


def filled_chapters(network: Network) -> list[Chapter]:
    """A chapter on the filled body of a flat robot; nothing for one in space."""
    where = describe_cable_side(network.robot)
    if not where:
        return []
    words = (
        "The model is a slab that stays in its plane. Stuffed, the body is round, and cables pull on its skin. They "
        f"run: {where}."
    )
    if network.filled is not None:
        return [Chapter(HEAD, words, [_error_table(network, network.filled)])]
    return [Chapter(HEAD, words, [tag("p", _flat_commands_text(network), class_="note")])]


def _flat_commands_text(network: Network) -> str:
    """Return the out-of-plane displacement with the commands of the flat model, in words, if quickly computed."""
    pulled = [reached.pose.contractions for reached in network.reached]
    if network.robot.body.outline is None:
        return "How far it leaves the plane is told of drawings only, and this body is a mesh."
    if not is_filled_motion_fast(network.robot, len(pulled)):
        return "How far it leaves the plane takes long to find here: hydrostat check ROBOT --filled tells it."
    try:
        found = filled_motion(network.robot, pulled)
    except HydrostatError as error:
        return f"How far it leaves the plane was not found: {error}."
    return f"With the commands above, {found}."


def _error_table(network: Network, filled: FilledReach) -> Html:
    """Return a table of the pose errors on the stuffed 3D body, by commands that were found there [mm]."""
    rows = [
        (
            pose.pose_target.name,
            millimetres(flat.rms_error),
            millimetres(pose.rms_error),
            f"{1e3 * out_of_plane(pose.pose):.1f}",
            ", ".join(
                f"{winch.name} {1e3 * value:.1f}"
                for winch, value in zip(network.robot.winches, map(float, pose.pose.contractions), strict=True)
            ),
        )
        for flat, pose in zip(network.reached, filled.reached, strict=True)
    ]
    heads = ("pose", "error in the model [mm]", "error filled [mm]", "out of the plane [mm]", "contractions there [mm]")
    told = (
        f"Commands were found on the filled body: {millimetres(filled.rms_error)} mm rms over all poses, where those "
        f"of the flat model reach {millimetres(filled.played)} mm. {plural(filled.finalists, 'network')} stood there "
        "side by side; this one was chosen."
    )
    return tag("div", table(heads, rows, numbers=(1, 2, 3)), tag("p", told, class_="note"))
