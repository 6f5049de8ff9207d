"""Robot of legs on servos, after Emio."""

from itertools import permutations

import numpy as np

from bodies.sheet import Play, comment
from bodies.tendons import FormSheet

LEGS = ("front", "left", "back", "right")
"""Legs, counted about z from x."""

WIDTH, THICK, DEEP, AXIS, ROOT, HELD = 8.0, 6.0, 140.0, 90.0, 105.0, 10.0
"""Section of a leg, depth of the connector below the servos, radii of their axes and of the roots of the legs, length
of a root [mm]."""

CELLS, ROOT_CELLS = 38, 2
"""Cells along the free length of a leg and along its root."""


def center_line() -> tuple[np.ndarray, np.ndarray]:
    """Points (r, z) [mm] from the connector out and up to the root, a quarter of an ellipse, and unit normals."""
    fine = np.linspace(0, np.pi / 2, 2001)
    wide = ROOT - WIDTH / 2
    curve = np.column_stack([WIDTH / 2 + wide * np.sin(fine), -DEEP * np.cos(fine)])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    angles = np.interp(np.linspace(0, along[-1], CELLS + 1), along, fine)
    points = np.column_stack([WIDTH / 2 + wide * np.sin(angles), -DEEP * np.cos(angles)])
    tangents = np.column_stack([wide * np.cos(angles), DEEP * np.sin(angles)])
    heights = np.linspace(0, HELD, ROOT_CELLS + 1)[1:]
    points = np.concatenate([points, np.column_stack([np.full(ROOT_CELLS, ROOT), heights])])
    tangents = np.concatenate([tangents, np.tile([0.0, 1.0], (ROOT_CELLS, 1))])
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    return points, np.column_stack([-tangents[:, 1], tangents[:, 0]])


def legs() -> tuple[np.ndarray, np.ndarray]:
    """Nodes [mm] and tetrahedra of four legs on a block, which they meet face to face."""
    points, normals = center_line()
    across, away = 0.5 * WIDTH * np.array([-1, 1]), 0.5 * THICK * np.array([-1, 1])
    rows = points[:, None] + away[None, :, None] * normals[:, None]
    grid = np.stack(np.broadcast_arrays(rows[:, None, :, 0], across[None, :, None], rows[:, None, :, 1]), axis=-1)
    nodes, elements, faces = [np.zeros((0, 3))], [], []
    numbers = np.arange(grid[..., 0].size).reshape(grid.shape[:3])
    for number in range(4):
        turn = np.linalg.matrix_power(np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), number)
        own = numbers + number * numbers.size
        nodes.append(grid.reshape(-1, 3) @ turn.T)
        for order in permutations(range(3)):  # six tetrahedra along the diagonal of each cell
            corners = np.concatenate([np.zeros((1, 3), int), np.cumsum(np.eye(3, dtype=int)[list(order)], axis=0)])
            cut = [own[i : i + len(own) - 1, j, k] for i, j, k in corners]
            elements.append(np.stack(cut, axis=-1))
        near = own[0]
        faces += [[near[0, 0], near[1, 0], near[1, 1]], [near[0, 0], near[1, 1], near[0, 1]]]
    places = np.concatenate([*nodes, [[0.0, 0.0, -DEEP]]])
    _, first, same = np.unique(places.round(6), axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    renamed = np.argsort(order)[same.ravel()]
    places = places[first[order]]
    sides = renamed[np.array(faces)]
    for high in (False, True):
        ring = np.unique(sides[(places[sides, 2] > -DEEP).any(axis=1)])
        ring = ring[(places[ring, 2] > -DEEP) == high]
        ring = ring[np.argsort(np.arctan2(places[ring, 1], places[ring, 0]))]
        sides = np.concatenate([sides, [ring[[0, 1, 2]], ring[[0, 2, 3]]]])
    center = np.full((len(sides), 1), renamed[-1])
    cells = np.concatenate([*(renamed[cut] for cut in elements), np.hstack([sides, center])])
    spans = places[cells[:, 1:]] - places[cells[:, :1]]
    return places, np.where((np.linalg.det(spans) < 0)[:, None], cells[:, [0, 1, 3, 2]], cells)


def legs_file() -> bytes:
    """VTK file of the legs and their connector."""
    nodes, elements = legs()
    places = "\n".join(" ".join(f"{value + 0.0:.4f}" for value in node) for node in nodes.round(4))
    corners = "\n".join("4 " + " ".join(map(str, element)) for element in elements)
    return (
        "# vtk DataFile Version 3.0\nemio [mm]\nASCII\nDATASET UNSTRUCTURED_GRID\n"
        f"POINTS {len(nodes)} float\n{places}\n"
        f"CELLS {len(elements)} {5 * len(elements)}\n{corners}\nCELL_TYPES {len(elements)}\n"
        + "\n".join(["10"] * len(elements))
        + "\n"
    ).encode()


class ServoSheet(FormSheet):
    """Robot whose pins are turned by servos; it has no winches and no cables."""

    def _pin(self) -> str:
        blocks = []
        for number, name in enumerate(LEGS):
            way = np.round([np.cos(np.pi / 2 * number), np.sin(np.pi / 2 * number)]).astype(int)
            aside = np.array([-way[1], way[0]])
            ends = np.array([[*(ROOT * way + side * 6), high] for side, high in ((-1, -0.1), (1, HELD + 1))])
            at, axis = [*(AXIS * way), 0], [*aside, 0]
            low, high = ends.min(axis=0), ends.max(axis=0)
            blocks.append(
                f'[[pin]]\nbox = [{_list(low)}, {_list(high)}]\nstiffness = "10000 N/mm"\ndrive = "{name}"\n\n'
                f'[[drive]]\nname = "{name}"\nat = {_list(at)}\naxis = {_list(axis)}\nmin = "-40 deg"\nmax = "40 deg"'
            )
        opening = "The servos: each turns the root of its leg; a positive angle moves it down."
        return comment(opening) + "\n" + "\n\n".join(blocks)

    def _winches(self) -> list[str]:
        return []

    def _cables(self) -> list[str]:
        return []


def _list(values: object) -> str:
    return f"[{', '.join(f'{value:g}' for value in np.array(values, dtype=float).tolist())}]"


def emio() -> ServoSheet:
    """Four legs of TPU on servos, joined by a connector."""
    return ServoSheet(
        name="emio",
        words=(
            "Four legs of TPU on four servos, joined by a connector, after Emio of SofaComplianceRobotics; sizes are "
            "round numbers, not measurements. Emio's straight legs are bent as they are joined to a rigid connector; "
            "these are printed bent, in one piece with theirs, and rest without stress. Lengths are in mm; z is up, "
            "the servos are at z = 0."
        ),
        file="emio.vtk",
        content=legs_file,
        keys=(
            f'mesh = "emio.vtk"               # tetrahedra, one cell of {WIDTH:g} x {THICK:g} mm across a leg',
            'material = "tpu 85a"            # printed in one piece',
            'elements = "quadratic"          # legs bend right with one element across',
        ),
        held=("", (), ()),
        winch_words="",
        lines=(),
        markers={"tip": (0.0, 0.0, -1e-3 * DEEP)},
        marker_words="the middle of the connector.",
        plays={
            "down": Play(words="All legs push down.", contractions=dict.fromkeys(LEGS, 25)),
            "aside": Play(words="Two legs lean, two follow.", contractions={"front": 25, "back": -25}),
        },
    )
