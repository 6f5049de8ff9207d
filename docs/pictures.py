"""Draw the pictures of the README from the examples: python docs/pictures.py (make pictures).

Everything shown is computed here: the network is designed, its poses are solved. `python docs/pictures.py demo` draws
the pictures of `make demo` alone; demo.json next to them holds its network and its figures, which tests compare.
"""

import json
import sys
from dataclasses import asdict, replace
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import matplotlib.image
import numpy as np
from matplotlib.figure import Figure
from PIL import Image, ImageDraw, ImageFont, ImageSequence

import hydrostat as hs
from hydrostat.design import activate, assign_cable_sides, edge_fibres, winch_front
from hydrostat.fabrication import KitOptions
from hydrostat.geometry import Surface, contour, heal
from hydrostat.plot import (
    Film,
    Stop,
    draw_activation,
    draw_healing,
    draw_network,
    draw_portrait,
    draw_pose,
    draw_reached,
    draw_trajectory,
    draw_winch_front,
    save_gif,
    save_png,
)
from hydrostat.robot import Mount, gallery_folder, list_gallery, robot_hash
from hydrostat.studio import page_pictures
from hydrostat.version import __version__

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))
sys.path.append(str(Path(__file__).parent))
from benchmark_bodies import hand_robot
from gallery import TENDON_SHEETS

HERE = Path(__file__).parent / "pictures"
PORTRAIT = 3.2
"""Width of a portrait [inches]."""

FILM = 480
"""Width of the film [pixels]."""

CABLES = "2. Cables on two winches replace the muscles"
"""Caption of the film's second picture."""

DEMO_POSE, DEMO_WINCHES, DEMO_CABLES = "wave", 2, 6
"""The design of `make demo`."""

DEMO_PICTURES = ("activation.png", "network.png", "reached.png", "kit.png", "demo.gif")


def main() -> None:
    """Draw all of them, or those of the demo, its film alone, or robots of hinges, bones and disks."""
    if sys.argv[1:] == ["tendons"]:
        draw_tendons()
        return
    if sys.argv[1:] == ["winches"]:
        draw_winches()
        return
    if sys.argv[1:] == ["film"]:
        record = json.loads((HERE / "demo.json").read_text())
        draw_film(record, HERE / "demo.gif")
        write_record(record)
        return
    draw_demo()
    if sys.argv[1:] == ["demo"]:
        return
    draw_tendons()
    draw_winches()
    draw_dance()
    draw_gallery()
    draw_bodies()
    draw_hand()
    draw_dirt()


def draw_winches() -> None:
    """Error as built over price for other numbers of winches."""
    robot = hs.load_robot(gallery_folder("letter_s"))
    network = hs.design_cables(robot, robot.poses.values(), winches=1, cables=2, front=True)
    save_png(draw_winch_front(winch_front(network)), HERE / "winch_front.png", dpi=110)


def draw_demo() -> None:
    """The stages of the design of `make demo`, pages of its kit, and a record of both."""
    robot = hs.load_robot(gallery_folder("starfish"))
    pose = robot.poses[DEMO_POSE]
    activation = activate(robot, pose, edge_fibres(robot.body.mesh))
    save_png(draw_activation(robot, activation, title=""), HERE / "activation.png", dpi=110)
    network = hs.design_cables(robot, [pose], winches=DEMO_WINCHES, cables=DEMO_CABLES)
    save_png(draw_network(network.robot, title=""), HERE / "network.png", dpi=110)
    save_png(draw_reached(network.robot, network.ik_results[0], title=""), HERE / "reached.png", dpi=110)
    limits = network.constraints
    kit = hs.build_kit(network.robot, options=KitOptions(tension=limits.tension_limit, torque=limits.torque))
    draw_kits(kit)
    own = network.robot
    record = {
        "command": f"hydrostat design examples/starfish --pose {DEMO_POSE} --winches {DEMO_WINCHES} "
        f"--cables {DEMO_CABLES} --kit",
        "version": __version__,
        "source_robot": robot_hash(robot),
        "robot": robot_hash(own),
        "rms_error": network.rms_error,
        "rms_error_as_built": network.expected_error,
        "tension_limit": limits.tension_limit,
        "torque_limit": own.max_torque,
        "contractions": network.ik_results[0].pose.contractions.tolist(),
        "face": own.face,
        "winches": [asdict(winch) for winch in own.winches],
        "cables": [asdict(cable) for cable in own.cables],
    }
    draw_film(record, HERE / "demo.gif")
    write_record(record)


def write_record(record: dict[str, Any]) -> None:
    """Record of the demo with the hashes of its pictures, as demo.json."""
    record["pictures"] = {name: sha256((HERE / name).read_bytes()).hexdigest() for name in DEMO_PICTURES}
    lines = [f" {json.dumps(name)}: {json.dumps(value)}" for name, value in record.items()]
    (HERE / "demo.json").write_text("{\n" + ",\n".join(lines) + "\n}\n")


