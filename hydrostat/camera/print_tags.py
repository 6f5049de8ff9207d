"""`tags_pdf`, `tag_files`: pages to print: the sheets of the board, a tag for each marker, and where the tags go."""

import json
import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from shapely import MultiLineString, Polygon, box

from hydrostat.arrays import Points
from hydrostat.camera.tags import (
    CELLS,
    MARKER_SIDE,
    ON_SHEET,
    SHEETS,
    SIDE,
    board_corners,
    marker_tags,
    tag_cells,
)
from hydrostat.errors import InputError
from hydrostat.fabrication import PAPERS, Paper
from hydrostat.robot import Body, Robot
from hydrostat.units import MILLIMETERS

MARGIN = 12.0
"""White edge of a page [mm]."""

GAP, NAME = 5.0, 4.0
"""Distance of labels, and height of the name on each [mm]."""

LETTER, LINE = 1.55, 3.4
"""Width of a letter of a label on the map, with some to spare, and height of its line [mm]."""

OVERHANG = 0.5
"""Share of a label on the body below which it bends or peels."""

MIN_SIDE, MAX_SIDE = 4e-3, 80e-3
"""Sides that a marker's tag may have [m]."""

STEPS = (
    "Print all pages at 100 % (actual size). Measure the bar of 100 mm on each page.",
    "Glue the sheets of the board to a flat plate, such as glass or a shelf board. Leave their white rims.",
    "Cut out the tags along the gray lines. Keep the white rim around the black square.",
    "Stick each tag with its center on the marker of its name, face to the camera.",
)


def tags_pdf(robot: Robot, paper: Paper = Paper.A4, side: float = MARKER_SIDE) -> bytes:
    """Return pages with the board and the marker tags, in true size, and a page with the tag positions.

    Args:
        robot: robot to measure.
        paper: paper size of the printer.
        side: side of the black square of a marker's tag [m].

    Raises:
        InputError: a side that is too small or too large.
    """
    import typst  # Imported here: a measurement sets no page.

    return typst.compile(tags_source(robot, paper, side).encode(), format="pdf", ignore_system_fonts=True)


def find_overhangs(robot: Robot, side: float = MARKER_SIDE) -> list[str]:
    """Return the markers of a flat robot whose tags, with their white margins, lie less than half on the body.

    Args:
        robot: robot to measure.
        side: side of the black square of a marker's tag [m].
    """
    outline = robot.body.outline
    if outline is None:
        return []
    half = side * (CELLS + 2) / CELLS / 2
    on_body = {
        marker.name: outline.polygon.intersection(box(x - half, y - half, x + half, y + half)).area / (2 * half) ** 2
        for marker in robot.markers
        for x, y in [marker.at[:2]]
    }
    return [name for name, share in on_body.items() if share < OVERHANG]


def tag_files(robot: Robot, paper: Paper) -> dict[str, bytes]:
    """Return the tag pages as files of a kit, by path; none for a robot without markers."""
    return {"tags.pdf": tags_pdf(robot, paper)} if robot.markers else {}


def tags_source(robot: Robot, paper: Paper, side: float) -> str:
    """Pages as typst reads them."""
    if not MIN_SIDE <= side <= MAX_SIDE:
        low, high = MILLIMETERS * MIN_SIDE, MILLIMETERS * MAX_SIDE
        raise InputError(f"--tag {MILLIMETERS * side:g} mm: must be {low:g} to {high:g} mm")
    width, height = PAPERS[paper]
    sheets = count_sheets(robot)
    pages = [_board_page(robot, sheet, sheets, (width, height)) for sheet in range(sheets)]
    pages += _marker_pages(robot, side, (width, height))
    pages.append(_map_page(robot, side, (width, height)))
    head = [
        f"#set document(title: {json.dumps(f'{robot.name} - tags')}, date: none)",
        f"#set page(width: {width}mm, height: {height}mm, margin: 0mm)",
        '#set text(font: "Libertinus Serif", size: 10pt, lang: "en")',
        "#let at(x, y, body) = place(top + left, dx: x * 1mm, dy: y * 1mm, body)",
    ]
    return "\n".join([*head, "\n#pagebreak()\n".join(pages)])


def count_sheets(robot: Robot) -> int:
    """Sheets of the board that stay in sight around a robot: one beside a small one, up to four around a large one."""
    size = robot.body.mesh.size
    return 1 if size < 0.12 or robot.body.mesh.dim == 3 else 2 if size < 0.25 else SHEETS


