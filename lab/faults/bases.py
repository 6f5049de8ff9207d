"""Good files of every kind that hydrostat reads, small ones, and the command or function that reads each."""

import math
import shutil
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from io import BytesIO, StringIO
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
from spoil import Spoil, spoil_archive, spoil_bytes, spoil_portable, spoil_text

_TOP = Path(__file__).resolve().parents[2]
sys.path[1:1] = [str(_TOP / "tests")]

GALLERY = ("starfish", "finger", "spine", "fish_tail", "caging_gripper", "tongue", "letter_s")

ALL_KEYS = """format = 1
name = "all"
gravity = "-y"
face = "front"
[body]
outline = "a.svg"
size = "100 mm"
element_size = "8 mm"
thickness = "20 mm"
inner = "holes"
plane = "stress"
[body.material]
name = "polyester fibre"
viscosity = "40 Pa s"
relaxation = [{ modulus = "10 kPa", time = "2 s" }]
[[body.part]]
name = "bone"
shape = "box"
at = [-18, -6]
to = [-8, 6]
rigid = true
density = "1.24 g/cm^3"
[[pin]]
box = [[-50, -15], [-42, 15]]
stiffness = "100 N/mm"
[[winch]]
name = "left"
at = [-30, 0]
spool_radius = "6 mm"
travel = "20 mm"
release = "10 mm"
[[cable]]
winch = "left"
points = [[-30, 0], [0, 6], [30, 6]]
stiffness = "4 N/mm"
slack = "1 mm"
friction = 0.2
sheathed = [[0, 1]]
[[marker]]
name = "tip"
at = [48, 0]
[[pose]]
name = "wave"
targets = { tip = [40, 20] }
[contact]
distance = "1 mm"
friction = 0.4
[[obstacle]]
name = "table"
shape = "plane"
at = [0, -60]
normal = [0, 1]
friction = 0.6
[[load]]
name = "weight"
marker = "tip"
force = ["0 N", "-1 N"]
path = [{ time = "0 s", share = 0 }, { time = "1 s", share = 1 }]
[[rod]]
name = "wire"
points = [[0, -7], [28, -7]]
diameter = "0.8 mm"
young = "200 GPa"
"""

BAR = (
    b'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="30mm" viewBox="0 0 100 30">'
    b'<style>.b{fill:#e33;stroke:none}</style><defs><circle id="eye" r="2"/></defs><g transform="translate(0 0)">'
    b'<path class="b" d="M0,15 C0,0 30,0 50,0 L95,2 A13,13 0 0 1 95,28 L50,30 C30,30 0,30 0,15 Z"/>'
    b'<use href="#eye" x="80" y="15"/></g><rect x="10" y="12" width="6" height="5" fill="white"/></svg>'
)
MOTORS = b"""# motors
[[motor]]
winch = "right"
number = 1
zero = 1.25  # [rad]
turns = 1
radius = "6 mm"
current = 0.4
curve = [[1.0, 0.006], [2.0, 0.013]]
[[motor]]
winch = "left"
number = 2
zero = 0.0
turns = -1
radius = "6 mm"
board = 1
counts = 2000.0
[[motor]]
winch = "feet"
number = 3
radius = "6 mm"
"""
MOVES = b"time_s,right_mm,left_mm,feet_mm\n" + b"".join(b"%g,%g,%g,0\n" % (t, 2 * t, t) for t in (0, 0.5, 1, 1.5, 2))
MEASURED = b"right_mm,left_mm,feet_mm,top_x_mm,top_y_mm,top_load_g\n" + b"".join(
    b"%d,0,%d,%g,120.5,0\n" % (n, n, 11 - n) for n in range(6)
)


def _ball():  # a Surface, whose room is loaded late
    from geometry.dirty import sphere

    return sphere(divisions=1)


