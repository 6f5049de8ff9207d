"""Files made to hurt, each given to `hydrostat new`: answered in one line, within 20 s and 2 GB, or made a robot of.

    python benchmarks/strangers.py [NAME ...] [--keep FOLDER]

Prints a row a file: how it ended, seconds, largest memory, the line. The exit code is 1 if one took longer or more.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from machine import machine

SECONDS, GIGABYTES, GIVEN_UP = 20.0, 2.0, 90.0
SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">%s</svg>'


def _path(points: np.ndarray) -> str:
    return "M" + " L".join(f"{x:.4f},{y:.4f}" for x, y in points) + " Z"


def _drawn(points: np.ndarray) -> bytes:
    return (SVG % f'<path d="{_path(points)}"/>').encode()


def spiral(count: int = 30_000) -> bytes:
    """A band that winds 60 times about the middle, each edge of so many points."""
    turn = np.linspace(2 * np.pi, 122 * np.pi, count)
    inner, outer = (np.column_stack([r * np.cos(turn), r * np.sin(turn)]) for r in (0.12 * turn, 0.12 * turn + 0.3))
    return _drawn(np.concatenate([inner, outer[::-1]]) + 50)


def zigzag(count: int) -> bytes:
    """A comb of so many points."""
    x = np.linspace(0, 100, count)
    return _drawn(np.column_stack([np.r_[x, x[::-1]], np.r_[np.where(np.arange(count) % 2, 60, 90), 0 * x]]))


def closes(count: int) -> bytes:
    """A path that is closed again and again."""
    return (SVG % f'<path d="M0,0 L90,0 L90,90 {"Z" * count}"/>').encode()


def clones() -> bytes:
    """A path that is used by what is used by what is used: 80,000 points."""
    ring = _path(50 + 40 * np.column_stack([f(np.linspace(0, 6.28, 80)) for f in (np.cos, np.sin)]))
    levels = "".join(f'<g id="g{level + 1}">' + f'<use href="#g{level}"/>' * 10 + "</g>" for level in range(3))
    text = f'<path id="g0" d="{ring}"/>{levels}'
    return (SVG % text).encode()


def styles() -> bytes:
    """Ten megabytes of style sheet before a disc."""
    rules = "".join(f".a{number}{{fill:red}}" for number in range(600_000))
    return (SVG % f'<style>{rules}</style><circle cx="50" cy="50" r="40"/>').encode()


def sheet(rules: str) -> bytes:
    """A style sheet before a disc."""
    return (SVG % f'<style>{rules}</style><circle cx="50" cy="50" r="40"/>').encode()


def stl(triangles: np.ndarray) -> bytes:
    """Triangles as binary STL."""
    records = np.zeros(len(triangles), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    records["v"] = triangles
    return b"\0" * 80 + np.uint32(len(triangles)).tobytes() + records.tobytes()


def fan(count: int) -> bytes:
    """Triangles that all share one edge."""
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    tips = np.column_stack([50 * np.cos(angle), 50 * np.sin(angle), np.full(count, 25.0)])
    return stl(np.stack([np.zeros((count, 3)), np.tile([0.0, 0.0, 50.0], (count, 1)), tips], axis=1))


def soup(count: int, size: float) -> bytes:
    """Triangles at random, each so large."""
    draw = np.random.default_rng(0)
    return stl(draw.uniform(0, 100, (count, 1, 3)) + size * draw.standard_normal((count, 3, 3)))


def _cube() -> np.ndarray:
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
    return np.array([[corners[quad[i]] for i in side] for quad in quads for side in ((0, 1, 2), (0, 2, 3))])


def nested(count: int) -> bytes:
    """Cubes within cubes."""
    sizes = np.linspace(1, 100, count)[:, None, None, None]
    return stl(((_cube() - 0.5)[None] * sizes).reshape(-1, 3, 3))


def overlapping(count: int) -> bytes:
    """Cubes here and there, over one another."""
    places = np.random.default_rng(0).uniform(0, 60, (count, 1, 1, 3))
    return stl((30 * _cube()[None] + places).reshape(-1, 3, 3))


def box(count: int) -> bytes:
    """A ready mesh of a box of so many nodes along each side."""
    from itertools import permutations

    grid = np.stack(np.meshgrid(*[np.arange(count)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = np.stack(np.meshgrid(*[np.arange(count - 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    stride, elements = np.array([count * count, count, 1]), []
    for order in permutations(range(3)):
        steps = np.cumsum(np.eye(3, dtype=int)[list(order)], axis=0)
        corners = [cells, *(cells + step for step in steps)]
        tetrahedra = np.stack([corner @ stride for corner in corners], axis=1)
        turned = np.linalg.det(np.diff(np.stack([0 * steps[0], *steps]), axis=0)) < 0
        elements.append(tetrahedra[:, [0, 1, 3, 2]] if turned else tetrahedra)
    found = np.concatenate(elements)
    rows = np.column_stack([np.full(len(found), 4), found])
    head = f"# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(grid)} float\n"
    points = "\n".join(" ".join(map(str, point)) for point in (5.0 * grid).tolist())
    cells_text = "\n".join(" ".join(map(str, row)) for row in rows.tolist())
    types = "\n".join(["10"] * len(found))
    return (
        f"{head}{points}\nCELLS {len(found)} {rows.size}\n{cells_text}\nCELL_TYPES {len(found)}\n{types}\n"
    ).encode()


def dxf(kind: str) -> bytes:
    """A drawing with bulges, or with splines whose weights are odd."""
    if kind == "bulge":
        corners = "".join(
            f"10\n{x}\n20\n{y}\n42\n{bulge}\n"
            for x, y, bulge in ((0, 0, 1e-15), (90, 0, 0.4), (90, 60, 0), (0, 60, 1e9))
        )
        entity = f"0\nLWPOLYLINE\n100\nAcDbEntity\n8\n0\n100\nAcDbPolyline\n90\n4\n70\n1\n{corners}"
    else:
        knots = "".join(f"40\n{knot}\n" for knot in (0, 0, 0, 0, 1, 2, 2, 2, 2))
        weights = "".join(f"41\n{weight}\n" for weight in (1, 0, 2, 1, 1))
        points = "".join(f"10\n{x}\n20\n{y}\n30\n0\n" for x, y in ((0, 0), (80, 0), (80, 80), (0, 80), (0, 0)))
        entity = (
            "0\nSPLINE\n100\nAcDbEntity\n8\n0\n100\nAcDbSpline\n70\n12\n71\n3\n72\n9\n73\n5\n74\n0\n"
            f"{knots}{weights}{points}"
        )
    head = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n"
    return f"{head}0\nSECTION\n2\nENTITIES\n{entity}0\nENDSEC\n0\nEOF\n".encode()


GIANT = 6_000_000_000  # bytes of files that are nothing but a hole

FILES: dict[str, Callable[[], bytes] | None] = {
    "spiral.svg": spiral,
    "z_1M.svg": lambda: closes(1_000_000),
    "z_10M.svg": lambda: closes(10_000_000),
    "zigzag_190k.svg": lambda: zigzag(95_000),
    "use_href3.svg": clones,
    "css_10M.svg": styles,
    "fan_200k.stl": lambda: fan(200_000),
    "soup_big_20000.stl": lambda: soup(20_000, 30.0),
    "soup_big_200000.stl": lambda: soup(200_000, 30.0),
    "soup_small_500000.stl": lambda: soup(500_000, 0.5),
    "cubes_nested_5000.stl": lambda: nested(5000),
    "cubes_overlap_3000.stl": lambda: overlapping(3000),
    "box_29k.vtk": lambda: box(31),
    "bulge.dxf": lambda: dxf("bulge"),
    "splines_w.dxf": lambda: dxf("splines"),
    "css_open.svg": lambda: sheet("a{" * 40_000),
    "css_spaces.svg": lambda: sheet("a" + " " * 99_000),
    "css_comments.svg": lambda: sheet("/*" * 49_000),
    "viewbox_none.svg": lambda: sheet("").replace(b"0 0 100 100", b"0 0 0 0"),
    **dict.fromkeys(("giant.stl", "giant.obj", "giant.vtk", "giant.png", "giant.svg")),
}
"""What makes each; None: a sparse giant."""


def make(name: str, folder: Path) -> Path:
    """Write one of the files."""
    path, content = folder / name, FILES[name]
    if content is None:
        with path.open("wb") as file:
            file.truncate(GIANT)
    else:
        path.write_bytes(content())
    return path


def offer(path: Path, folder: Path) -> tuple[str, float, float, str]:
    """How `hydrostat new` ended with a file, seconds, gigabytes, and the last line that it said."""
    run = "from hydrostat.cli.main import main; main()"
    command = [sys.executable, "-c", run, "new", str(folder / f"of_{path.stem}"), "--from", str(path)]
    if path.suffix in (".png", ".dxf", ".vtk"):
        command += ["--size", "100 mm"]
    told, errors, began = folder / "told.txt", folder / "errors.txt", time.monotonic()
    with told.open("wb") as out, errors.open("wb") as file:
        child = subprocess.Popen(command, stdout=out, stderr=file, start_new_session=True)
        while True:
            done, status, usage = os.wait4(child.pid, os.WNOHANG)
            if done:
                break
            if time.monotonic() - began > GIVEN_UP:
                os.killpg(child.pid, 9)
                _, status, usage = os.wait4(child.pid, 0)
                break
            time.sleep(0.05)
    lines = [line for line in errors.read_text(errors="replace").splitlines() if line]
    code = os.waitstatus_to_exitcode(status)
    words = {0: "made", 2: "refused"}.get(code, f"BROKE {code}")
    if len(lines) != (code == 2):
        words += f", {len(lines)} LINES"
    error = (lines or told.read_text(errors="replace").splitlines() or [""])[-1].replace(str(path), path.name)
    return words, time.monotonic() - began, usage.ru_maxrss / 1e6, error


def main() -> int:
    """Offer all files."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--keep", type=Path, help="folder for the files")
    options = parser.parse_args()
    print(machine())
    worst = 0
    with tempfile.TemporaryDirectory() as place:
        folder = options.keep or Path(place)
        folder.mkdir(parents=True, exist_ok=True)
        print("| file | how it ended | s | GB | told |\n|---|---|---|---|---|")
        for name in options.names or FILES:
            path = make(name, folder)
            words, seconds, memory, error = offer(path, Path(place))
            path.unlink()
            print(f"| {name} | {words} | {seconds:.1f} | {memory:.2f} | {error[:150]} |", flush=True)
            worst |= seconds > SECONDS or memory > GIGABYTES or words not in ("made", "refused")
    return int(worst)


if __name__ == "__main__":
    sys.exit(main())
