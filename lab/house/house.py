"""How large the house is, and how many of its files six flows enter; prints the tables, for this tree or another.

    python lab/house/house.py [--tree PATH] [--seconds] [--no-flows]

A file is entered if a function or method that stands in it is called during the flow; importing it is not entering it.
Loading the example, building its simulation and opening the studio come before the flow, except for the flow that
begins with a drawing, which reads the robot of an outline, meshes it, and solves one pose. With --seconds the tests are
collected, and run on two cores, which takes minutes.
"""

import argparse
import ast
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from types import FrameType
from typing import Any

HERE = Path(__file__).resolve().parents[2]
Function = ast.FunctionDef | ast.AsyncFunctionDef
Flow = tuple[Callable[[], Any], Callable[[Any], object]]
"""What is prepared, and what is followed."""


def code_lines(lines: list[str], function: Function) -> int:
    """Lines of a function without its docstring, blank lines and comments."""
    first = function.body[0] if ast.get_docstring(function) is not None else None
    told = range(first.lineno, (first.end_lineno or 0) + 1) if first else ()
    own = enumerate(lines[function.lineno - 1 : function.end_lineno], function.lineno)
    return sum(number not in told and bool(line.strip()) and line.strip()[0] != "#" for number, line in own)


def energy_names(trees: list[ast.Module]) -> set[str]:
    """Names of Energy and of all classes that are one."""
    classes = [node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]
    known = {"Energy"}
    while more := {node.name for node in classes if {ast.unparse(base) for base in node.bases} & known} - known:
        known |= more
    return known


def asks(tree: ast.Module, energies: set[str]) -> int:
    """How often a file asks by isinstance what kind of energy one is."""
    calls = (node for node in ast.walk(tree) if isinstance(node, ast.Call) and ast.unparse(node.func) == "isinstance")
    return sum(bool(set(re.findall(r"\w+", ast.unparse(call.args[1]))) & energies) for call in calls)


def sizes(tree: Path) -> list[tuple[str, str]]:
    """The figures of a tree that are read off its text."""
    texts = {file: file.read_text(encoding="utf-8") for file in sorted((tree / "hydrostat").rglob("*.py"))}
    modules = {file: ast.parse(text) for file, text in texts.items()}
    files = {file: len(text.splitlines()) for file, text in texts.items() if file.name != "__init__.py"}
    functions = {
        f"{node.name} in {file.relative_to(tree / 'hydrostat')}": code_lines(texts[file].splitlines(), node)
        for file, module in modules.items()
        for node in ast.walk(module)
        if isinstance(node, Function)
    }
    classes = Counter(
        node.name for module in modules.values() for node in module.body if isinstance(node, ast.ClassDef)
    )
    energies = energy_names(list(modules.values()))
    outside = {file: module for file, module in modules.items() if "mechanics" not in file.parts}
    largest, longest = max(files, key=files.__getitem__), max(functions, key=functions.__getitem__)
    return [
        ("modules, without __init__", str(len(files))),
        ("lines of all files", str(sum(len(text.splitlines()) for text in texts.values()))),
        ("median file [lines]", f"{median(files.values()):g}"),
        ("largest file [lines]", f"{files[largest]} ({largest.relative_to(tree / 'hydrostat')})"),
        ("median function [code lines]", f"{median(functions.values()):g}"),
        ("largest function [code lines]", f"{functions[longest]} ({longest})"),
        ("class names that stand twice", str(sum(count > 1 for count in classes.values()))),
        ("isinstance on energies outside mechanics", str(sum(asks(module, energies) for module in outside.values()))),
    ]


def seconds(tree: Path) -> Iterator[tuple[str, str]]:
    """How long the tests take to collect, and to run on two cores."""
    for name, options in (("collection", ["--collect-only"]), ("make test", ["-n", "2", "--dist", "worksteal"])):
        before = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", *options], cwd=tree, capture_output=True, text=True, check=False
        )
        last = (done.stdout.strip().splitlines() or ["nothing"])[-1]
        yield f"{name} [s]", f"{time.perf_counter() - before:.0f} ({last.strip('= ')})"


@contextmanager
def entered(package: Path) -> Iterator[set[str]]:
    """Files of the package whose functions are called."""
    codes = set()

    def note(frame: FrameType, event: str, _: object) -> None:
        if event == "call":
            codes.add(frame.f_code)

    files: set[str] = set()
    threading.setprofile(note)
    sys.setprofile(note)
    try:
        yield files
    finally:
        sys.setprofile(None)
        threading.setprofile(None)  # type: ignore[arg-type]
        inside = str(package) + os.sep
        files |= {code.co_filename for code in codes if code.co_name != "<module>"}
        files -= {file for file in files if not file.startswith(inside) or file.endswith("__init__.py")}


