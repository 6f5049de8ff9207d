"""`describe_view`: content of the view in words, for screen readers."""

from hydrostat.studio.editing.part import title_of
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
        return _describe_edit(session)
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


def _describe_edit(session: Session) -> list[str]:
    """Selection, the points of a cable that is being laid, and the place of the cross-hair."""
    editor = session.editor
    count = len(editor.selection)
    chosen = title_of(editor.selected_key) if count == 1 else plural(count, "part")
    laid = [] if editor.draft is None else [f"Cable of {plural(len(editor.draft.points), 'point')}"]
    aimed = [f"Cross-hair: {editor.cross_hair.words}"] if editor.cross_hair.words else []
    return [f"Selected: {chosen}" if count else "Nothing selected", *laid, *aimed]
