"""The stages of a design as chapters of the report, each with its pictures."""

from collections.abc import Iterable, Sequence

import numpy as np

from hydrostat.design import (
    Alternative,
    BuildCost,
    Certificate,
    FrontRow,
    Network,
    RouteTrace,
    StuffedResults,
    TreeTrace,
    find_stuffed_motion,
    winch_front,
)
from hydrostat.drawing import Html, tag
from hydrostat.errors import HydrostatError
from hydrostat.ik import IKResult, find_workspaces, unconstrained_motion
from hydrostat.plot.activation_figures import draw_activation, draw_candidates, draw_trees
from hydrostat.plot.design_charts import draw_front, draw_growth, draw_winch_front, stage_runs
from hydrostat.plot.report_sensitivities import sensitivity_table
from hydrostat.plot.report_tables import (
    NARROW_WIDTH,
    Chapter,
    body_table,
    cable_table,
    contraction_table,
    grid,
    marker_table,
    millimeters,
    picture,
    place_table,
    section,
    table,
    tension_table,
    winch_table,
)
from hydrostat.plot.robot_figures import draw_network, draw_reached, draw_rest, draw_stage, draw_target, stage_frame
from hydrostat.plot.workspace_figure import draw_workspace
from hydrostat.robot import PoseTarget, Robot, Source, describe_cable_side
from hydrostat.simulation import Simulation
from hydrostat.units import MILLIMETERS, plural

HEAD = "Once it is filled"


def stuffed_chapters(network: Network) -> list[Chapter]:
    """A chapter on the filled body of a flat robot; nothing for one in space."""
    where = describe_cable_side(network.robot)
    if not where:
        return []
    words = (
        "The model is a slab that stays in its plane. Stuffed, the body is round, and cables pull on its skin. They "
        f"run: {where}."
    )
    if network.stuffed is not None:
        return [Chapter(HEAD, words, [_error_table(network, network.stuffed)])]
    return [Chapter(HEAD, words, [tag("p", _flat_commands_text(network), class_="note")])]


def _flat_commands_text(network: Network) -> str:
    """Return the out-of-plane displacement with the commands of the flat model, in words, if quickly computed."""
    if network.robot.body.outline is None:
        return "How far it leaves the plane is told of drawings only, and this body is a mesh."
    try:
        found = find_stuffed_motion(network)
    except HydrostatError as error:
        return f"How far it leaves the plane was not found: {error}."
    if found is None:
        return "How far it leaves the plane takes long to find here: hydrostat check ROBOT --stuffed tells it."
    return f"With the commands above, {found}."


def _error_table(network: Network, filled: StuffedResults) -> Html:
    """Return a table of the pose errors on the stuffed 3D body, by commands that were found there [mm]."""
    rows = [
        (
            pose.pose_target.name,
            millimeters(flat.rms_error),
            millimeters(pose.rms_error),
            f"{1e3 * pose.pose.out_of_plane:.1f}",
            ", ".join(
                f"{winch.name} {1e3 * value:.1f}"
                for winch, value in zip(network.robot.winches, map(float, pose.pose.contractions), strict=True)
            ),
        )
        for flat, pose in zip(network.ik_results, filled.reached, strict=True)
    ]
    heads = ("pose", "error in the model [mm]", "error filled [mm]", "out of the plane [mm]", "contractions there [mm]")
    told = (
        f"Commands were found on the filled body: {millimeters(filled.rms_error)} mm rms over all poses, where those "
        f"of the flat model reach {millimeters(filled.played)} mm. {plural(filled.finalists, 'network')} stood there "
        "side by side; this one was chosen."
    )
    return tag("div", table(heads, rows, numbers=(1, 2, 3)), tag("p", told, class_="note"))


_HEADS = {
    Source.OUTLINE: "A drawing becomes a body",
    Source.SURFACE: "A surface becomes a body",
    Source.MESH: "A mesh becomes a body",
}


