"""Draw the pictures of the README from the examples: python docs/pictures.py (make pictures).

Everything shown is computed here: the network is designed, its poses are solved.
"""

import sys
from io import BytesIO
from pathlib import Path

import matplotlib.image
from matplotlib.figure import Figure

import hydrostat as hs
from hydrostat.plot import draw_activation, draw_network, draw_portrait, draw_pose, draw_reached, save_png
from hydrostat.robot import gallery_folder, gallery_names

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))
from hand_body import hand_robot

HERE = Path(__file__).parent / "pictures"
PORTRAIT = 3.2
"""Width of a portrait [inches]."""


def main() -> None:
    """Design the starfish and draw its stages, then all of the gallery and the hand."""
    robot = hs.load_robot(gallery_folder("starfish"))
    network = hs.design_cables(robot, [robot.poses["wave"]], winches=2, cables=6)
    save_png(draw_activation(robot, network.activations[0], title=""), HERE / "activation.png", dpi=110)
    save_png(draw_network(network.robot, title=""), HERE / "network.png", dpi=110)
    save_png(draw_reached(network.robot, network.reached[0], title=""), HERE / "reached.png", dpi=110)
    draw_gallery()
    draw_hand()


def draw_hand() -> None:
    """The foam hand of the benchmarks, its five flexors taken in by a quarter."""
    robot = hand_robot()
    pulled = {cable.winch: 0.25 * cable.length for cable in robot.cables if cable.winch.endswith("flexor")}
    save_png(draw_pose(robot, hs.Simulation(robot).solve(pulled)), HERE / "hand.png", dpi=90)


def draw_gallery() -> None:
    """Every gallery robot at rest above, in its first pose by its own hand-placed cables below."""
    rows: list[list[Figure]] = [[], []]
    for name in gallery_names():
        robot = hs.load_robot(gallery_folder(name))
        reached = hs.solve_ik(hs.Simulation(robot), next(iter(robot.poses.values())))
        rows[0].append(draw_portrait(robot, robot.body.mesh.nodes, width=PORTRAIT))
        rows[1].append(draw_portrait(robot, reached.pose.nodes, width=PORTRAIT))
    sheet = Figure(figsize=(2.0 * len(rows[0]), 4.0), facecolor="white")
    for row, figures in enumerate(rows):
        for column, figure in enumerate(figures):
            axes = sheet.add_axes((column / len(figures), 0.5 - 0.5 * row, 1 / len(figures), 0.5))
            axes.imshow(_pixels(figure))
            axes.set_axis_off()
    save_png(sheet, HERE / "gallery.png", dpi=110)


def _pixels(figure: Figure) -> object:
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=160)
    buffer.seek(0)
    return matplotlib.image.imread(buffer)


if __name__ == "__main__":
    main()