def demo_robot(record: dict[str, Any]) -> hs.Robot:
    """Starfish of the gallery with the network of a record of the demo."""
    starfish = hs.load_robot(gallery_folder("starfish"))
    winches = [hs.Winch(**_as_tuples(winch) | {"mount": Mount(winch["mount"])}) for winch in record["winches"]]
    cables = [hs.Cable(**_as_tuples(cable)) for cable in record["cables"]]
    robot = assign_cable_sides(starfish).with_network(winches, cables)
    return replace(robot, max_tension=record["tension_limit"], max_torque=record["torque_limit"])


def _as_tuples(value: Any) -> Any:
    """Values of JSON with tuples for lists."""
    if isinstance(value, dict):
        return {name: _as_tuples(one) for name, one in value.items()}
    return tuple(map(_as_tuples, value)) if isinstance(value, list) else value


def draw_film(record: dict[str, Any], path: Path) -> None:
    """The three steps of the demo as a GIF: muscles, cables, and the winches that move the robot into the pose."""
    starfish, robot = hs.load_robot(gallery_folder("starfish")), demo_robot(record)
    pose = starfish.poses[DEMO_POSE]
    muscles = draw_activation(starfish, activate(starfish, pose, edge_fibres(starfish.body.mesh)), title="")
    stills = [(_pixels(muscles), "1. Virtual muscles make the pose"), (_pixels(draw_network(robot, title="")), CABLES)]
    stop = Stop(name=DEMO_POSE, contractions=np.array(record["contractions"]), target=pose)
    film = Film.of_stops(hs.Simulation(robot), [stop], seconds=4.0)
    frames, times = [], []
    with TemporaryDirectory() as folder:
        file = save_gif(robot, film.frames, Path(folder) / "film.gif", step=film.step, width=FILM)
        with Image.open(file) as moving:
            for frame in ImageSequence.Iterator(moving):
                frames.append(_with_caption(frame.convert("RGB"), "3. Two winches move the robot there"))
                times.append(frame.info["duration"])
    first = [_with_caption(Image.fromarray(np.uint8(255 * pixels[..., :3])), words) for pixels, words in stills]
    palette = Image.new("RGB", (FILM, 3 * frames[0].height))
    for row, frame in enumerate([*first, frames[len(frames) // 2]]):
        palette.paste(frame, (0, row * frame.height))
    palette = palette.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=2)
    colors = np.array(palette.getpalette()).reshape(-1, 3)
    colors[colors.min(axis=1) > 247] = 255  # means of near-white pixels
    palette.putpalette(colors.ravel().tolist())
    shown = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in [*first, *frames]]
    shown[0].save(path, save_all=True, append_images=shown[1:], duration=[2000, 2000, *times], loop=0, optimize=True)


def _with_caption(picture: Image.Image, words: str) -> Image.Image:
    """A picture of the film, as wide as it, with words below."""
    page = Image.new("RGB", (FILM, FILM + 56), "white")
    picture.thumbnail((FILM, FILM), Image.Resampling.LANCZOS)
    page.paste(picture, ((FILM - picture.width) // 2, 0))
    font = ImageFont.truetype(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf", 18)
    ImageDraw.Draw(page).text((FILM / 2, FILM + 28), words, fill=(40, 40, 40), font=font, anchor="mm")
    return page


def draw_dance() -> None:
    """The starfish of the gallery through its poses and back to rest."""
    robot = hs.load_robot(gallery_folder("starfish"))
    trajectory = hs.solve_ik_trajectory(hs.Simulation(robot), list(robot.poses.values()), loop=True)
    save_png(draw_trajectory(robot, trajectory, title=""), HERE / "trajectory.png", dpi=140)


def draw_kits(kit: hs.Kit) -> None:
    """The first page of a kit's assembly sheet, next to two pages of a hand of foam."""
    hand = hs.build_kit(hs.load_robot(gallery_folder("cupping_hand")))
    pages = [_page(kit, 1), _page(hand, 2), _page(hand, 3)]
    gap = np.ones((pages[0].shape[0], 24, 3))
    row = np.concatenate([pages[0], gap, pages[1], gap, pages[2]], axis=1)
    matplotlib.image.imsave(HERE / "kit.png", row)


def _page(kit: hs.Kit, page: int) -> np.ndarray:
    """A page of the assembly sheet of a kit, with a thin grey frame."""
    drawn = Image.open(BytesIO(page_pictures(kit.files["assembly_sheet.pdf"])[page - 1])).convert("RGB")
    picture = np.asarray(drawn.resize((620, 877), Image.Resampling.LANCZOS)) / 255
    for edge in (picture[:2], picture[-2:], picture[:, :2], picture[:, -2:]):
        edge[:] = 0.75
    return picture


def draw_hand() -> None:
    """The foam hand of the benchmarks, its five flexors taken in by a quarter."""
    robot = hand_robot()
    flexors = [cable for cable in robot.cables if cable.winch.endswith("flexor")]
    pulled = {cable.winch: 0.25 * float(cable.segments[cable.bare].sum()) for cable in flexors}
    save_png(draw_pose(robot, hs.Simulation(robot).solve(pulled)), HERE / "hand.png", dpi=90)


def draw_dirt() -> None:
    """The same hand as a careless scan gives it, with a hole, flipped triangles, specks and a ball, and healed."""
    clean = hand_robot().body.healing.surface
    corners, random = clean.vertices[clean.triangles], np.random.default_rng(0)
    corners = corners[np.linalg.norm(corners.mean(axis=1) - [0, -0.02, 0.05], axis=1) > 0.012]
    flipped = random.random(len(corners)) < 0.1
    corners[flipped] = corners[flipped][:, ::-1]
    balls = [_ball((0.02, 0.0, 0.02), 0.02), _ball((0.06, 0.03, 0.15), 0.003), _ball((-0.07, 0.0, 0.1), 0.003)]
    corners = np.concatenate([corners, *(ball.vertices[ball.triangles] for ball in balls)]).reshape(-1, 3)
    dirty = Surface(corners, np.arange(len(corners)).reshape(-1, 3))
    healing = heal(dirty, resolution=3e-3)
    figure = draw_healing(dirty, healing.surface, notes=healing.lines(), places=healing.places)
    save_png(figure, HERE / "healing.png", dpi=80)


def _ball(middle: tuple[float, float, float], radius: float) -> Surface:
    box = np.array([np.subtract(middle, 1.2 * radius), np.add(middle, 1.2 * radius)])
    return contour(lambda points: np.linalg.norm(points - middle, axis=1) - radius, box, radius / 6)


def draw_gallery() -> None:
    """Every flat gallery robot at rest above, in its first pose by its own hand-placed cables below."""
    rows: list[list[Figure]] = [[], []]
    for robot in _gallery(dim=2):
        reached = hs.solve_ik(hs.Simulation(robot), next(iter(robot.poses.values())))
        rows[0].append(draw_portrait(robot, robot.body.mesh.nodes, width=PORTRAIT))
        rows[1].append(draw_portrait(robot, reached.pose.nodes, width=PORTRAIT))
    save_png(_contact_sheet(rows, side=2.0), HERE / "gallery.png", dpi=110)


def draw_bodies() -> None:
    """Every gallery robot in space, a row each: at rest, then in its poses, as its own winches reach them."""
    rows, names = [], []
    for robot in _gallery(dim=3):
        simulation = hs.Simulation(robot)
        states = [robot.body.mesh.nodes]
        states += [hs.solve_ik(simulation, pose).pose.nodes for pose in robot.poses.values()]
        frame = np.concatenate([*states, [winch.at for winch in robot.winches]])
        rows.append([draw_portrait(robot, nodes, frame=frame, width=PORTRAIT) for nodes in states])
        names.append([robot.name, *robot.poses])
    save_png(_contact_sheet(rows, side=1.9, names=names), HERE / "bodies.png", dpi=90)


def draw_tendons() -> None:
    """Gallery robots of hinges, bones and disks, a row each: at rest, then in poses, by the pulls of their sheets."""
    rows, names = [], []
    for name, sheet in TENDON_SHEETS.items():
        simulation = hs.Simulation(hs.load_robot(gallery_folder(name)))
        robot, plays = simulation.robot, sheet().plays
        moved = [simulation.solve(play.controls(robot)).nodes for play in plays.values()]
        states = [robot.body.mesh.nodes, *moved]
        frame = np.concatenate([*states, *([winch.at] for winch in robot.winches)])
        rows.append([draw_portrait(robot, nodes, frame=frame, width=PORTRAIT) for nodes in states])
        names.append([name, *plays])
    save_png(_contact_sheet(rows, side=2.2, names=names), HERE / "tendons.png", dpi=110)


def _gallery(*, dim: int) -> list[hs.Robot]:
    """The robots of the gallery that are flat (2) or in space (3)."""
    robots = [hs.load_robot(gallery_folder(name)) for name in list_gallery() if name not in TENDON_SHEETS]
    return [robot for robot in robots if robot.body.mesh.dim == dim]


def _contact_sheet(rows: list[list[Figure]], *, side: float, names: list[list[str]] | None = None) -> Figure:
    """Figures side by side in squares of a side [inches], with names below them."""
    columns = max(map(len, rows))
    sheet = Figure(figsize=(side * columns, side * len(rows)), facecolor="white")
    for row, figures in enumerate(rows):
        for column, figure in enumerate(figures):
            place = (column / columns, 1 - (row + 1) / len(rows), 1 / columns, 1 / len(rows))
            below = 0.0 if names is None else 0.1 * place[3]
            axes = sheet.add_axes((place[0], place[1] + below, place[2], place[3] - below))
            axes.imshow(_pixels(figure))
            axes.set_axis_off()
            if names is not None:
                weight = "normal" if column else "bold"
                middle = (place[0] + place[2] / 2, place[1] + 0.02 * place[3])
                sheet.text(*middle, names[row][column].replace("_", " "), ha="center", fontsize=8, weight=weight)
    return sheet


def _pixels(figure: Figure) -> np.ndarray:
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=160)
    buffer.seek(0)
    return matplotlib.image.imread(buffer)


if __name__ == "__main__":
    main()
