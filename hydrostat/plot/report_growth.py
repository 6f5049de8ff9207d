"""The chapters of the report on how a network grew of priced routes, and on the networks beside it."""

from collections.abc import Sequence

import numpy as np

from hydrostat.design.network import Alternative, Certificate, Network, RouteTrace, size_of
from hydrostat.design.score_card import rest_error
from hydrostat.drawing.svg import Html, tag
from hydrostat.plot.design_charts import draw_front, draw_growth, stage_runs
from hydrostat.plot.report_parts import Chapter, grid, picture
from hydrostat.plot.report_tables import millimetres
from hydrostat.plot.robot_figures import draw_stage, stage_frame
from hydrostat.units import counted

MOST_STAGES = 8  # so many stages have a picture
MOST_ALTERNATIVES = 12  # so many alternatives have a picture
CHART = 7.2  # width of a chart [inch]


def growth_chapters(network: Network, trace: RouteTrace) -> list[Chapter]:
    """How the network grew; nothing where no stage was kept."""
    if not trace.stages:
        return []
    words = (
        "At each stage the error itself says what every route through the body would gain. The best one becomes a "
        "cable, cables that no longer earn their place are dropped, and via points move to where the error is least."
    )
    if len(stage_runs(trace.stages)) > 1:
        words += " Several networks are begun, each from another first cable; the most promising is refined."
    shown = evenly(len(trace.stages), MOST_STAGES)
    stages = [trace.stages[index] for index in shown]
    frame = stage_frame([*(stage.robot for stage in stages), network.robot])
    pictures = [
        picture(
            draw_stage(stage.robot, like=network.robot, frame=frame),
            f"stage-{index}",
            f"{index + 1}. {_sentence(stage.words)}",
            f": {_rms_text(stage.error)}",
        )
        for index, stage in zip(shown, stages, strict=True)
    ]
    curve = draw_growth(trace.stages, rest=rest_error(network), final=network.rms_error, marked=shown, width=CHART)
    note = f" over {counted(len(trace.stages), 'stage')}; those with a picture above are filled dots"
    parts = [grid(*pictures, kind="tiny"), grid(picture(curve, "growth", "The error", note))]
    return [Chapter("How it grew", words, [*parts, _certificate(network, trace.certificate)])]


def alternative_chapters(network: Network) -> list[Chapter]:
    """Other networks that were found; nothing where there are none."""
    others = network.alternatives
    if not others:
        return []
    sizes = {size_of(one) for one in (*others, network)}
    words = "Other networks that were found on the way, each with its error over all poses."
    parts: list[Html] = []
    if len(sizes) > 1:
        words += (
            " More winches and more cables cost more and reach more: the curve tells how much. A filled dot lies on "
            "the Pareto front: no network with as few winches and cables is better."
        )
        parts.append(
            grid(
                picture(
                    draw_front(others, network, tolerance=_tolerance(network), width=CHART),
                    "front",
                    "Error against cables",
                    ", a line for each number of winches",
                )
            )
        )
    shown = [others[index] for index in evenly(len(others), MOST_ALTERNATIVES)]
    parts.append(_pictures(network, shown))
    if len(shown) < len(others):
        parts.append(tag("p", f"{len(shown)} of {len(others)} are shown.", class_="quiet"))
    return [Chapter("Alternatives", words, parts)]


def evenly(count: int, most: int) -> list[int]:
    """Indices of at most so many of a count, from the first to the last, evenly between."""
    return sorted({round(float(place)) for place in np.linspace(0, count - 1, min(count, most))})


def certificate_words(error: float, certificate: Certificate | None) -> str:
    """What first-order optimality says of a network of some error [m]."""
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
        f"{certificate.slope:.2g} mm for each millimetre."
    )


def _certificate(network: Network, certificate: Certificate | None) -> Html:
    words = certificate_words(network.rms_error, certificate)
    return tag("p", tag("b", "What is left to gain. "), words, class_="note")


def _tolerance(network: Network) -> float | None:
    """The error of each pose that was asked for [m], where the number of winches was left open."""
    return network.request.route_options.tolerance


def _pictures(network: Network, others: Sequence[Alternative]) -> Html:
    frame = stage_frame([*(other.robot for other in others), network.robot])
    pictures = []
    for index, other in enumerate(others):
        robot = other.robot
        head = f"{counted(len(robot.winches), 'winch')}, {counted(len(robot.cables), 'cable')}"
        figure = draw_stage(robot, like=network.robot, frame=frame)
        pictures.append(picture(figure, f"alternative-{index}", head, f": {_rms_text(other.rms_error)}"))
    return grid(*pictures, kind="tiny")


def _rms_text(error: float) -> str:
    return f"{millimetres(error)} mm rms"


def _sentence(words: str) -> str:
    return words[:1].upper() + words[1:]