def chapters(network: Network) -> list[Html]:
    """All chapters, numbered in their order: what was asked, how the network came about, what it reaches."""
    trace = network.trace
    way = muscle_chapters(network, trace) if isinstance(trace, TreeTrace) else growth_chapters(network, trace)
    targets = target_chapter(network.robot, [reached.pose_target for reached in network.ik_results])
    poses = [reached_part(network.robot, reached, index) for index, reached in enumerate(network.ik_results)]
    told = [_body(network.robot), targets, *way, _network(network), Chapter(*REACHED, poses)]
    told += stuffed_chapters(network)
    told += [*workspace_chapters(network), *alternative_chapters(network)]
    return [section(number, chapter) for number, chapter in enumerate(told, start=1)]


def _body(robot: Robot) -> Chapter:
    words = (
        f"{robot.body.file} is filled with soft material: {robot.body.mesh.describe()}. The hatched fields are held; "
        "the white dots are the markers, points to be watched."
    )
    return Chapter(_HEADS[robot.body.source], words, [body_part(robot)])


def body_part(robot: Robot) -> Html:
    """The body at rest beside its size, its material and the places of its markers."""
    figure = draw_rest(robot.with_network((), ()), title="", width=NARROW_WIDTH)
    shown = picture(figure, "body", "Body, mesh and markers", ", coordinates in mm")
    markers = [tag("h3", "Markers"), place_table(robot)] if robot.markers else []
    return tag("div", shown, tag("div", tag("h3", "Body"), body_table(robot), *markers), class_="pose")


def target_chapter(robot: Robot, poses: Iterable[PoseTarget]) -> Chapter:
    """Return the chapter on the marker targets of each pose."""
    words = (
        "Each pose names targets for markers: a cross is a target; a marker with a cross and no arrow should stay, "
        "and one that is not drawn may move freely."
    )
    pictures = []
    for index, pose in enumerate(poses):
        figure = draw_target(robot.with_network((), ()), pose, title="", width=NARROW_WIDTH)
        note = f": where {plural(len(pose.targets), 'marker')} should go"
        pictures.append(picture(figure, f"target-{index}", pose.name, note))
    return Chapter("What it should do", words, [grid(*pictures)])


def _network(network: Network) -> Chapter:
    robot = network.robot
    words = (
        f"{plural(len(robot.winches), 'winch')} and {plural(len(robot.cables), 'cable')}, "
        f"chosen from {plural(network.num_evaluated, 'network')} whose poses were solved. All cables of one winch "
        "share its contraction, each by the radius of its spool. A bar marks the stopper at the end of a "
        "cable, a pale pipe a sheath."
    )
    return Chapter("Winches and cables", words, [network_part(robot, ": cables are numbered as in the tables")])


def network_part(robot: Robot, note: str) -> Html:
    """The network, with a note behind its name, beside tables of winches and cables."""
    shown = picture(draw_network(robot, title="", width=NARROW_WIDTH), "network", "The network", note)
    facts = tag("div", tag("h3", "Winches"), winch_table(robot), tag("h3", "Cables"), cable_table(robot))
    return tag("div", shown, facts, class_="pose")


REACHED = (  # head and words of the chapter on the poses
    "What it reaches",
    "Inverse kinematics finds how much cable each winch takes in, and the body comes to rest under these cables "
    "and nothing else. Every number below is measured there. The grey shadow is the rest shape.",
)


def reached_part(robot: Robot, reached: IKResult, index: int, *notes: Html) -> Html:
    """A pose as the winches reach it, beside tables of markers, winches and cables; below them what is to be minded."""
    figure = draw_reached(robot, reached, title="", width=NARROW_WIDTH)
    note = f": {MILLIMETERS * reached.rms_error:.2f} mm rms; {reached.outcome}"
    tables = {
        "Markers": marker_table(robot, reached),
        "Winches": contraction_table(robot, reached),
        "Cables": tension_table(robot, reached),
    }
    if reached.pose.result.converged and reached.pose_target.targets:
        tables["What it depends on"] = sensitivity_table(reached)
    numbers = [part for head, rows in tables.items() for part in (tag("h3", head), rows)]
    shown = picture(figure, f"reached-{index}", reached.pose_target.name, note)
    minded = filter(None, (*reached.pose.warnings, unconstrained_motion(reached)))
    told = [tag("div", tag("b", "Mind: "), words, class_="note") for words in minded]
    return tag("div", shown, tag("div", *numbers, *told, *notes), class_="pose")


