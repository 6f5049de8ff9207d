"""Robots of hinges, bones and disks: a logarithmic spiral, a tendon finger, a spine."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bodies.sheet import Line, Play, Sheet, comment

MM = 1e-3
Corners = Sequence[tuple[float, float]]

TURN, RATIO, UNITS = 30.0, 0.9, 13
"""Spiral: turn of a hinge when its slit closes [degrees], size of a unit over the one before it, number of units."""


@dataclass(frozen=True, kw_only=True)
class FormSheet(Sheet):
    """Robot whose body is a drawing or a mesh.

    Attributes:
        file: name of the file of the body.
        content: makes the file.
        keys: lines of [body], with comments.
        blocks: tables after [body], such as parts and rods.
    """

    file: str
    content: Callable[[], bytes]
    keys: Sequence[str]
    blocks: Sequence[str] = ()

    def files(self) -> dict[str, bytes]:
        """The drawing or the mesh."""
        return {self.file: self.content()}

    def _body(self) -> list[str]:
        head = f'{comment(self.words)}\nformat = 1\nname = "{self.name}"'
        return [head, "\n".join(["[body]", *self.keys]), *self.blocks]


def drawing(corners: Corners) -> bytes:
    """SVG of a closed polygon [mm], y up, with [0, 0] in the middle of its box."""
    points = np.array(corners)
    low, high = points.min(axis=0), points.max(axis=0)
    wide, tall = (high - low).tolist()
    path = " ".join(f"{x - low[0]:.4g},{high[1] - y:.4g}" for x, y in points.tolist())
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:.6g}mm" height="{tall:.6g}mm" '
        f'viewBox="0 0 {wide:.6g} {tall:.6g}">\n<polygon points="{path}"/>\n</svg>\n'
    ).encode()


def mirrored(upper: Corners) -> Corners:
    """Polygon of its upper side, from the root to the tip, and of the same below."""
    return [*((x, -y) for x, y in upper), *reversed(upper)]


def spiral() -> Sheet:
    """Units that shrink by a factor, joined by thin hinges; when all slits close, it is a logarithmic spiral."""
    base, first, half, opening = 24.0, 20.0, 20.0, np.tan(np.radians(TURN / 2))
    sizes = RATIO ** np.arange(UNITS)
    starts = base + first * np.concatenate([[0.0], np.cumsum(sizes)])
    middle = starts[-1] / 2

    def hinge(size: float) -> float:
        return 1.1 * size ** (2 / 3)  # half the thickness: then a tension turns all hinges alike, of any size

    def wide(x: float) -> float:
        return half * (1 - (x - base) * (1 - RATIO) / first) if x > base else half

    upper = [(0.0, half)]
    lines: dict[str, list[tuple[float, float]]] = {"left": [], "right": []}
    for number, (start, end) in enumerate(pairwise(starts.tolist())):
        size = float(sizes[number])
        thin, gap = hinge(size), 0.1 * first * size  # the hinge: half its thickness and half its length
        reach = wide(start)
        upper += [
            (start - gap - (reach - thin) * opening, reach),
            (start - gap, thin),
            (start + gap, thin),
            (start + gap + (reach - thin) * opening, reach),
        ]
        at = 0.66 * reach
        inner = start - gap - (at - thin) * opening - 0.3, start + gap + (at - thin) * opening + 0.3
        if number == 0:
            lines["left"].append((1.0, at))
        lines["left"] += [(inner[0], at), (inner[1], at)]
        if number == UNITS - 1:
            lines["left"].append((end - 0.8, 0.66 * wide(end)))
    upper.append((float(starts[-1]), wide(float(starts[-1]))))
    lines["right"] = [(x, -y) for x, y in lines["left"]]
    cables = [
        Line(
            name=name,
            words=f"curls it to the {name}, which is {'+' if name == 'left' else '-'}y",
            points=[(MM * (-40 - middle), MM * 1.5 * route[0][1])] + [(MM * (x - middle), MM * y) for x, y in route],
            sheath=1,
            travel=36,
            release=36,
            stiffness=20,
        )
        for name, route in lines.items()
    ]
    return FormSheet(
        name="spiral",
        words=(
            "A logarithmic spiral after SpiRobs (Wang, Freris and Wei 2024, arXiv:2303.09861), printed in one piece of "
            f"TPU: {UNITS} units, each {RATIO:g} times as large as the one before, on hinges that close after "
            f"{TURN:g} degrees. Two cables run in holes on both sides. Lengths are in mm; [0, 0] is the middle of the "
            "drawing, x runs to the tip, y to the left."
        ),
        file="spiral.svg",
        content=lambda: drawing(mirrored(upper)),
        keys=(
            'outline = "spiral.svg"',
            'element_size = "5 mm"',
            'thickness = "20 mm"',
            'material = "tpu 85a"            # printed: the kit holds the body as STL with its holes',
            'plane = "stress"',
            'elements = "quadratic"          # hinges bend right with few elements',
        ),
        held=("the block at its root.", (-middle - 1, -21), (-middle + 8, 21)),
        winch_words='motors stand behind the root (mount = "world").',
        lines=cables,
        markers={"tip": (MM * (middle - 1), 0.0), "middle": (MM * (starts[5] + 6 - middle), 0.0)},
        marker_words="the tip, and a point half way.",
        plays={
            "curl": Play(words="It curls to the left.", contractions={"left": 34, "right": -46}),
            "hook": Play(words="A hook to the right.", contractions={"right": 16, "left": -20}),
        },
    )


BONES = {"proximal": (18.0, 58.0), "middle": (68.0, 93.0), "distal": (103.0, 122.0)}
"""Finger: from where to where a bone reaches along x, the joints between them [mm]."""


def tendon_finger() -> Sheet:
    """Three bones, three soft joints, one tendon on either side."""
    upper = [(0.0, 9.0), (10.0, 9.0)]
    ends = [(8.0, 16.0), *((a[1] + 2, b[0] - 2) for a, b in pairwise(BONES.values()))]
    halves = (9.0, 8.5, 8.0, 7.5)
    for (before, after), half, following in zip(ends, halves, halves[1:], strict=False):
        upper += [(before, half), (before + 2, 3.0), (after - 2, 3.0), (after, following)]
    upper = [corner for corner in upper if corner != (10.0, 9.0)]
    tip = [(124.0, 7.0), (127.0, 5.0), (128.5, 2.0)]
    upper += tip
    middle = 128.5 / 2
    route = [(1.0, 5.0), (6.5, 5.0)]
    for start, end in BONES.values():
        route += [(start + 1, 5.0), (end - 1, 5.0)]
    routes = {"extend": route, "flex": [(x, -y) for x, y in route]}
    parts = [
        f'[[body.part]]\nname = "{name}"\nshape = "box"\nat = [{start - middle:g}, -6]\nto = [{end - middle:g}, 6]\n'
        'rigid = true\ndensity = "1.24 g/cm^3"'
        for name, (start, end) in BONES.items()
    ]
    parts[0] = comment("The bones: rigid parts, printed of PLA. Their tendon channels are drilled.") + "\n" + parts[0]
    return FormSheet(
        name="finger",
        words=(
            "A tendon finger: three rigid bones in silicone, which is thin between them and bends there. One tendon "
            "flexes it, one extends it. Lengths are in mm; [0, 0] is the middle of the drawing, x runs to the tip, y "
            "to the back of the finger."
        ),
        file="finger.svg",
        content=lambda: drawing(mirrored(upper)),
        keys=(
            'outline = "finger.svg"',
            'element_size = "3 mm"',
            'thickness = "16 mm"',
            'material = "dragon skin 30"',
            'plane = "stress"',
            'elements = "quadratic"          # joints bend right with few elements',
        ),
        blocks=parts,
        held=("the block at the knuckle.", (-middle - 1, -10), (-middle + 6, 10)),
        winch_words='motors stand behind the knuckle (mount = "world").',
        lines=[
            Line(
                name=name,
                words="bends it to the palm" if name == "flex" else "bends it to the back",
                points=[(MM * (-35 - middle), MM * 1.6 * places[0][1])]
                + [(MM * (x - middle), MM * y) for x, y in places],
                travel=14,
                release=14,
                stiffness=20,
            )
            for name, places in routes.items()
        ],
        markers={
            "tip": (MM * (127 - middle), 0.0),
            "middle": (MM * (80.0 - middle), 0.0),
            "proximal": (MM * (38.0 - middle), 0.0),
        },
        marker_words="the tip, and the middle of two bones.",
        plays={
            "bend": Play(words="It bends to the palm.", contractions={"flex": 10, "extend": -14}),
            "stretch": Play(words="It leans back.", contractions={"extend": 5, "flex": -7}),
        },
    )


SEGMENTS, DISKS, PITCH, DISK, BASE = 3, 6, 10.0, 2.0, 12.0
"""Spine: segments, disks of a segment, their pitch and thickness, that of the base [mm]."""

AROUND, RADIUS, CIRCLE, SLEEVE, LAYERS = 12, 8.0, 6.5, 4.0, 2
"""Sides of a disk, its radius, that of the circle of tendons and of the sleeve between disks [mm]; layers of that."""


def column(disks: np.ndarray) -> bytes:
    """VTK file of tetrahedra in disks between pairs of heights [mm], and in a sleeve between them."""
    angles = 2 * np.pi * np.arange(AROUND) / AROUND
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    inner = [(0.0, 0.0), *(SLEEVE * ring).tolist()]
    whole = [*inner, *(RADIUS * ring).tolist()]
    sides = [(1 + side, 1 + (side + 1) % AROUND) for side in range(AROUND)]
    core = [(0, one, two) for one, two in sides]
    rim = [corners for i, j in sides for corners in ((i, i + AROUND, j + AROUND), (i, j, j + AROUND))]
    planes: list[tuple[float, bool]] = []  # heights, and True above a disk
    for bottom, top in disks.tolist():
        below = planes[-1][0] if planes else None
        if below is not None and below < bottom:
            planes += [(below + (bottom - below) * step / LAYERS, False) for step in range(1, LAYERS)]
        planes += [(top, True)] if below == bottom else [(bottom, False), (top, True)]
    faces = set(disks.ravel().tolist())
    nodes, elements, begins = [], [], []
    for height, _ in planes:
        begins.append(len(nodes))
        nodes += [(x, y, height) for x, y in (whole if height in faces else inner)]
    for number, (_, is_disk) in enumerate(planes[1:], start=1):
        for triangle in core + rim if is_disk else core:
            low, high = ([begin + node for node in sorted(triangle)] for begin in begins[number - 1 : number + 1])
            for cut in ([*low, high[2]], [low[0], low[1], high[1], high[2]], [low[0], *high]):
                spans = np.array([nodes[node] for node in cut[1:]]) - nodes[cut[0]]
                elements.append(cut if np.linalg.det(spans) > 0 else [cut[1], cut[0], *cut[2:]])
    places = "\n".join(" ".join(f"{value:.4f}" for value in node) for node in nodes)
    corners = "\n".join("4 " + " ".join(map(str, element)) for element in elements)
    kinds = "\n".join(["10"] * len(elements))
    return (
        "# vtk DataFile Version 3.0\nspine [mm]\nASCII\nDATASET UNSTRUCTURED_GRID\n"
        f"POINTS {len(nodes)} float\n{places}\n"
        f"CELLS {len(elements)} {5 * len(elements)}\n{corners}\nCELL_TYPES {len(elements)}\n{kinds}\n"
    ).encode()


def spine() -> Sheet:
    """Disks on an elastic rod, three tendons to the end of each segment."""
    tops = PITCH * np.arange(1, SEGMENTS * DISKS + 1)
    disks = np.stack([tops - DISK, tops], axis=1)
    parts = [
        f'[[body.part]]\nname = "{name}"\nshape = "cylinder"\nat = [0, 0, {low:g}]\nto = [0, 0, {high:g}]\n'
        f"radius = {RADIUS:g}\n"
        'rigid = true\ndensity = "1.24 g/cm^3"'
        for name, low, high in [
            ("base", -BASE, 0.0),
            *((f"disk {number}", *row) for number, row in enumerate(disks.tolist(), start=1)),
        ]
    ]
    parts[0] = comment("The base and the disks, printed of PLA.") + "\n" + parts[0]
    rod = (
        comment("The backbone: nitinol wire, glued into base and disks.")
        + f'\n[[rod]]\nname = "backbone"\npoints = [[0, 0, {-BASE:g}], [0, 0, {tops[-1]:g}]]\ndiameter = "1 mm"\n'
        'young = "60 GPa"\ntorsional_stiffness = "2300 N mm^2"   # EI / (1 + nu)'
    )
    lines, bends = [], ("its root", "its middle", "its tip")
    for segment in range(SEGMENTS):
        for tendon in range(3):
            angle = 2 * np.pi * (tendon / 3 + segment / 9)
            x, y = CIRCLE * np.cos(angle), CIRCLE * np.sin(angle)
            through = [-BASE / 2, *(tops[: DISKS * (segment + 1)] - DISK / 2)]
            lines.append(
                Line(
                    name=f"{'abc'[segment]}{tendon + 1}",
                    words=f"ends at {bends[segment]}, {np.degrees(angle):.0f} degrees about z from x",
                    points=[(4.5 * MM * x, 4.5 * MM * y, -60 * MM), *((MM * x, MM * y, MM * z) for z in through)],
                    travel=25,
                    release=25,
                    stiffness=5,
                )
            )
    return FormSheet(
        name="spine",
        words=(
            "A continuum robot: 18 disks on a backbone of wire, three segments with three tendons each, as in OpenCR "
            "of the Continuum Robotics Laboratory; sizes are round numbers, not measurements. The model needs "
            "something between the disks: a sleeve so soft (50 kPa) that the backbone carries 99.6 % of a bend. "
            "Lengths are in mm; z runs from the base to the tip."
        ),
        file="spine.vtk",
        content=lambda: column(np.array([[-BASE, -BASE / 2], [-BASE / 2, 0.0], *disks.tolist()])),
        keys=(
            'mesh = "spine.vtk"              # tetrahedra with nodes on both faces of each disk',
            'material = { young = "50 kPa", poisson = 0, density = "30 kg/m^3" }',
        ),
        blocks=(*parts, rod),
        held=("the base.", (-20, -20, -BASE - 1), (20, 20, 0.5)),
        winch_words='motors stand below the base (mount = "world").',
        lines=lines,
        markers={
            "tip": (0.0, 0.0, MM * float(tops[-1])),
            "second": (0.0, 0.0, MM * float(tops[2 * DISKS - 1])),
            "first": (0.0, 0.0, MM * float(tops[DISKS - 1])),
        },
        marker_words="ends of the three segments.",
        plays={
            "lean": Play(words="It leans to one side.", contractions={"a1": 5, "b1": 9, "c1": 12}),
            "swan": Play(words="An S: root one way, tip the other.", contractions={"a1": 8, "c2": 10}),
        },
    )