def _board_page(robot: Robot, sheet: int, sheets: int, paper: tuple[float, float]) -> str:
    width, height = paper
    middle = np.array([width / 2, height / 2])
    paths = []
    for index in range(ON_SHEET):
        corner = middle + MILLIMETERS * board_corners(sheet * ON_SHEET + index)[0] * [1, -1]
        paths.append(_tag_path(sheet * ON_SHEET + index, (float(corner[0]), float(corner[1])), MILLIMETERS * SIDE))
    title = f"{robot.name}: board, sheet {sheet + 1} of {sheets}"
    return "\n".join(
        [_picture(paths, paper), f"#at({MARGIN}, 7, text(size: 10pt)[#{json.dumps(title)}])", *_bar(width, height)]
    )


def _bar(width: float, height: float) -> list[str]:
    """A bar of 100 mm in the foot of a page."""
    left, y = (width - 100) / 2, height - 9
    ticks = [f"#at({left + 10 * i}, {y - 1.5}, line(end: (0mm, 3mm), stroke: 0.2mm))" for i in range(11)]
    label = "100 mm. Measure it: prints that are scaled give wrong places."
    return [
        f"#at({left}, {y}, line(end: (100mm, 0mm), stroke: 0.2mm))",
        *ticks,
        f"#at({left}, {y + 2.2}, text(size: 7pt)[#{json.dumps(label)}])",
    ]


def _marker_pages(robot: Robot, side: float, paper: tuple[float, float]) -> Iterator[str]:
    """Pages with the tags of all markers, the steps on the first."""
    tags = list(marker_tags(robot).items())
    places = {marker.name: marker.at for marker in robot.markers}
    label = MILLIMETERS * side * (CELLS + 2) / CELLS
    step_x, step_y = max(label, 24.0) + GAP, label + NAME + GAP + 4.0
    top = MARGIN + 38.0
    columns = max(1, math.floor((paper[0] - 2 * MARGIN + GAP) / step_x))
    rows = max(1, math.floor((paper[1] - top - MARGIN - 6 + GAP) / step_y))
    for start in range(0, len(tags), columns * rows):
        paths, lines = [], []
        for index, (name, number) in enumerate(tags[start : start + columns * rows]):
            row, column = divmod(index, columns)
            x, y = MARGIN + column * step_x, top + row * step_y
            cell = MILLIMETERS * side / CELLS
            paths.append(_tag_path(number, (x + cell, y + cell), MILLIMETERS * side))
            frame = f"rect(width: {label}mm, height: {label + NAME}mm, stroke: 0.1mm + luma(150))"
            at = ", ".join(f"{MILLIMETERS * value:.0f}" for value in places[name])
            lines += [
                f"#at({x}, {y}, {frame})",
                f"#at({x}, {y + label - 0.6}, box(width: {label}mm, height: {NAME}mm, clip: true, align(center + "
                f"horizon, text(size: 8pt)[#{json.dumps(name)}])))",
                f"#at({x}, {y + label + NAME + 1}, text(size: 6.5pt, fill: luma(90))[at #{json.dumps(at)} mm])",
            ]
        title = f"{robot.name}: tags of markers, {MILLIMETERS * side:g} mm"
        steps = "".join(f"+ #{json.dumps(step)}\n" for step in STEPS)
        lines += [
            f'#at({MARGIN}, {MARGIN - 2}, text(size: 14pt, weight: "bold")[#{json.dumps(title)}])',
            f"#at({MARGIN}, {MARGIN + 7}, box(width: {paper[0] - 2 * MARGIN}mm)[\n{steps}])",
            *_bar(*paper),
        ]
        yield "\n".join([_picture(paths, paper), *lines])