def workspace_chapters(network: Network) -> list[Chapter]:
    """Return the chapters on the workspace of each marker beyond the requested poses; none where no pose is found."""
    robot = network.robot
    limit = network.constraints.tension_limit
    most_tried = 36  # poses that are tried for the reach of markers
    reaches = find_workspaces(Simulation(robot), tension=limit, count=most_tried)
    if not any(len(reach.places) for reach in reaches):
        return []
    words = (
        "Poses that nobody asked for count too. These are all places that the winches can bring each marker to, within "
        f"their travel and {limit:g} N in a cable: poses solved at contractions all over their range, and what exact "
        "slopes tell about their surroundings."
    )
    shown = picture(draw_workspace(robot, reaches, title="", width=NARROW_WIDTH), "reach", "Reach", " of each marker")
    told = tag("ul", *(tag("li", tag("b", reach.marker), f": {reach}") for reach in reaches))
    return [Chapter("What else it reaches", words, [tag("div", shown, tag("div", told), class_="pose")])]


def muscle_chapters(network: Network, trace: TreeTrace) -> list[Chapter]:
    """Return the chapters on muscle activations and the routes grown from them; none where there were no muscles."""
    return [_activations(network, trace), _routes(network, trace)] if trace.activations else []


def _activations(network: Network, trace: TreeTrace) -> Chapter:
    words = (
        "A tongue or an octopus arm moves by muscle alone. Suppose that the body were full of muscle fibres, each free "
        "to pull as it likes: these are the tensions that bring it into the pose. The wider and darker a fibre, the "
        "more it pulls; a red line is what is left between marker and target."
    )
    pictures = []
    for index, activation in enumerate(trace.activations):
        figure = draw_activation(network.robot, activation, title="", width=NARROW_WIDTH)
        note = f": {MILLIMETERS * activation.rms_error:.2f} mm rms with free muscles"
        pictures.append(picture(figure, f"activation-{index}", activation.target.name, note))
    return Chapter("What muscles would do", words, [grid(*pictures)])


def _routes(network: Network, trace: TreeTrace) -> Chapter:
    words = "Nobody can sew in hundreds of muscles. The strongest are kept, and neighbors are joined into routes."
    pictures = []
    for index, (activation, kept) in enumerate(zip(trace.activations, trace.candidates, strict=True)):
        figure = draw_candidates(network.robot, activation, kept, title="", width=NARROW_WIDTH)
        note = f": the strongest {len(kept)} of {plural(len(activation.fibres), 'fibre')}"
        pictures.append(picture(figure, f"candidates-{index}", f"Candidates for {activation.target.name}", note))
    figure = draw_trees(network.robot, trace.trees, title="", width=NARROW_WIDTH)
    note = f": {plural(len(trace.trees), 'route')} that join neighboring candidates"
    pictures.append(picture(figure, "trees", "Trees", note))
    return Chapter("From muscles to routes", words, [grid(*pictures, kind="small")])


CHART = 7.2  # width of a chart [inch]


def growth_chapters(network: Network, trace: RouteTrace) -> list[Chapter]:
    """Return the chapter on the growth of the network; none where no stage was kept."""
    if not trace.stages:
        return []
    words = (
        "At each stage the error itself says what every route through the body would gain. The best one becomes a "
        "cable, cables that no longer earn their place are dropped, and via points move to where the error is least."
    )
    if len(stage_runs(trace.stages)) > 1:
        words += (
            " Several networks are begun: grown from different first cables, drawn along the limbs, or taken from "
            "winch trees; the most promising are refined."
        )
    most_stages = 8  # so many stages have a picture
    shown = evenly(len(trace.stages), most_stages)
    stages = [trace.stages[index] for index in shown]
    frame = stage_frame([*(stage.robot for stage in stages), network.robot])
    pictures = []
    for index, stage in zip(shown, stages, strict=True):
        figure = draw_stage(stage.robot, like=network.robot, frame=frame)
        head = f"{index + 1}. {stage.words[:1].upper()}{stage.words[1:]}"
        pictures.append(picture(figure, f"stage-{index}", head, f": {_rms_text(stage.error)}"))
    curve = draw_growth(trace.stages, rest=network.rest_error, final=network.expected_error, marked=shown, width=CHART)
    note = f" over {plural(len(trace.stages), 'stage')}; those with a picture above are filled dots"
    parts = [grid(*pictures, kind="tiny"), grid(picture(curve, "growth", "The error", note))]
    return [Chapter("How it grew", words, [*parts, _certificate(network, trace.certificate)])]


