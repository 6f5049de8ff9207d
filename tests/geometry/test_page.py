"""A second drawing on the page of a first. Oracle: the same path with some corners moved, in numbers of the page."""

from collections.abc import Callable

import numpy as np
import pytest
from drawings import canvas, dxf, picture

from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry.files.outline_file import read_drawing, read_outline
from hydrostat.geometry.outline import Outline

CORNERS = np.array([(30.0, 40.0), (230.0, 40.0), (230.0, 90.0), (120.0, 90.0), (120.0, 60.0), (30.0, 60.0)])
"""A body of 200 x 50 on a page of 300 x 200."""


def svg(corners: np.ndarray = CORNERS, page: str = 'width="300mm" height="200mm" viewBox="0 0 300 200"') -> bytes:
    drawn = " ".join(f"{x},{y}" for x, y in corners)
    return f'<svg xmlns="http://www.w3.org/2000/svg" {page}><polygon points="{drawn}"/></svg>'.encode()


def svg_without_unit(corners: np.ndarray = CORNERS) -> bytes:
    return svg(corners, 'viewBox="0 0 300 200"')


def svg_in_pixels(corners: np.ndarray = CORNERS) -> bytes:
    return svg(corners, 'width="300" height="200px"')


def dxf_drawing(corners: np.ndarray = CORNERS) -> bytes:
    """Heights count upwards."""
    return dxf(lambda space, _: space.add_lwpolyline((corners * [1, -1]).tolist(), close=True))


def png(corners: np.ndarray = CORNERS) -> bytes:
    def draw(on, fine: int) -> None:
        on.polygon([(2 * fine * x, 2 * fine * y) for x, y in corners], fill="black")

    return picture(canvas(draw, size=(600, 400)))


KINDS: dict[str, tuple[str, Callable[..., bytes], float | None, float]] = {
    "svg": ("a.svg", svg, None, 1e-12),
    "scaled": ("a.svg", svg, 0.4, 1e-12),
    "without unit": ("a.svg", svg_without_unit, 0.2, 1e-12),
    "pixels": ("a.svg", svg_in_pixels, 0.2, 1e-12),
    "dxf": ("a.dxf", dxf_drawing, None, 1e-12),
    "picture": ("a.png", png, 0.2, 0.25e-3),
}


@pytest.mark.parametrize("name", KINDS)
def test_what_did_not_move_stays(name: str) -> None:
    """One half of the body longer and lower on the page: its box is another."""
    file, draw, size, tolerance = KINDS[name]
    moved = CORNERS + np.array([(0, 0), (20, 30), (20, 30), (0, 0), (0, 0), (0, 0)])
    scale = (size or 0.2) / 200
    expected = Outline((moved - [130, 65]) * [scale, -scale])
    page = read_drawing(draw(), name=file, size=size).page
    found = read_outline(draw(moved), name=file, page=page)
    assert found.polygon.hausdorff_distance(expected.polygon) <= 4 * tolerance
    assert found.polygon.symmetric_difference(expected.polygon).area <= tolerance * expected.polygon.length
    alone = read_outline(draw(moved), name=file, size=size or 0.2)
    assert alone.polygon.hausdorff_distance(expected.polygon) > 5e-3


@pytest.mark.parametrize("name", KINDS)
def test_a_drawing_on_its_own_page_is_itself(name: str) -> None:
    file, draw, size, _ = KINDS[name]
    first = read_drawing(draw(), name=file, size=size)
    again = read_drawing(draw(), name=file, page=first.page)
    np.testing.assert_array_equal(again.outline.exterior, first.outline.exterior)
    assert again.page == first.page
    assert again.notes == first.notes


WRONG: dict[str, tuple[str, str, bytes, str]] = {
    "other unit": ("svg", "b.svg", svg(page='width="300mm" height="200mm" viewBox="0 0 600 400"'), "0.5 x 0.5 mm"),
    "larger page": (
        "svg",
        "b.svg",
        svg(page='width="310mm" height="200mm" viewBox="0 0 310 200"'),
        "units of 1 x 1 mm on a page of 310 x 200 units",
    ),
    "moved page": (
        "svg",
        "b.svg",
        svg(page='width="300mm" height="200mm" viewBox="-10 0 300 200"'),
        r"300 x 200 units from \(-10, 0\)",
    ),
    "larger page without unit": (
        "without unit",
        "b.svg",
        svg(page='viewBox="0 0 300 210"'),
        "size on a page of 300 x 210",
    ),
    "no page": ("without unit", "b.svg", svg(page=""), "an SVG drawing without a physical size or page"),
    "no viewBox": ("pixels", "b.svg", svg(page='width="400" height="200"'), "a page of 400 x 200 units from"),
    "no unit": ("svg", "b.svg", svg_without_unit(), "an SVG drawing without a physical size"),
    "inches": ("dxf", "b.dxf", dxf(lambda space, _: space.add_circle((0, 0), 9), unit=1), "units of 25.4 mm"),
    "other kind": ("svg", "b.dxf", dxf_drawing(), "a DXF drawing in units of 1 mm, the drawing"),
    "other picture": ("picture", "b.png", picture(canvas(size=(400, 400))), "a picture of 400 x 400 pixels"),
}


@pytest.mark.parametrize("name", WRONG)
def test_another_page_is_refused(name: str) -> None:
    first, file, content, message = WRONG[name]
    of, draw, size, _ = KINDS[first]
    page = read_drawing(draw(), name=of, size=size).page
    with pytest.raises(OutlineError, match=message) as caught:
        read_outline(content, name=file, page=page)
    assert str(caught.value).startswith(file)
    assert "begin with a copy of that one" in str(caught.value)


def test_a_page_has_a_size() -> None:
    page = read_drawing(svg(), name="a.svg").page
    with pytest.raises(InputError, match="leave the size out"):
        read_outline(svg(), name="a.svg", size=0.1, page=page)