def scan(folder: Path) -> Path:
    """A box of 60 x 20 x 20 mm as a file of triangles, one missing and one turned over, each side in a grid."""
    import numpy as np

    size, faces = np.array([60.0, 20.0, 20.0]), []
    for axis in range(3):
        across, up = (axis + 1) % 3, (axis + 2) % 3
        for level in (0.0, 1.0):
            for i in range(6):
                for j in range(6):
                    square = np.zeros((4, 3))
                    square[:, axis] = level
                    square[:, across] = np.array([i, i + 1, i + 1, i]) / 6
                    square[:, up] = np.array([j, j, j + 1, j + 1]) / 6
                    order = [(0, 1, 2), (0, 2, 3)] if level else [(0, 2, 1), (0, 3, 2)]
                    faces += [square[list(corners)] * size for corners in order]
    faces[40] = faces[40][::-1]
    triangles = ["facet normal 0 0 0\nouter loop"] + [
        "\n".join("vertex {:g} {:g} {:g}".format(*corner) for corner in face) for face in faces[1:]
    ]
    text = "\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\n".join(triangles[1:])
    file = folder / "scan.stl"
    file.write_text(f"solid scan\n{triangles[0]}\n{text}\nendloop\nendfacet\nendsolid scan\n")
    return file


def flows(folder: Path) -> dict[str, Flow]:
    """Six ways through the house, by its public names and the studio's session."""
    import hydrostat as hs
    from hydrostat.robot import gallery_folder

    starfish = gallery_folder("starfish")

    def drag_begun() -> object:
        from hydrostat.studio import Session

        session = Session()
        session.open_folder(starfish)
        return session

    def drag(session: Any) -> object:
        from hydrostat.studio import Hit

        at = next(marker.at for marker in session.document.robot.markers if marker.name == "top")
        session.grab("screen", Hit(key="marker:top", world=at))
        for share in range(1, 6):
            session.drag("screen", Hit(world=(at[0] + 0.004 * share, at[1] - 0.001 * share)))
            session.step(0.02 * share)
        session.release("screen")
        return session

    def load() -> object:
        return hs.load_robot(starfish)

    def pose_drawing(folder: Path) -> object:
        return hs.Simulation(hs.load_robot(folder)).solve({"left": 0.012})

    def mesh(content: bytes) -> object:
        from hydrostat.robot import SurfaceSketch

        return SurfaceSketch.of_scan(content, file="scan.stl", name="scan")

    return {
        "drawing to pose": (lambda: starfish, pose_drawing),
        "pose to contractions": (
            lambda: hs.Simulation(load()),
            lambda simulation: hs.solve_ik(simulation, simulation.robot.poses["wave"]),
        ),
        "design": (load, lambda robot: hs.design_cables(robot, [robot.poses["wave"]], winches=2, cables=4)),
        "kit": (load, hs.build_kit),
        "drag": (drag_begun, drag),
        "scan to mesh": (lambda: scan(folder).read_bytes(), mesh),
    }


def walk(name: str) -> list[str]:
    """Files that one flow enters in the tree that is imported."""
    import hydrostat

    package = Path(hydrostat.__file__).parent
    with tempfile.TemporaryDirectory() as folder:
        prepare, follow = flows(Path(folder))[name]
        given = prepare()
        with entered(package) as files:
            follow(given)
    return sorted(str(Path(file).relative_to(package)) for file in files)


def walks(tree: Path) -> Iterator[tuple[str, str]]:
    """Number of files that each flow enters, each in a process of its own."""
    for name in ("drawing to pose", "pose to contractions", "design", "kit", "drag", "scan to mesh"):
        command = [sys.executable, str(Path(__file__).resolve()), "--walk", name]
        environment = {**os.environ, "PYTHONPATH": str(tree)}
        done = subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, check=False)
        last = (done.stderr.strip().splitlines() or ["?"])[-1]
        yield f"files entered: {name}", last if done.returncode else str(len(json.loads(done.stdout.splitlines()[-1])))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tree", type=Path, default=HERE)
    parser.add_argument("--seconds", action="store_true")
    parser.add_argument("--no-flows", action="store_true")
    parser.add_argument("--walk", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.walk:
        print(json.dumps(walk(options.walk)))
        return
    tree = options.tree.resolve()
    print(f"| {tree.name} | |\n|---|---|")
    parts = [sizes] + [walks] * (not options.no_flows) + [seconds] * options.seconds
    for part in parts:
        for what, figure in part(tree):
            print(f"| {what} | {figure} |", flush=True)


if __name__ == "__main__":
    main()