def alternative_chapters(network: Network) -> list[Chapter]:
    """Other networks that were found; nothing where there are none."""
    others = network.alternatives
    if not others:
        return []
    efforts = {BuildCost.cable_minutes(one.robot) for one in (*others, network)}
    words = "Other networks that were found on the way, each with its error over all poses."
    parts: list[Html] = []
    if len(efforts) > 1:
        work = BuildCost.cable_work(network.robot)
        words += (
            f" More {work} reaches more: the curve tells how much. The number at a dot counts cables. A filled dot "
            "lies on the Pareto front: no network that takes as few minutes is better."
        )
        figure = draw_front(others, network, tolerance=network.request.route_options.tolerance, width=CHART)
        note = ", a color for each number of winches"
        parts.append(grid(picture(figure, "front", f"Error against minutes of {work}", note)))
    if len(rows := winch_front(network)) > 1:
        words += (
            " The table has the best network for each number of winches, pulling one way or both ways. A row is no "
            "better if another has as small an error for as little money and work."
        )
        note = ", each with its winches and minutes of work"
        parts.append(grid(picture(draw_winch_front(rows, width=CHART), "winch-front", "Error against price", note)))
        parts.append(_winch_table(rows))
    most_alternatives = 12  # so many alternatives have a picture
    shown = [others[index] for index in evenly(len(others), most_alternatives)]
    parts.append(_pictures(network, shown))
    if len(shown) < len(others):
        parts.append(tag("p", f"{len(shown)} of {len(others)} are shown.", class_="quiet"))
    return [Chapter("Alternatives", words, parts)]


def _winch_table(front: Sequence[FrontRow]) -> Html:
    """Table of as-built error and effort by the number of winches."""
    heads = ("winches", "cables", "error once built [mm]", "motors", f"{front[0].cost.work} [min]", "price [USD]", "")
    rows = []
    for row in front:
        made = (f"{row.cost.motors} × {row.cost.motor}", f"{row.cost.minutes:.0f}", f"{row.cost.price:.0f}", row.note)
        rows.append((row.title, row.cables, millimeters(row.expected_error), *made))
    return table(heads, rows, numbers=range(len(heads) - 1))


def evenly(count: int, most: int) -> list[int]:
    """Indices of at most so many of a count, from the first to the last, evenly between."""
    return sorted({round(float(place)) for place in np.linspace(0, count - 1, min(count, most))})


def certificate_words(error: float, certificate: Certificate | None) -> str:
    """Return the first-order optimality of a network with some error [m], in words."""
    if certificate is None:
        return "The search was stopped before it could tell what one more cable would gain."
    gain = (
        f"would promise {_rms_text(certificate.further)} instead of {_rms_text(error)}"
        if certificate.further < error
        else f"promises nothing beyond {_rms_text(error)}"
    )
    return (
        f"One more cable with a winch of its own, along the best path found by pricing "
        f"{certificate.paths:,} states, {gain}. Moving one via point along one axis lowers the error by at most "
        f"{certificate.descent_rate:.2g} mm for each millimeter."
    )


def _certificate(network: Network, certificate: Certificate | None) -> Html:
    words = certificate_words(network.rms_error, certificate)
    if certificate is None and network.stuffed is not None and network.complete:
        words = (
            "That was found for the network that the flat model holds best; on the filled body this one does better."
        )
    return tag("p", tag("b", "What is left to gain. "), words, class_="note")


def _pictures(network: Network, others: Sequence[Alternative]) -> Html:
    frame = stage_frame([*(other.robot for other in others), network.robot])
    pictures = []
    for index, other in enumerate(others):
        robot = other.robot
        head = f"{plural(len(robot.winches), 'winch')}, {plural(len(robot.cables), 'cable')}"
        figure = draw_stage(robot, like=network.robot, frame=frame)
        told = f": {_rms_text(other.expected_error)} once built; {other.cost}"
        pictures.append(picture(figure, f"alternative-{index}", head, told))
    return grid(*pictures, kind="tiny")


def _rms_text(error: float) -> str:
    return f"{millimeters(error)} mm rms"