def _map_page(robot: Robot, side: float, paper: tuple[float, float]) -> str:
    """Page with the body, drawn to fit, and the place of each tag; a body in space along its shortest axis."""
    mesh, top = robot.body.mesh, MARGIN + 22.0
    sides = mesh.nodes.max(axis=0) - mesh.nodes.min(axis=0)
    axes = sorted(np.argsort(-sides, kind="stable")[:2].tolist())
    low, size = mesh.nodes.min(axis=0)[axes], sides[axes]
    room = np.array([paper[0] - 2 * MARGIN - 30, paper[1] - top - MARGIN - 20])
    scale = float((room / size).min())
    corner = np.array([MARGIN + 15 + (room[0] - scale * size[0]) / 2, top + 10 + scale * size[1]])

    def place(points: np.ndarray) -> np.ndarray:
        return corner + scale * (points - low) * [1, -1]

    drawn = "".join(
        "M" + "L".join(f"{x:.3f} {y:.3f}" for x, y in place(line)) for line in _body_lines(robot.body, axes)
    )
    look = 'fill="#ddd" stroke="#ddd"' if mesh.dim == 3 else 'fill="none" stroke="#888"'
    half, lines = scale * side / 2, []
    edges = MultiLineString([place(line) for line in _body_lines(robot.body, axes)] if mesh.dim == 2 else [])
    tags = [place(np.array(marker.at)[axes]) for marker in robot.markers]
    taken = [box(x - half, y - half, x + half, y + half) for x, y in tags]
    shapes = [f'<path d="{drawn}" {look} stroke-width="0.4" stroke-linecap="round"/>']
    for name, number in marker_tags(robot).items():
        at = next(marker.at for marker in robot.markers if marker.name == name)
        x, y = place(np.array(at)[axes]).tolist()
        square = _square(x - half, y - half, 2 * half)
        shapes.append(f'<path d="{square}" fill="white" stroke="black" stroke-width="0.4"/>')
        shapes.append(f'<path d="M{x - 1} {y}h2M{x} {y - 1}v2" stroke="black" stroke-width="0.3"/>')
        words = f"{name} ({number})"
        label = _find_room((x, y), half, LETTER * len(words), [edges, *taken])
        taken.append(label)
        left, high, right, low_side = label.bounds
        if label.distance(box(x - half, y - half, x + half, y + half)) > 2:
            shapes.append(f'<path d="M{x} {y}L{(left + right) / 2} {(high + low_side) / 2}" stroke="#888" {_THIN}/>')
        text = f"box(fill: white, text(size: 8pt)[#{json.dumps(words)}])"
        lines.append(f"#at({(left + right) / 2 - 20}, {high}, box(width: 40mm, align(center, {text})))")
    title = f"{robot.name}: where the tags go"
    seen = "" if mesh.dim == 2 else f" Seen along {'xyz'[3 - sum(axes)]}; labels on the tags state all coordinates."
    note = f"Not to scale. The cross is the marker, the number that of the tag.{seen}"
    return "\n".join(
        [
            _svg(shapes, paper),
            *lines,
            f'#at({MARGIN}, {MARGIN - 2}, text(size: 14pt, weight: "bold")[#{json.dumps(title)}])',
            f"#at({MARGIN}, {MARGIN + 7}, box(width: {paper[0] - 2 * MARGIN}mm)[#{json.dumps(note)}])",
        ]
    )


_THIN = 'stroke-width="0.2"'


def _find_room(tag: tuple[float, float], half: float, wide: float, others: list[Any]) -> Polygon:
    """Box for a label [mm] next to a tag, as near as it meets none of others; below it where there is no such box."""
    x, y = tag
    boxes = []
    for apart in np.arange(0.8, 30.0, 1.6).tolist():
        down, across = half + apart + LINE / 2, half + apart + wide / 2
        for dx, dy in ((0, down), (0, -down), (across, 0), (-across, 0), (across, down), (-across, down)):
            middle = x + dx, y + dy
            boxes.append(box(middle[0] - wide / 2, middle[1] - LINE / 2, middle[0] + wide / 2, middle[1] + LINE / 2))
            if not any(boxes[-1].intersects(other) for other in others):
                return boxes[-1]
    return boxes[0]


def _body_lines(body: Body, axes: list[int]) -> list[Points]:
    """Lines that draw a body along two axes [m]: its outline, or its faces on one side, as others cancel their fill."""
    mesh, outline = body.mesh, body.outline
    if outline is not None:
        return [np.array(ring.coords) for ring in (outline.polygon.exterior, *outline.polygon.interiors)]
    faces = mesh.nodes[:, axes][mesh.boundary]
    if mesh.dim == 3:
        one, other = faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]
        faces = faces[one[:, 0] * other[:, 1] < one[:, 1] * other[:, 0]]
    return list(faces)


def _tag_path(number: int, corner: tuple[float, float], side: float) -> str:
    """Black of a tag as a path of SVG, its white cells as holes; corner: upper left [mm]."""
    cell = side / CELLS
    x, y = corner
    holes = [_square(x + cell * column, y + cell * row, cell) for row, column in np.argwhere(tag_cells(number))]
    return _square(x, y, side) + "".join(holes)


def _square(x: float, y: float, side: float) -> str:
    return f"M{x:.5f} {y:.5f}h{side:.5f}v{side:.5f}h{-side:.5f}z"


def _picture(paths: Iterable[str], paper: tuple[float, float]) -> str:
    return _svg([f'<path d="{path}" fill="black" fill-rule="evenodd"/>' for path in paths], paper)


def _svg(shapes: Iterable[str], paper: tuple[float, float]) -> str:
    width, height = paper
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}">{"".join(shapes)}</svg>'
    return f'#at(0, 0, image(bytes({json.dumps(svg)}), format: "svg", width: {width}mm, height: {height}mm))'
