"""The stages of a design as chapters of the report, each with its pictures."""

from collections.abc import Iterable

from hydrostat.design.network import Network, TreeTrace
from hydrostat.drawing.svg import Html, tag
from hydrostat.ik import ReachedPose
from hydrostat.plot.activation_figures import draw_activation, draw_candidates, draw_trees
from hydrostat.plot.pose_figures import draw_reached
from hydrostat.plot.report_growth import alternative_chapters, growth_chapters
from hydrostat.plot.report_parts import NARROW, Chapter, grid, picture, section
from hydrostat.plot.report_tables import (
    body_table,
    cable_table,
    contraction_table,
    marker_table,
    place_table,
    tension_table,
    winch_table,
)
from hydrostat.plot.robot_figures import draw_network, draw_rest, draw_target
from hydrostat.plot.sheet import MILLIMETRES
from hydrostat.robot import Pose, Robot, Source
from hydrostat.units import counted

_HEADS = {
    Source.OUTLINE: "A drawing becomes a body",
    Source.SURFACE: "A surface becomes a body",
    Source.MESH: "A mesh becomes a body",
}


def chapters(network: Network) -> list[Html]:
    """All chapters, numbered in their order: what was asked, how the network came about, what it reaches."""
    trace = network.trace
    way = muscle_chapters(network, trace) if isinstance(trace, TreeTrace) else growth_chapters(network, trace)
    targets = target_chapter(network.robot, [reached.wanted for reached in network.reached])
    poses = [reached_part(network.robot, reached, index) for index, reached in enumerate(network.reached)]
    told = [_body(network.robot), targets, *way, _network(network), Chapter(*REACHED, poses)]
    told += alternative_chapters(network)
    return [section(number, chapter) for number, chapter in enumerate(told, start=1)]


def _body(robot: Robot) -> Chapter:
    elements = "triangles" if robot.body.mesh.dim == 2 else "tetrahedra"
    words = (
        f"{robot.body.file} is filled with {len(robot.body.mesh.elements)} {elements} of soft material. The hatched "
        "fields are held; the white dots are the markers, points to be watched."
    )
    return Chapter(_HEADS[robot.body.source], words, [body_part(robot)])


def body_part(robot: Robot) -> Html:
    """The body at rest beside its size, its material and the places of its markers."""
    figure = draw_rest(robot.with_network((), ()), title="", width=NARROW)
    shown = picture(figure, "body", "Body, mesh and markers", ", coordinates in mm")
    markers = [tag("h3", "Markers"), place_table(robot)] if robot.markers else []
    return tag("div", shown, tag("div", tag("h3", "Body"), body_table(robot), *markers), class_="pose")


def target_chapter(robot: Robot, poses: Iterable[Pose]) -> Chapter:
    """What each pose asks of the markers."""
    words = "Each pose names targets for markers: a cross is a target, and a marker without an arrow should stay."
    pictures = []
    for index, pose in enumerate(poses):
        figure = draw_target(robot.with_network((), ()), pose, title="", width=NARROW)
        note = f": where {counted(len(pose.targets), 'marker')} should go"
        pictures.append(picture(figure, f"target-{index}", pose.name, note))
    return Chapter("What it should do", words, [grid(*pictures)])


def _network(network: Network) -> Chapter:
    robot = network.robot
    words = (
        f"{counted(len(robot.winches), 'winch')} and {counted(len(robot.cables), 'cable')}, "
        f"chosen from {counted(network.tried, 'network')} whose poses were solved. All cables of one winch "
        "share its contraction, each by the radius of its spool. A bar marks the stopper at the end of a "
        "cable, a pale pipe a sheath."
    )
    return Chapter("Winches and cables", words, [network_part(robot, ": cables are numbered as in the tables")])


def network_part(robot: Robot, note: str) -> Html:
    """The network, with a note behind its name, beside tables of winches and cables."""
    shown = picture(draw_network(robot, title="", width=NARROW), "network", "The network", note)
    facts = tag("div", tag("h3", "Winches"), winch_table(robot), tag("h3", "Cables"), cable_table(robot))
    return tag("div", shown, facts, class_="pose")


REACHED = (  # head and words of the chapter on the poses
    "What it reaches",
    "Inverse kinematics finds how much cable each winch takes in, and the body comes to rest under these cables "
    "and nothing else. Every number below is measured there. The grey shadow is the rest shape.",
)


def reached_part(robot: Robot, reached: ReachedPose, index: int, *notes: Html) -> Html:
    """A pose as the winches reach it, beside tables of markers, winches and cables, and notes below them."""
    figure = draw_reached(robot, reached, title="", width=NARROW)
    note = f": {MILLIMETRES * reached.rms_error:.2f} mm rms; {reached.reason}"
    tables = {
        "Markers": marker_table(robot, reached),
        "Winches": contraction_table(robot, reached),
        "Cables": tension_table(robot, reached),
    }
    numbers = [part for head, rows in tables.items() for part in (tag("h3", head), rows)]
    shown = picture(figure, f"reached-{index}", reached.wanted.name, note)
    return tag("div", shown, tag("div", *numbers, *notes), class_="pose")


def muscle_chapters(network: Network, trace: TreeTrace) -> list[Chapter]:
    """What muscles would do, and the routes that grew from them; nothing where there were no muscles."""
    return [_activations(network, trace), _routes(network, trace)] if trace.activations else []


def _activations(network: Network, trace: TreeTrace) -> Chapter:
    words = (
        "A tongue or an octopus arm moves by muscle alone. Suppose that the body were full of muscle fibres, each free "
        "to pull as it likes: these are the tensions that bring it into the pose. The wider and darker a fibre, the "
        "more it pulls; a red line is what is left between marker and target."
    )
    pictures = []
    for index, activation in enumerate(trace.activations):
        figure = draw_activation(network.robot, activation, title="", width=NARROW)
        note = f": {MILLIMETRES * activation.rms_error:.2f} mm rms with free muscles"
        pictures.append(picture(figure, f"activation-{index}", activation.target.name, note))
    return Chapter("What muscles would do", words, [grid(*pictures)])


def _routes(network: Network, trace: TreeTrace) -> Chapter:
    words = "Nobody can sew in hundreds of muscles. The strongest are kept, and neighbours are joined into routes."
    pictures = []
    for index, (activation, kept) in enumerate(zip(trace.activations, trace.candidates, strict=True)):
        figure = draw_candidates(network.robot, activation, kept, title="", width=NARROW)
        note = f": the strongest {len(kept)} of {counted(len(activation.fibres), 'fibre')}"
        pictures.append(picture(figure, f"candidates-{index}", f"Candidates for {activation.target.name}", note))
    figure = draw_trees(network.robot, trace.trees, title="", width=NARROW)
    note = f": {counted(len(trace.trees), 'route')} that join neighbouring candidates"
    return Chapter(
        "From muscles to routes", words, [grid(*pictures, picture(figure, "trees", "Trees", note), kind="small")]
    )
