"""`describe_view`: content of the view in words, for screen readers."""

from hydrostat.studio.session import Session
from hydrostat.studio.stage import StageName, format_error
from hydrostat.units import plural


def describe_view(session: Session) -> str:
    """Robot, counts of its parts, and the state of the stage; "" without a robot."""
    if not session.document.is_open:
        return ""
    robot = session.document.robot
    counts = [plural(len(robot.markers), "marker"), plural(len(robot.winches), "winch")]
    sentences = [f"{robot.name}: {', '.join([*counts, plural(len(robot.cables), 'cable')])}", *_describe_stage(session)]
    return ". ".join([*sentences, ""]).strip()


def _describe_stage(session: Session) -> list[str]:
    """Sentences on the state of the stage."""
    if session.stage is StageName.POSE:
        return _describe_targets(session)
    if session.stage is StageName.EDIT:
        count = len(session.editor.selection)
        return [f"Selected: {plural(count, 'part')}" if count else "Nothing selected"]
    if session.stage is StageName.DESIGN and (network := session.designer.candidate) is not None:
        return [f"Network {network.counts}, {format_error(network.expected_error)} as-built error"]
    if session.stage is StageName.DRIVE:
        taken = [f"{name} {round(1e3 * value, 1) + 0.0:.1f} mm" for name, value in session.driver.commands().items()]
        return [f"Contractions: {', '.join(taken)}"] if taken else []
    return []


def _describe_targets(session: Session) -> list[str]:
    """Targets with their errors, and the chosen point."""
    poser = session.poser
    errors = poser.shape().errors
    held = [f"{name} {format_error(errors[name])} off" if name in errors else name for name in poser.held_points]
    chosen = [f"Chosen: {poser.chosen_name}"] if poser.chosen_name else []
    return [f"Targets: {', '.join(held)}" if held else "At rest, no targets", *chosen]