def _dxf() -> bytes:
    import ezdxf

    document = ezdxf.new("R2010", units=4)
    space = document.modelspace()
    space.add_lwpolyline([(0, 0, 0), (80, 0, 0.4), (80, 30, 0), (0, 30, 0)], format="xyb", close=True)
    space.add_circle((20, 15), 4)
    space.add_spline([(40, 10, 0), (50, 10, 0), (45, 18, 0), (40, 10, 0)])
    stream = StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def _spoil_drawing(content: bytes, draw: np.random.Generator) -> bytes:
    """Damage what is drawn, not the tables of layers and styles, which are most of a DXF file."""
    start = content.index(b"ENTITIES")
    return content[:start] + spoil_text(content[start:], draw)


@cache
def base_files() -> dict[str, list[tuple[str, bytes]]]:
    """Good files by kind, each with its name."""
    from geometry.surface_writers import obj, off, ply_big, ply_text, stl, stl_text, threemf
    from geometry.test_mesh_file import FORMATS, written

    from hydrostat.geometry import write_ply
    from hydrostat.robot import gallery_folder, load_robot

    ball, meshes = _ball(), {}
    with tempfile.TemporaryDirectory() as place:
        for kind in FORMATS:
            path = written(Path(place), kind)
            meshes[path.name] = path.read_bytes()
    starfish = load_robot(gallery_folder("starfish"))
    robots = [(name, (gallery_folder(name) / "robot.toml").read_bytes()) for name in GALLERY]
    return {
        "robot": [*robots, *[("all", ALL_KEYS.encode())] * 6],
        "motors": [("motors.toml", MOTORS)],
        "svg": [("a.svg", BAR), ("starfish.svg", (gallery_folder("starfish") / "starfish.svg").read_bytes())],
        "dxf": [("a.dxf", _dxf())],
        "surface": [
            ("a.stl", stl(ball)), ("text.stl", stl_text(ball)), ("a.obj", obj(ball)), ("a.off", off(ball)),
            ("text.ply", ply_text(ball)), ("a.ply", write_ply(ball)), ("big.ply", ply_big(ball)),
        ],
        "3mf": [("a.3mf", threemf(ball))],
        "mesh": list(meshes.items()),
        "moves": [("moves.csv", MOVES)],
        "measured": [("measured.csv", MEASURED)],
        "model": [("a.model", _model(starfish))],
        "policy": [("a.policy", _policy())],
        "project": [("robot.zip", _project())],
    }  # fmt: skip


def _networks():  # the class of the networks of a model
    from builders import strip_robot
    from learning.plain_model import plain

    return type(plain(strip_robot()).forward)


def _model(robot) -> bytes:
    from model_cards import model_card

    from hydrostat.learning import LearnedModel

    draw, kind = np.random.default_rng(0), _networks()
    count, coordinates = len(robot.winches), 2 * len(robot.markers)
    told = coordinates + len(robot.cables)

    def networks(*sizes: int):
        numbers = draw.normal(size=(2, kind.count(np.array(sizes)))).astype(np.float32)
        return kind(sizes=np.array(sizes), numbers=numbers.astype(float))

    model = LearnedModel(
        card=model_card(robot), low=np.zeros(count), high=np.full(count, 0.06), middle=np.zeros(told),
        unit=np.ones(told), forward=networks(count, 5, told), inverse=networks(coordinates, 5, count),
        known=np.zeros((3, count)), reached=np.zeros((3, coordinates)),
    )  # fmt: skip
    with tempfile.TemporaryDirectory() as place:
        return model.save(Path(place) / "a.model").read_bytes()


def _policy() -> bytes:
    from hydrostat.learning import PortablePolicy

    sizes, kind = np.array([5, 4, 3]), _networks()
    numbers = np.random.default_rng(0).normal(size=(1, kind.count(sizes)))
    facts = {"task": "reach", "robot": "a", "physics": "0", "sees": [["goal", 2], ["places", 3]], "actions": 3}
    policy = PortablePolicy(facts=facts | {"error": 0.001}, network=kind(sizes=sizes, numbers=numbers))
    with tempfile.TemporaryDirectory() as place:
        return policy.save(Path(place) / "a.policy").read_bytes()


