"""The chapters of the report on a network of winch trees: from muscles to routes."""

from hydrostat.design.network import Network, TreeTrace
from hydrostat.plot.activation_figures import draw_activation, draw_candidates, draw_trees
from hydrostat.plot.report_parts import NARROW, Chapter, grid, picture
from hydrostat.plot.sheet import MILLIMETRES
from hydrostat.units import counted


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