def _project() -> bytes:
    from hydrostat.control import Key, Timeline
    from hydrostat.project import Wishes, write_project_file
    from hydrostat.robot import gallery_folder

    stream = BytesIO()
    with tempfile.TemporaryDirectory() as place, ZipFile(stream, "w", ZIP_DEFLATED) as archive:
        keys = tuple(Key(time=float(t), contractions={"left": 0.001 * t}) for t in range(3))
        write_project_file(Path(place), Timeline(keys=keys), Wishes())
        for path in (*sorted(gallery_folder("starfish").iterdir()), Path(place) / "studio.json"):
            archive.write(path, f"starfish/{path.name}")
    return stream.getvalue()


KINDS: dict[str, Spoil] = {
    "robot": spoil_text,
    "motors": spoil_text,
    "svg": spoil_text,
    "dxf": _spoil_drawing,
    "surface": lambda content, draw: (spoil_text if content.isascii() else spoil_bytes)(content, draw),
    "3mf": spoil_archive,
    "mesh": lambda content, draw: (spoil_text if content.isascii() else spoil_bytes)(content, draw),
    "moves": spoil_text,
    "measured": spoil_text,
    "model": spoil_portable,
    "policy": spoil_portable,
    "project": spoil_archive,
}
"""How files of each kind are damaged."""


def give(kind: str, name: str, content: bytes, folder: Path) -> Callable[[], object]:
    """Write a spoiled file into a folder; returns the work that reads it there."""
    from faults import command

    if kind == "robot":
        from hydrostat.robot import gallery_folder

        (folder / "robot").mkdir()
        (folder / "robot" / "a.svg").write_bytes(BAR)
        for path in () if name == "all" else gallery_folder(name).iterdir():
            shutil.copy(path, folder / "robot")
        (folder / "robot" / "robot.toml").write_bytes(content)
        if name == "all":
            return command("simulate", "robot", "--contract", "left=3mm", "--timeout", "20s", "--out", "made")
        return command("check", "robot")
    path = folder / name
    path.write_bytes(content)
    if kind in ("svg", "dxf", "surface", "3mf", "mesh"):
        size = () if kind == "mesh" else ("--size", "100mm", "--nodes", "150")
        return command("new", "made", "--from", name, *size)
    return lambda: _read(kind, path)


def _read(kind: str, path: Path) -> None:
    """Read a file by the function that commands and the studio call, and use what it gives."""
    from hydrostat.cli.main import _stop
    from hydrostat.errors import HydrostatError, InputError

    try:
        _READERS[kind](path)
    except InputError as error:
        _stop(f"error: {error}", 2)
    except HydrostatError as error:
        _stop(f"error: {error}", 1)


def _starfish():
    from hydrostat.robot import gallery_folder, load_robot

    return load_robot(gallery_folder("starfish"))


def _motors(path: Path) -> None:
    from hydrostat.control import Calibration

    robot = _starfish()
    found = Calibration.read(path.parent, robot).assume_zeros(robot)
    found.contractions(found.angles(np.full(3, 0.01)))


def _moves(path: Path) -> None:
    from hydrostat.control import Timeline
    from hydrostat.simulation import ProfileTable

    table = ProfileTable.open(path, _starfish())
    table.profile.at(0.7)
    Timeline.read(_starfish(), path.name, path.read_bytes())


def _measured(path: Path) -> None:
    from hydrostat.identification import read_measurements

    read_measurements(path, _starfish())


def _use_model(path: Path) -> None:
    from hydrostat.learning import LearnedModel

    model, robot = LearnedModel.load(path), _starfish()
    model.check(robot)
    answer = model.solve(robot.poses["wave"])
    if not math.isfinite(answer.error):
        raise ValueError("the model answers with no number")


def _use_policy(path: Path) -> None:
    from hydrostat.learning import PortablePolicy

    PortablePolicy.load(path).act({"goal": np.zeros(2), "places": np.zeros(3)})


def _unpack(path: Path) -> None:
    from studio.starting.uploads import unpack

    unpack(path)


_READERS = {
    "motors": _motors,
    "moves": _moves,
    "measured": _measured,
    "model": _use_model,
    "policy": _use_policy,
    "project": _unpack,
}
